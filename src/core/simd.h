#pragma once

#include "core/real.h"

// The inner loops are plain C++ that the compiler vectorises. A function marked POLYRECON_SIMD is compiled once for
// each x86-64 level, and one version is chosen when the program starts. So one binary uses AVX-512 where it is
// available and also runs where it is not.
#if defined(POLYRECON_SIMD_CLONES) && defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define POLYRECON_SIMD __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define POLYRECON_SIMD
#endif

namespace polyrecon {

/// Numbers in one vector of the types below, which loops use that must keep several sums in registers (a vector
/// extension of GCC and Clang). Four doubles fill a register of AVX2. GCC keeps vectors wider than the registers of a
/// level in memory, which is slow.
constexpr int vector_lanes = 4;
using Doubles = double __attribute__((vector_size(vector_lanes * sizeof(double))));
using Reals = Real __attribute__((vector_size(vector_lanes * sizeof(Real))));
// The same in memory, aligned as single numbers are.
using StoredDoubles =
    double __attribute__((vector_size(vector_lanes * sizeof(double)), aligned(alignof(double)), may_alias));
using StoredReals = Real __attribute__((vector_size(vector_lanes * sizeof(Real)), aligned(alignof(Real)), may_alias));

}  // namespace polyrecon
