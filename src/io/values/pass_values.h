// Conversions from the values of layers to those of a Pass: numbers of channels, samples per pixel, variances of the
// mean.
#pragma once

#include <cstddef>
#include <string>

#include "polyrecon/image.h"
#include "polyrecon/layers.h"

namespace polyrecon {

/// The image with another number of channels: one is repeated, several are averaged to one. is_variance: the noise of
/// the channels is taken to be fully correlated, as it is in grey shadows, so a variance becomes the square of the mean
/// standard deviation.
Image with_channels(Image image, int channels, bool is_variance = false);

/// Turns CIE XYZ into linear RGB with the primaries of sRGB, and variances likewise: the noise of the channels is taken
/// to be fully correlated, as it is where the light's colour does not change.
void xyz_to_rgb_values(Image& xyz);
void xyz_to_rgb_variances(Image& xyz);

/// The samples of each pixel: an image of one channel, one number for all pixels, or unknown.
struct SampleCounts {
  const Image* per_pixel = nullptr;
  double everywhere = 0;

  bool known() const { return per_pixel != nullptr || everywhere > 0; }
  double at(std::size_t i) const { return per_pixel ? static_cast<double>(per_pixel->plane(0)[i]) : everywhere; }
};

/// Turns the values of a sample-count layer into numbers of samples. everywhere: the samples of all pixels, 0 if
/// unknown. Returns false where the values are fractions of an unknown number.
bool to_sample_counts(Image& values, const std::string& pass, double everywhere);

/// Replaces counts that are negative, not finite or too large (core/repair.h) by the mean of the others. Returns how
/// many there are; where it is all, nothing changes.
std::size_t repair_counts(Image& counts);

/// Mean noise variance over the mean variance that pixels next to each other show, (a - b)^2 / 2, both relative to
/// their brightness (core/relmse.h). The picture only adds to the latter, so independent noise of this variance gives
/// at most about 1. 0 where the variance is unknown or neighbours do not differ.
double variance_excess(const Image& mean, const Image& variance);

/// Above it the variance is wrong, whatever the pixel filter, which halves the differences of neighbours.
constexpr double most_variance_excess = 10;

/// Turns what a companion of `mean` holds into the variance of the mean. counts: known, unless kind is VarianceOfMean.
/// The variance v of one of n samples becomes v / n; a second moment m2 becomes (m2 - mean^2) / (n - 1), at least 0.
/// Second moments of CIE XYZ become those of RGB; the noise of the channels is taken to be fully correlated, as it is
/// where the light's colour does not change. Values have 3 channels then, and as many as the mean or 1 otherwise.
void to_variance_of_mean(Image& values, Companion kind, const Image& mean, const SampleCounts& counts);

}  // namespace polyrecon
