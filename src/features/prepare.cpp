#include "features/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/color_layout.h"
#include "core/halves.h"
#include "core/parallel.h"
#include "core/repair.h"
#include "noise/fission.h"
#include "polyrecon/error.h"
#include "regression/basis.h"

namespace polyrecon {
namespace {

constexpr int repair_radius = 8;      // pixels; deeper holes carry no information for their middle anyway
constexpr double noise_floor = 1e-5;  // noise below this part of a feature's own variance is not worth cleaning

/// body(c, y) for every row of every channel; rows side by side.
template <typename Body>
void for_rows_of(const Image& image, const Body& body) {
  for_rows(image.height(), [&](int y) {
    for (int c = 0; c < image.channels(); ++c) body(c, y);
  });
}

/// Mean over the usable, non-negative part of the beauty.
double mean_brightness(const Image& beauty) {
  const double sum = ordered_sum(static_cast<std::size_t>(beauty.height()), [&](std::size_t y) {
    double row = 0;
    for (int c = 0; c < 3; ++c) {
      const Real* values = beauty.row(c, static_cast<int>(y));
      for (int x = 0; x < beauty.width(); ++x)
        if (usable(values[x]) && values[x] > 0) row += static_cast<double>(values[x]);
    }
    return row;
  });
  return sum / (3.0 * static_cast<double>(beauty.pixels()));
}

struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();

  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool holds(double v) const { return low <= v && v <= high; }
  double largest() const { return std::max(std::abs(low), std::abs(high)); }
};

/// What a feature's values and noise look like over the frame.
struct FeatureLook {
  Range all, usual;     ///< Of its values; usual: without spikes.
  double variance = 0;  ///< Of its usual values over the frame, mean over the channels.
  double noise = 0;     ///< Mean of their own noise variance.
  std::size_t usable_pixels = 0, noisy_pixels = 0;
};

/// Noise variance of a pass at a pixel as far as the pass tells, else 0.
double noise_at(const Pass& pass, int c, std::size_t i) {
  if (!pass.variance.empty() && usable(pass.variance.plane(c)[i]))
    return static_cast<double>(pass.variance.plane(c)[i]);
  if (!pass.has_halves()) return 0;
  const double variance = variance_of_mean<double>(pass.half_a.plane(c)[i], pass.half_b.plane(c)[i]);
  return std::isfinite(variance) ? variance : 0;
}

bool is_depth(const Feature& feature) { return info_of(feature.role).transform == FeatureTransform::BoundedDepth; }

bool usable_value(const Feature& feature, double sky, Real value) {
  return usable(value) && !(is_depth(feature) && static_cast<double>(value) >= sky);
}

/// Where a channel's values lie but for spikes: from the 0.5 % quantile to that of 99.5 %, and as far again on either
/// side. All where they hardly vary, since what does is no spike then.
Range usual_range(const Feature& feature, double sky, int channel) {
  constexpr std::size_t samples = 1 << 16;
  const Image& mean = feature.pass.mean;
  std::vector<Real> values;
  for (std::size_t i = 0; i < mean.pixels(); i += std::max<std::size_t>(1, mean.pixels() / samples))
    if (usable_value(feature, sky, mean.plane(channel)[i])) values.push_back(mean.plane(channel)[i]);
  const auto quantile = [&](std::size_t rank) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
    return static_cast<double>(values[rank]);
  };
  const std::size_t cut = values.size() / 200;
  const double low = values.empty() ? 0 : quantile(cut), high = values.empty() ? 0 : quantile(values.size() - 1 - cut);
  if (!(high > low)) return {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};
  return {low - (high - low), high + (high - low)};
}

FeatureLook look_at_feature(const Feature& feature, double sky) {
  FeatureLook look;
  const Image& mean = feature.pass.mean;
  for (int c = 0; c < mean.channels(); ++c) {
    const Range usual = usual_range(feature, sky, c);
    const Real* values = mean.plane(c);
    double sum = 0, square = 0, noise = 0;
    std::size_t pixels = 0, count = 0, noisy = 0;
    for (std::size_t i = 0; i < mean.pixels(); ++i) {
      const auto v = static_cast<double>(values[i]);
      if (!usable_value(feature, sky, values[i])) continue;
      ++pixels;
      look.all.add(v);
      if (!usual.holds(v)) continue;
      ++count;
      look.usual.add(v);
      sum += v;
      square += v * v;
      const double own_noise = noise_at(feature.pass, c, i);
      noise += own_noise;
      noisy += own_noise > 0;
    }
    if (count == 0) continue;
    const double n = static_cast<double>(count), m = sum / n;
    look.variance += std::max(0.0, square / n - m * m) / mean.channels();
    look.noise += noise / n / mean.channels();
    look.usable_pixels = std::max(look.usable_pixels, pixels);
    look.noisy_pixels = std::max(look.noisy_pixels, noisy);
  }
  return look;
}

