#pragma once

// The inner loops are plain C++ that the compiler vectorises. POLYRECON_SIMD builds a function once for each x86-64
// level and picks one when the program starts, so one binary uses AVX-512 where there is any and runs without.
#if defined(POLYRECON_SIMD_CLONES) && defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define POLYRECON_SIMD __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define POLYRECON_SIMD
#endif
