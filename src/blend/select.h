#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "core/candidate.h"
#include "core/half_pair.h"
#include "polyrecon/image.h"
#include "polyrecon/params.h"

namespace polyrecon {

/// Pixels around a region that select looks at.
int select_halo(const SelectParams& params);

/// Blends the candidates pixel by pixel by their cross-validated risk. With f_A, f_B the candidate's halves and A, B
/// the noisy ones,
///     risk = mean over RGB of [ ((f_A - B)^2 + (f_B - A)^2) / 2 - (f_A - f_B)^2 / 4 ] / (brightness^2 + epsilon)
/// is, but for the noise of A and B that all candidates share, an unbiased estimate of the relative squared error of
/// (f_A + f_B) / 2. Averaged over risk_sigma; a candidate's share is
///     exp(-z^2 / 2) / s,   z = D / SE,
/// with D its risk above the best's (the mean of several that are equally good: no rounding decides which the others
/// are compared with) and SE the standard error of D (how likely the difference is chance), and s the
/// standard deviation of its own noise, from the windows' variance averaged alike: of candidates that cannot be told
/// apart by their risk the less noisy ones count for more. Candidates without a variance have s = 1. Shares are
/// smoothed by map_sigma. brightness: 3 channels, a guess of the result. All images of one size; at least one
/// candidate.
Candidate select(const HalfPair& pair, const Image& brightness, const std::vector<Candidate>& candidates,
                 const SelectParams& params);

/// Channels that select holds in addition to its arguments, its result included.
std::size_t select_channels(std::size_t candidates, std::size_t color_channels);

/// Further images made from a result.
struct Corrections {
  std::size_t count = 0;
  int reach = 0;  ///< Pixels around a region that make has to see.
  /// The halves of each, of own's channels, from own's halves in a region of the frame.
  std::function<std::vector<std::array<Image, 2>>(const std::array<Image, 2>& own, const Rect& region)> make;
};

/// The best of own and its corrections, by their risk alone: variances would be own's for all. own: the first channels
/// of HalfPair::color, at least 3. Works in tiles so that the memory beside own and the result stays within max_bytes;
/// the tiles do not show in the result.
std::array<Image, 2> select_correction(const HalfPair& pair, const std::array<Image, 2>& own,
                                       const Corrections& corrections, const SelectParams& params,
                                       std::size_t max_bytes);

/// Bytes that select_correction works with per pixel of a tile.
std::size_t correction_bytes_per_pixel(int channels, std::size_t corrections);

}  // namespace polyrecon