double median_depth(const Image& depth, double sky) {
  std::vector<Real> values;
  for (std::size_t i = 0; i < depth.pixels(); ++i) {
    const Real z = depth.plane(0)[i];
    if (usable(z) && z > 0 && static_cast<double>(z) < sky) values.push_back(z);
  }
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// Whether a feature takes part, and why (or why not).
Decision decide_on_feature(const FeatureLook& look, const Feature& feature, const Steps& steps) {
  const std::string step = std::string("feature ") + name_of(feature.role);
  const Image& mean = feature.pass.mean;
  if (!steps.features.has(feature.role)) return {step, false, "not requested"};
  if (look.usable_pixels == 0) return {step, false, "no finite value"};
  if (!steps.decide) return {step, true, "requested"};
  const bool has_sky = is_depth(feature) && look.usable_pixels < mean.pixels();
  if (look.all.high - look.all.low <= 1e-6 * look.all.largest() && !has_sky)
    return {step, false, "constant", Spared::Columns, mean.channels()};
  if (look.noise > 0.9 * look.variance) return {step, false, "nothing but noise", Spared::Columns, mean.channels()};
  return {step, true, "varies over the frame"};
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

/// Noise variance after transform(): times the squared slope of the transformation.
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

/// Both halves of a pass, taken from it and repaired; split from the mean where the file has none. half_variance: of
/// one half; may be empty.
std::array<Image, 2> halves_of(Pass& pass, const Image& half_variance, std::uint64_t stream, std::size_t& repaired) {
  if (pass.has_halves()) {
    std::array<Image, 2> halves{std::move(pass.half_a), std::move(pass.half_b)};
    for (Image& half : halves) repaired += repair_nonfinite(half, repair_radius);
    return halves;
  }
  Image mean = pass.mean;
  repaired += repair_nonfinite(mean, repair_radius);
  if (half_variance.empty()) return {mean, mean};
  Image variance = half_variance;
  scale(variance, Real(0.5));
  return split_halves(mean, variance, stream);
}

/// Noise variance of one half of a feature; empty where nothing is known of it. Where it is estimated both halves are
/// the mean itself: what a split adds costs as much as it tells.
Image feature_half_variance(Pass& pass, std::size_t& repaired) {
  if (!pass.variance.empty()) {
    Image variance = std::move(pass.variance);
    repaired += repair_nonfinite(variance, repair_radius);
    make_non_negative(variance);
    if (!pass.variance_is_estimated) scale(variance, 2);
    return variance;
  }
  if (!pass.has_halves()) return {};
  Image variance = pass.half_a;
  for_rows_of(variance, [&](int c, int y) {
    const Real* b = pass.half_b.row(c, y);
    Real* values = variance.row(c, y);
    for (int x = 0; x < variance.width(); ++x) values[x] = 2 * variance_of_mean(values[x], b[x]);
  });
  repaired += repair_nonfinite(variance, repair_radius);
  return variance;
}

/// Pixels in which some channel is below zero.
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

/// Halves of a colour pass that has none: it takes its share, pass / beauty, of what sets the beauty's halves apart.
/// Passes that add up to the beauty have halves that add up to its halves.
std::array<Image, 2> split_like(const std::array<Image, 2>& beauty, const Pass& pass, std::size_t& repaired) {
  Image mean = pass.mean;
  repaired += repair_nonfinite(mean, repair_radius);
  std::array<Image, 2> halves{mean, mean};
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < mean.pixels(); ++i) {
      const Real a = beauty[0].plane(c)[i], b = beauty[1].plane(c)[i], sum = a + b;
      if (!(std::abs(sum) > std::numeric_limits<Real>::min())) continue;
      // Part of the beauty is 0 to 1 of it; a layer that is none (an albedo) may be any multiple of a dark pixel.
      const Real share = std::clamp(2 * (mean.plane(c)[i] / sum), Real(0), Real(1));
      const Real offset = share * (Real(0.5) * (a - b));
      halves[0].plane(c)[i] += offset;
      halves[1].plane(c)[i] -= offset;
    }
  return halves;
}

void append_channels(const Image& from, Image& to, int& channel) {
  const int first = channel;
  in_parallel(static_cast<std::size_t>(from.channels()), [&](std::size_t k) {
    const int c = static_cast<int>(k);
    std::copy(from.plane(c), from.plane(c) + from.pixels(), to.plane(first + c));
  });
  channel += from.channels();
}

std::array<Image, 2> prepared_feature(Feature feature, const FeatureUse& use, std::size_t stream,
                                      const PrefilterParams& prefilter_params, std::size_t& repaired,
                                      Progress& progress) {
  Image variance = feature_half_variance(feature.pass, repaired);
  auto halves = halves_of(feature.pass, feature.pass.variance_is_estimated ? Image() : variance, stream, repaired);
  if (use.prefilter && !variance.empty()) {
    repair_nonfinite(feature.pass.mean, repair_radius);
    transform_variance(use, feature.pass.mean, variance);
    for (Image& half : halves) transform(use, half);
    return prefilter(halves, variance, prefilter_params, progress);
  }
  for (Image& half : halves) transform(use, half);
  return halves;
}

/// Whether a feature is cleaned, and why (or why not).
Decision decide_on_prefilter(const std::string& feature, const Pass& pass, const FeatureLook& look,
                             const Steps& steps) {
  const std::string step = feature + " prefilter";
  if (!steps.prefilter) return {step, false, "not requested"};
  if (!pass.noise_is_known()) return {step, false, "nothing is known of its noise"};
  if (!steps.decide) return {step, true, "requested"};
  const bool noisy = look.noise > noise_floor * look.variance;
  if (!noisy) return {step, false, "the pass is clean", Spared::Prefilter, pass.mean.channels()};
  const double share = static_cast<double>(look.noisy_pixels) / static_cast<double>(pass.mean.pixels());
  return {step, true, fmt::format("the pass is noisy in {:.0f} % of its pixels", 100 * share)};
}

}  // namespace

