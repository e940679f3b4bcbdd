#pragma once

#include "blend/blend_windows.h"
#include "blend/select.h"
#include "core/half_pair.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// One stage of equations (8) and (9) on one level: windows of every bandwidth, blended, and the best chosen pixel by
/// pixel by cross-validation. before: the result of the stage before, whose halves are the guess of mu; null in
/// stage 1. Works in tiles so that the memory beside pair and result stays within max_bytes; the tiles do not show in
/// the result.
Candidate run_stage(const HalfPair& pair, const Candidate* before, const Params& params, std::size_t max_bytes,
                    FitCounters& counters, Progress& progress);

/// Share of the pixels that run_stage fits no window for: they carry no noise, or too little to matter; 0..1.
double skipped_share(const HalfPair& pair, const Params& params);

/// Pixels around a tile that the result inside it depends on.
int stage_halo(const Params& params);

/// Pixels of the smallest tile with its margins.
std::size_t smallest_tile_pixels(const Params& params);

/// Bytes that run_stage holds per pixel of a tile, its parts of the pair and of the stage before included.
/// color_channels: as in HalfPair::color.
std::size_t stage_bytes_per_pixel(int color_channels, int feature_channels, const Params& params);

/// The fits that the parameters ask for, with these bandwidths.
FitParams fit_params(const Params& params, const std::vector<Real>& bandwidths);

/// The fits of stage 1. Where other stages follow it only guesses mu for them, and fewer windows do.
FitParams first_fit_params(const Params& params);

}  // namespace polyrecon
