#pragma once

#include <array>
#include <vector>

#include "outliers/outlier.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// Returns the energy that remove_outliers took, equations (10) and (11), so that the sum of every channel is that of
/// the input to the rounding of double. The gain of a pixel is proportional to its brightness,
///     yhat(i) += e_o kappa yhat(i)^2 / sum over Omega_o of kappa yhat^2.
/// This has the least relative squared error of all ways to add e_o, sum (d / yhat)^2 / kappa
/// (docs/lab/2026-11-28-fireflies.md).
///
/// kappa = min(1, sigma / (max_gain yhat)), with sigma the standard deviation of the input's noise, is smaller for
/// pixels in which max_gain would exceed the noise, such as a sky of one colour. Omega_o is a square around o. It grows
/// until the root mean square of the gain, weighted by kappa, is at most max_gain: the energy stays as close to o as it
/// can without being visible. Where no pixel of Omega_o is positive and noisy, the energy returns to o itself.
///
/// That bounds the gain from one outlier in the mean. A bright pixel among many outliers, such as the rim of a lamp,
/// gains from all of them: more than 3 % of its value goes to the whole image.
///
/// If Omega_o is the whole image, no pixel changes by more than a half: the brightest ones, which would, change by a
/// half, and the rest is shared out by squares among the others, which is the least relative squared error under this
/// bound. Where the bound cannot be kept, all pixels gain the same factor. A colour of which no pixel takes part stays
/// unchanged.
///
/// AOVs receive their e_o in the shape of the beauty, so that layers that add up to the beauty still do. Alpha stays
/// unchanged. variance: noise variance of one half of the input, 3 channels (HalfPair::variance). image: ColorLayout.
void restore_energy(const std::vector<Outlier>& outliers, const Image& variance, double max_gain, Image& image);

/// The same with Omega the whole image for the energy that the fits gained or lost: the sums of the first totals.size()
/// channels become `totals`. noise_free: relative noise below which kappa is less than 1.
/// A colour whose sum would change by more than max_gain is left unchanged, since such a difference is neither rounding
/// nor the effect of the weights but content (an input of both signs, a hole that was repaired). Returns the relative
/// gain of each of the first three channels.
std::array<double, 3> restore_totals(const std::vector<double>& totals, const Image& variance, double noise_free,
                                     double max_gain, Image& image);

/// Channels that restore_energy holds, the image that it works on included.
std::size_t restore_channels(std::size_t color_channels);

/// Sum of every channel over the usable pixels.
std::vector<double> channel_sums(const Image& image);

}  // namespace polyrecon