void require_usable(const Frame& frame) {
  if (!has_usable_pixel(frame.beauty.mean))
    throw Error(ExitCode::CheckFailed, "layer '" + frame.beauty.name + "': no finite pixel; render the frame again");
}

Preparation look_at(const Frame& frame, const Steps& steps) {
  require_usable(frame);
  Preparation out;
  const double brightness = mean_brightness(frame.beauty.mean);
  out.epsilon = brightness > 0 ? 0.09 * brightness * brightness : 1;
  std::vector<FeatureLook> looks(frame.features.size());
  in_parallel(looks.size(), [&](std::size_t i) { looks[i] = look_at_feature(frame.features[i], frame.sky_depth); });
  int channels = 0;
  for (std::size_t i = 0; i < frame.features.size(); ++i) {
    const Feature& feature = frame.features[i];
    const FeatureLook& look = looks[i];
    Decision decision = decide_on_feature(look, feature, steps);
    if (decision.run && channels + feature.pass.mean.channels() > BasisLayout::max_features) {
      decision.run = false;
      decision.reason = "the model is full: " + std::to_string(BasisLayout::max_features) + " channels";
    }
    out.decisions.push_back(decision);
    if (!decision.run) continue;
    channels += feature.pass.mean.channels();
    FeatureUse use;
    use.index = i;
    const Decision prefilter = decide_on_prefilter(decision.step, feature.pass, look, steps);
    use.prefilter = prefilter.run;
    if (const double largest = look.usual.largest(); largest > 0) use.scale = std::exp2(-std::ilogb(largest));
    if (is_depth(feature)) use.half_depth = median_depth(feature.pass.mean, frame.sky_depth);
    out.features.push_back(use);
    out.decisions.push_back(prefilter);
  }
  return out;
}

Prepared prepare(Frame& frame, const Preparation& preparation, const Image& variance,
                 const PrefilterParams& prefilter_params, bool with_alpha, Progress& progress) {
  Prepared out;
  HalfPair& pair = out.pair;
  pair.epsilon = preparation.epsilon;
  out.independent_halves = frame.beauty.has_halves();
  pair.variance = variance;
  repair_nonfinite(pair.variance, repair_radius);
  make_non_negative(pair.variance);
  scale(pair.variance, 2);  // of a half, from that of the mean
  out.negative_pixels = negative_pixels(frame.beauty.mean);

  const bool alpha = with_alpha && !frame.alpha.empty();
  const int channels = ColorLayout(static_cast<int>(frame.aovs.size()), alpha).channels();
  for (Image& color : pair.color) color = Image(frame.width(), frame.height(), channels);
  int begin = 0;
  const auto append = [&](const std::array<Image, 2>& halves) {
    int end = begin;
    for (std::size_t h = 0; h < 2; ++h) {
      end = begin;
      append_channels(halves[h], pair.color[h], end);
    }
    begin = end;
  };
  const auto beauty = halves_of(frame.beauty, pair.variance, preparation.stream, out.repaired_pixels);
  append(beauty);
  frame.beauty.variance = {};
  for (Pass& aov : frame.aovs) {
    append(aov.has_halves() ? halves_of(aov, {}, 0, out.repaired_pixels)
                            : split_like(beauty, aov, out.repaired_pixels));
    aov.variance = {};
  }
  if (alpha) {
    Pass pass{"alpha", frame.alpha, {}, {}, {}};
    append(halves_of(pass, {}, 0, out.repaired_pixels));
  }

  int feature_channels = 0;
  for (const FeatureUse& use : preparation.features) feature_channels += frame.features[use.index].pass.mean.channels();
  for (Image& features : pair.features) features = Image(frame.width(), frame.height(), feature_channels);
  int channel = 0;
  for (const FeatureUse& use : preparation.features) {
    const auto halves = prepared_feature(std::move(frame.features[use.index]), use, preparation.stream + use.index + 1,
                                         prefilter_params, out.repaired_pixels, progress);
    int end = channel;
    for (std::size_t h = 0; h < 2; ++h) {
      end = channel;
      append_channels(halves[h], pair.features[h], end);
    }
    channel = end;
  }
  frame.features.clear();
  return out;
}

}  // namespace polyrecon
