#pragma once

#include "blend/blend_windows.h"
#include "blend/select.h"
#include "core/half_pair.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// One stage of equations (8) and (9) on one level: fits and blends windows of every bandwidth and selects among the
/// results pixel by pixel (select). Works in tiles, so that the memory in addition to the arguments and the result
/// stays within max_bytes; the result does not depend on the tiles. before: the result of the previous stage, whose
/// halves are the guess of mu; null in stage 1.
Candidate run_stage(const HalfPair& pair, const Candidate* before, const Params& params, std::size_t max_bytes,
                    FitCounters& counters, Progress& progress);

/// Share of the pixels that run_stage skips because they have no noise, or not more than Params::enough; 0..1.
double skipped_share(const HalfPair& pair, const Params& params);

/// Pixels around a tile that the result inside it depends on.
int stage_halo(const Params& params);

/// Pixels of the padded area of the smallest tile.
std::size_t smallest_tile_pixels(const Params& params);

/// Bytes that run_stage holds per pixel of a tile, its parts of the pair and of the stage before included.
/// color_channels: as in HalfPair::color.
std::size_t stage_bytes_per_pixel(int color_channels, int feature_channels, const Params& params);

/// The settings of fit_and_blend for these bandwidths.
FitParams fit_params(const Params& params, const std::vector<Real>& bandwidths);

/// The settings of fit_and_blend in stage 1. If other stages follow, stage 1 only provides the guess of mu, for which
/// fewer windows are enough.
FitParams first_fit_params(const Params& params);

}  // namespace polyrecon
