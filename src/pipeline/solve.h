#pragma once

#include <cstddef>

#include "blend/blend_windows.h"
#include "core/candidate.h"
#include "core/half_pair.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// The polynomials of a pair: all stages on all levels of resolution (equations 5 to 9). Works in
/// tiles, so that the memory in addition to the pair, its coarser levels and two results stays within max_bytes.
Candidate solve(const HalfPair& pair, const Params& params, std::size_t max_bytes, FitCounters& counters,
                Progress& progress);

/// Units of work of solve, about: blocks x phases of all stages and levels for both halves.
std::size_t fit_units(const HalfPair& pair, const Params& params);

}  // namespace polyrecon
