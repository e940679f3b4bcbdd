#pragma once

#include <array>
#include <cstddef>

#include "polyrecon/frame.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// Variance of the mean of two independent halves A and B of a pixel's samples, as their difference shows it: since
/// E[(A - B)^2] = Var(A) + Var(B) and the mean is (A + B) / 2, (A - B)^2 / 4 is an unbiased estimate with one degree of
/// freedom. T is double or Real.
template <typename T>
T variance_of_mean(T a, T b) {
  return (a - b) * (a - b) / 4;
}

/// Variance of the mean of a pass at a pixel: the one of the file, else that of the halves; 0 where neither is usable.
double known_variance(const Pass& pass, int c, std::size_t i);

/// (A + B) / 2 of the first `channels` channels.
Image mean_of_halves(const std::array<Image, 2>& halves, int channels);

/// The noise variance of a half, averaged over both, relative to that of `mean`: 2 for halves of equal sample counts.
/// If half A has the share w of the samples, mean = w A + (1 - w) B, and the result is (1 / w + 1 / (1 - w)) / 2. One w
/// is fitted to all pixels and channels; halves that contradict the mean count as equal. The images have the same
/// size; samples that are not finite do not count.
double half_noise(const Image& mean, const Image& half_a, const Image& half_b);

/// Whether the halves cannot be those of `mean`. The mean of halves of any sample counts lies between A and B, so in
/// every block of pixels, and in the whole image,
///     |sum (mean - (A + B) / 2)| <= sum |A - B| / 2.
/// They contradict the mean where the share of a half is below 2 %, or where this is exceeded by more than
/// contradicting_energy of sum |mean|, or, in the whole image, where the sum is beyond five standard deviations of the
/// noise that A - B shows. Where one of them is not usable and the mean is, both count as 0, since this is what the
/// repair makes of whole regions. The images have the same shape.
bool contradict(const Image& mean, const Image& half_a, const Image& half_b);

/// Share of the energy that rounding, lossy compression and the clamping of fireflies may move between a mean and its
/// halves. Differences up to it are restored (Components::restore_totals).
inline constexpr double contradicting_energy = 0.05;

}  // namespace polyrecon
