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

/// Pixels around a region that the choice inside it depends on.
int select_halo(const SelectParams& params);

/// Averages the candidates pixel by pixel, weighted by their cross-validated risk. With f_A, f_B the halves of a
/// candidate and A, B the noisy ones,
///     risk = mean over RGB of [ ((f_A - B)^2 + (f_B - A)^2) / 2 - (f_A - f_B)^2 / 4 ] / (brightness^2 + epsilon)
/// is an unbiased estimate of the relative squared error of (f_A + f_B) / 2, but for the noise of A and B, which is the
/// same for all candidates. The risk is averaged over risk_sigma. The share of a candidate is
///     exp(-z^2 / 2) / s,   z = D / SE,
/// where D is its risk minus that of the best candidate, SE is the standard error of D (so z says how likely the
/// difference is chance), and s is the standard deviation of the candidate's noise, from the variance of its windows
/// averaged over risk_sigma. So of candidates that cannot be distinguished by their risk, those with less noise count
/// for more. Candidates without a variance have s = 1. Where several candidates are about equally good, their mean is
/// the best, so that rounding does not decide which one the others are compared with. Shares are smoothed by map_sigma.
/// All images are of one size. There is at least one candidate.
/// brightness: a guess of the result, 3 channels.
Candidate select(const HalfPair& pair, const Image& brightness, const std::vector<Candidate>& candidates,
                 const SelectParams& params);

/// Channels that select holds in addition to its arguments, its result included.
std::size_t select_channels(std::size_t candidates, std::size_t color_channels);

/// Corrections of a result, for select_correction.
struct Corrections {
  std::size_t count = 0;
  int halo = 0;  ///< Pixels around a region that its corrections depend on.
  /// Computes the halves of each correction from the result's halves in a region of the frame, with the same channels.
  std::function<std::vector<std::array<Image, 2>>(const std::array<Image, 2>& halves, const Rect& region)> make;
};

/// Selects among a result and its corrections by their risk alone, since all have the variance of the result. Works in
/// tiles, so that the memory in addition to the arguments and the returned halves stays within max_bytes; the returned
/// halves do not depend on the tiles.
/// halves: of the result, the first channels of HalfPair::color, at least 3.
std::array<Image, 2> select_correction(const HalfPair& pair, const std::array<Image, 2>& halves,
                                       const Corrections& corrections, const SelectParams& params,
                                       std::size_t max_bytes);

/// Bytes per pixel of a tile that select_correction holds.
std::size_t correction_bytes_per_pixel(int channels, std::size_t corrections);

}  // namespace polyrecon
