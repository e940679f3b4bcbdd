#pragma once

#include <cstddef>
#include <string>

#include "polyrecon/frame.h"
#include "polyrecon/progress.h"

namespace polyrecon {

struct NoiseVariance {
  Image variance;        ///< Variance of the beauty's mean, 3 channels, radiance squared.
  std::string source;    ///< "from the file", "from the half buffers" or "estimated from the image".
  bool measured = true;  ///< False for an estimate from the image, which is right for regions, not for single pixels.
};

/// Channels of NoiseVariance::variance.
inline constexpr std::size_t noise_variance_channels = 3;

/// Whether the frame holds a variance of its beauty or half buffers.
bool noise_is_measured(const Frame& frame);

/// The noise variance of the beauty: the variance in the file; without one the smoothed variance of the half buffers
/// (variance_of_mean, core/halves.h); without these estimate_variance, with features whose own noise, where it is
/// estimated, explains nothing (noise/feature_noise.h).
/// mask: the pixels that take part (core/mask.h), here and below.
/// correlation: of the noise of neighbouring pixels (noise_correlation), here and below.
NoiseVariance noise_variance(const Frame& frame, Progress& progress, const Image& mask = {}, double correlation = 0);

/// The correlation of the noise of pixels next to each other in a render whose noise is unknown: 0 unless a pixel
/// filter spreads samples over several pixels (splatting: 0.39 with Mitsuba's Gaussian, 0.25 with a tent). It is read
/// off windows that are flat, as at least five channels of the features do not vary there, and whose residuals two
/// pixels apart are not correlated, as those of shadows are. 0 where such windows are few: without features, or in
/// grass.
double noise_correlation(const Frame& frame, Progress& progress, const Image& mask = {});

/// Estimates the noise variance of an image that has none, from the residuals r of local fits (constant, features and
/// plane over 7 x 7 pixels, around every second pixel). The noise of different pixels is independent, but the texture
/// that a fit leaves in its residuals is correlated. With N the variance of the noise, T that of the texture, a the
/// correlation of the texture between neighbours, and h the mean of H over pairs of neighbours,
///     s^2 = sum r^2 / (n - tr H) = N + T,   c = mean over the pairs of r_i r_j = a T + (rho - h) N,
///     N = (s^2 - c / a) / (1 + (h - rho) / a),   a = (1 + rho) / 2,
/// where rho is the correlation of the noise of neighbours.
/// A pixel gets the median of the fits around it, so that the few windows across an edge do not matter. The variance is
/// raised at spikes (spike_variance.h) and, where the sample count is known, at edges (edge_variance.h). It is 0 where
/// the value is 0, since then no sample found any radiance, and where rounding to half floats explains all of it (a
/// deviation of at most 2^-11 of the value). y: finite, any channels. features: finite, of y's size, may have no
/// channels. samples: per pixel, 1 channel; empty where unknown. Returns y's shape, y's unit squared.
Image estimate_variance(const Image& y, const Image& features, Progress& progress, const Image& mask = {},
                        const Image& samples = {}, double correlation = 0);

/// Sets the variance of the features whose noise is estimated (noise_is_estimated, polyrecon/roles.h). Renderers carry
/// features through reflections, depth of field and motion blur, which makes them noisy; a model that takes this noise
/// for detail keeps noise in the beauty. Fits take noise of edges and fine texture for detail, so the variance F of
/// estimate_variance is raised to what the corner of the spectrum shows (corner_variance in noise/edge_variance.h), but
/// no further than 4 F or, where the sample count is known, two_value_variance: the corner shows clean aliased edges,
/// too. Where 2 x 2 pixels are equal but for rounding to half floats, the variance is 0: noise does not repeat, and
/// halves split by a variance that is none would blur clean edges.
void estimate_feature_variance(Frame& frame, Progress& progress, const Image& mask = {}, double correlation = 0);

}  // namespace polyrecon
