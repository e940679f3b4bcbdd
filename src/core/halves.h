#pragma once

#include <array>

#include "polyrecon/image.h"

namespace polyrecon {

/// Variance of the mean of two independent halves A and B of a pixel's samples, as their difference shows it: since
/// E[(A - B)^2] = Var(A) + Var(B) and the mean is (A + B) / 2, (A - B)^2 / 4 is an unbiased estimate with one degree of
/// freedom. T is double or Real.
template <typename T>
T variance_of_mean(T a, T b) {
  return (a - b) * (a - b) / 4;
}

/// (A + B) / 2 of the first `channels` channels.
Image mean_of_halves(const std::array<Image, 2>& halves, int channels);

/// The noise variance of a half, averaged over both, relative to that of `mean`: 2 for halves of equal sample counts.
/// If half A has the share w of the samples, mean = w A + (1 - w) B, and the result is (1 / w + 1 / (1 - w)) / 2. One w
/// is fitted to all pixels and channels; halves that contradict the mean count as equal. The images have the same
/// size; samples that are not finite do not count.
double half_noise(const Image& mean, const Image& half_a, const Image& half_b);

}  // namespace polyrecon
