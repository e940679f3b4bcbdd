#include "features/prepare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/color_layout.h"
#include "core/halves.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/repair.h"
#include "noise/feature_noise.h"
#include "noise/fission.h"

namespace polyrecon {
namespace {

/// Repairs an image and continues it beyond the mask. Returns the number of repaired pixels inside the mask.
std::size_t repair(Image& image, const Image& mask, Real largest = largest_value) {
  if (mask.empty()) return repair_nonfinite(image, repair_depth, largest);
  image = outside_set_to(std::numeric_limits<Real>::quiet_NaN(), mask, std::move(image));
  const std::size_t all = image.pixels();
  return repair_nonfinite(image, repair_depth, largest) - (all - mask_pixels(mask, all));
}

/// Calls body(c, y) for every row of every channel, rows in parallel.
template <typename Body>
void for_rows_of(const Image& image, const Body& body) {
  for_rows(image.height(), [&](int y) {
    for (int c = 0; c < image.channels(); ++c) body(c, y);
  });
}

void transform(const FeatureUse& use, Image& image) {
  for_rows_of(image, [&](int c, int y) {
    Real* values = image.row(c, y);
    for (int x = 0; x < image.width(); ++x) {
      const auto v = static_cast<double>(values[x]);
      values[x] = static_cast<Real>(use.half_depth > 0 ? std::max(v, 0.0) / (std::max(v, 0.0) + use.half_depth)
                                                       : v * use.scale);
    }
  });
}

/// Noise variance after transform(): it is multiplied by the squared slope of the transformation.
void transform_variance(const FeatureUse& use, const Image& mean, Image& variance) {
  for_rows_of(variance, [&](int c, int y) {
    const Real* means = mean.row(c, y);
    Real* values = variance.row(c, y);
    for (int x = 0; x < variance.width(); ++x) {
      const double z = std::max(static_cast<double>(means[x]), 0.0) + use.half_depth;
      const double slope = use.half_depth > 0 ? use.half_depth / (z * z) : use.scale;
      values[x] = static_cast<Real>(std::min(static_cast<double>(values[x]) * slope * slope, 1.0));
    }
  });
}

void make_non_negative(Image& variance) {
  for_rows_of(variance, [&](int c, int y) {
    Real* values = variance.row(c, y);
    for (int x = 0; x < variance.width(); ++x) values[x] = std::max(values[x], Real(0));
  });
}

void scale(Image& image, Real factor) {
  for_rows_of(image, [&](int c, int y) {
    Real* values = image.row(c, y);
    for (int x = 0; x < image.width(); ++x) values[x] *= factor;
  });
}

/// Noise variance of a half of a pass over its variance, which is that of the mean if the file has it, else of (A + B)
/// / 2.
Real half_noise_of(const Pass& pass) {
  const bool of_mean = pass.has_halves() && !pass.variance.empty();
  return of_mean ? static_cast<Real>(half_noise(pass.mean, pass.half_a, pass.half_b)) : Real(2);
}

/// Moves the halves out of a pass and repairs them. A pass without halves has its mean split, with half_variance as the
/// noise variance of one half; where that is empty both halves are the mean.
std::array<Image, 2> halves_of(Pass& pass, const Image& half_variance, std::uint64_t stream, const Image& mask,
                               std::size_t& repaired, double correlation = 0) {
  if (pass.has_halves()) {
    std::array<Image, 2> halves{std::move(pass.half_a), std::move(pass.half_b)};
    for (Image& half : halves) repaired += repair(half, mask);
    return halves;
  }
  Image mean = pass.mean;
  repaired += repair(mean, mask);
  if (half_variance.empty()) return {mean, mean};
  Image variance = half_variance;
  scale(variance, Real(0.5));
  return split_halves(mean, variance, stream, correlation);
}

/// Sky has no noise, whatever the distances that a mean over sky and objects mixes.
void remove_noise_of_sky(const Image& depth, double sky, Image& variance) {
  for (std::size_t i = 0; i < variance.pixels(); ++i)
    if (static_cast<double>(depth.plane(0)[i]) >= sky) variance.plane(0)[i] = 0;
}

/// Noise variance of one half of a feature; empty where it is unknown.
Image feature_half_variance(Feature& feature, double sky, const Image& mask, std::size_t& repaired) {
  Pass& pass = feature.pass;
  if (!pass.variance.empty()) {
    const Real of_half = half_noise_of(pass);
    Image variance = std::move(pass.variance);
    if (may_show_sky(feature)) remove_noise_of_sky(pass.mean, sky, variance);
    repaired += repair(variance, mask);
    make_non_negative(variance);
    scale(variance, of_half);
    return variance;
  }
  if (!pass.has_halves()) return {};
  Image variance = pass.half_a;
  for_rows_of(variance, [&](int c, int y) {
    const Real* b = pass.half_b.row(c, y);
    Real* values = variance.row(c, y);
    for (int x = 0; x < variance.width(); ++x) values[x] = 2 * variance_of_mean(values[x], b[x]);
  });
  if (may_show_sky(feature)) remove_noise_of_sky(pass.mean, sky, variance);
  repaired += repair(variance, mask);
  return variance;
}

/// Number of pixels with a negative channel.
std::size_t negative_pixels(const Image& image) {
  return static_cast<std::size_t>(ordered_sum(static_cast<std::size_t>(image.height()), [&](std::size_t y) {
    std::size_t count = 0;
    for (int x = 0; x < image.width(); ++x) {
      bool negative = false;
      for (int c = 0; c < image.channels(); ++c) negative |= image.at(x, static_cast<int>(y), c) < 0;
      count += negative;
    }
    return static_cast<double>(count);
  }));
}

/// Halves of a colour pass that has none. They differ by the pass's share, pass / beauty, of the difference between the
/// beauty's halves, so that the halves of passes which add up to the beauty add up to the beauty's halves.
std::array<Image, 2> split_like(const std::array<Image, 2>& beauty, const Pass& pass, const Image& mask,
                                std::size_t& repaired) {
  Image mean = pass.mean;
  repaired += repair(mean, mask);
  std::array<Image, 2> halves{mean, mean};
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < mean.pixels(); ++i) {
      const Real a = beauty[0].plane(c)[i], b = beauty[1].plane(c)[i], sum = a + b;
      if (!(std::abs(sum) > std::numeric_limits<Real>::min())) continue;
      // A layer that is no part of the beauty, such as an albedo, can be any multiple of a dark pixel: limit the share.
      const Real share = std::clamp(2 * (mean.plane(c)[i] / sum), Real(0), Real(1));
      const Real offset = share * (Real(0.5) * (a - b));
      halves[0].plane(c)[i] += offset;
      halves[1].plane(c)[i] -= offset;
    }
  return halves;
}

/// Copies the channels of two halves to those of a pair, beginning at `channel`, which is moved to the next free one.
void append(const std::array<Image, 2>& halves, std::array<Image, 2>& to, int& channel) {
  for (std::size_t h = 0; h < 2; ++h)
    in_parallel(static_cast<std::size_t>(halves[h].channels()), [&](std::size_t k) {
      const int c = static_cast<int>(k);
      std::copy(halves[h].plane(c), halves[h].plane(c) + halves[h].pixels(), to[h].plane(channel + c));
    });
  channel += halves[0].channels();
}

/// Gives both halves their mean.
void join(std::array<Image, 2>& halves) {
  for_rows_of(halves[0], [&](int c, int y) {
    Real *a = halves[0].row(c, y), *b = halves[1].row(c, y);
    for (int x = 0; x < halves[0].width(); ++x) a[x] = b[x] = Real(0.5) * (a[x] + b[x]);
  });
}

/// Prefilters the halves of a feature, and flattens them where the prefilter would leave noise that is fitted to the
/// noise of the beauty. Halves that were split by an estimated variance, as each is filtered by the other, are joined
/// after that: what is left of the numbers that split them is noise.
std::array<Image, 2> prefiltered(std::array<Image, 2> halves, const Image& variance, const FeatureUse& use,
                                 bool split_by_estimate, const PrefilterParams& params, const Image& mask,
                                 Progress& progress) {
  const Image part = use.flatten ? noise_in_variation(halves[0], variance, mask) : Image();
  halves = prefilter(halves, variance, params, progress, mask);
  if (split_by_estimate) join(halves);
  if (!use.flatten) return halves;
  for (Image& half : halves) half = flattened(std::move(half), part, mask);
  return halves;
}

std::array<Image, 2> prepared_feature(Feature feature, const FeatureUse& use, double sky, std::size_t stream,
                                      double correlation, const PrefilterParams& prefilter_params, const Image& mask,
                                      std::size_t& repaired, Progress& progress) {
  const bool estimated = feature.pass.variance_is_estimated;
  Image variance = feature_half_variance(feature, sky, mask, repaired);
  auto halves = halves_of(feature.pass, estimated && !use.prefilter ? Image() : variance, stream, mask, repaired,
                          estimated ? correlation : 0);
  if (use.prefilter && !variance.empty()) {
    repair(feature.pass.mean, mask);
    transform_variance(use, feature.pass.mean, variance);
    for (Image& half : halves) transform(use, half);
    return prefiltered(std::move(halves), variance, use, estimated, prefilter_params, mask, progress);
  }
  for (Image& half : halves) transform(use, half);
  return halves;
}

/// Fills out.pair.color, and takes the halves and variances of the colour passes.
void prepare_colors(Frame& frame, const Preparation& preparation, bool with_alpha, Prepared& out) {
  const bool alpha = with_alpha && !frame.alpha.empty();
  const int channels = ColorLayout(static_cast<int>(frame.aovs.size()), alpha).channels();
  for (Image& color : out.pair.color) color = Image(frame.width(), frame.height(), channels);
  int channel = 0;
  const Image& mask = out.pair.sampled;
  const auto beauty = halves_of(frame.beauty, out.pair.variance, preparation.stream, mask, out.repaired_pixels,
                                preparation.noise_correlation);
  append(beauty, out.pair.color, channel);
  frame.beauty.variance = {};
  for (Pass& aov : frame.aovs) {
    append(aov.has_halves() ? halves_of(aov, {}, 0, mask, out.repaired_pixels)
                            : split_like(beauty, aov, mask, out.repaired_pixels),
           out.pair.color, channel);
    aov.variance = {};
  }
  if (alpha) {
    Pass pass{"alpha", frame.alpha, {}, {}, {}};
    append(halves_of(pass, {}, 0, mask, out.repaired_pixels), out.pair.color, channel);
  }
}

/// Fills out.pair.features, and takes all features of the frame.
void prepare_features(Frame& frame, const Preparation& preparation, const PrefilterParams& prefilter_params,
                      Prepared& out, Progress& progress) {
  int channels = 0;
  for (const FeatureUse& use : preparation.features) channels += frame.features[use.index].pass.mean.channels();
  for (Image& features : out.pair.features) features = Image(frame.width(), frame.height(), channels);
  int channel = 0;
  for (const FeatureUse& use : preparation.features) {
    // One stream for all features whose noise is estimated, so that equal features stay equal.
    const bool estimated = frame.features[use.index].pass.variance_is_estimated;
    const std::uint64_t stream = preparation.stream + (estimated ? 0 : use.index) + 1;
    append(prepared_feature(std::move(frame.features[use.index]), use, frame.sky_depth, stream,
                            preparation.noise_correlation, prefilter_params, out.pair.sampled, out.repaired_pixels,
                            progress),
           out.pair.features, channel);
  }
  frame.features.clear();
}

}  // namespace

Prepared prepare(Frame& frame, const Preparation& preparation, const Image& variance,
                 const PrefilterParams& prefilter_params, bool with_alpha, Progress& progress) {
  Prepared out;
  out.pair.epsilon = preparation.epsilon;
  out.independent_halves = frame.beauty.has_halves();
  out.pair.sampled = preparation.sampled;
  out.pair.variance = variance;
  repair(out.pair.variance, out.pair.sampled, largest_variance(frame.beauty.mean));
  make_non_negative(out.pair.variance);
  scale(out.pair.variance, half_noise_of(frame.beauty));
  out.negative_pixels = negative_pixels(frame.beauty.mean);
  prepare_colors(frame, preparation, with_alpha, out);
  prepare_features(frame, preparation, prefilter_params, out, progress);
  return out;
}

}  // namespace polyrecon
