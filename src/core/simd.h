#pragma once

#include "core/real.h"

// The inner loops are plain C++ that the compiler vectorises. POLYRECON_SIMD builds a function once for each x86-64
// level and picks one when the program starts, so one binary uses AVX-512 where there is any and runs without.
#if defined(POLYRECON_SIMD_CLONES) && defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define POLYRECON_SIMD __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define POLYRECON_SIMD
#endif

namespace polyrecon {

/// Where a loop must keep sums apart in registers, it says so: four numbers side by side (a vector extension that GCC
/// and Clang share). In memory they stand anywhere. Four doubles are a register of AVX2; what is wider than a level's
/// registers GCC puts into memory, three to four times as slow.
constexpr int vector_lanes = 4;
using Doubles = double __attribute__((vector_size(vector_lanes * sizeof(double))));
using Reals = Real __attribute__((vector_size(vector_lanes * sizeof(Real))));
using StoredDoubles =
    double __attribute__((vector_size(vector_lanes * sizeof(double)), aligned(alignof(double)), may_alias));
using StoredReals = Real __attribute__((vector_size(vector_lanes * sizeof(Real)), aligned(alignof(Real)), may_alias));

}  // namespace polyrecon
