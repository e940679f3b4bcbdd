#include "features/choose_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/halves.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/repair.h"
#include "polyrecon/error.h"
#include "regression/basis.h"

namespace polyrecon {
namespace {

constexpr double noise_floor = 1e-5;  // noise variance over variance of the feature below which it is not prefiltered

/// Mean of the finite, positive values of the beauty over all pixels inside the mask.
double mean_brightness(const Image& beauty, const Image& mask) {
  const double sum = ordered_sum(static_cast<std::size_t>(beauty.height()), [&](std::size_t y) {
    double row = 0;
    for (int c = 0; c < 3; ++c) {
      const Real* values = beauty.row(c, static_cast<int>(y));
      for (int x = 0; x < beauty.width(); ++x)
        if (usable(values[x]) && values[x] > 0) row += static_cast<double>(values[x]);
    }
    return row;
  });
  return sum / (3.0 * static_cast<double>(mask_pixels(mask, beauty.pixels())));
}

struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();

  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool contains(double v) const { return low <= v && v <= high; }
  double largest() const { return std::max(std::abs(low), std::abs(high)); }
};

/// Statistics of a feature's values and noise over the frame. Its usual values are those without spikes.
struct FeatureStatistics {
  Range all, usual;     ///< The range of all values, and of the usual ones.
  double variance = 0;  ///< Variance of the usual values over the frame, averaged over the channels.
  double noise = 0;     ///< Mean noise variance of the usual values.
  std::size_t usable_pixels = 0, noisy_pixels = 0;
};

/// Whether a value is finite and nearer than the sky.
bool usable_value(const Feature& feature, double sky, Real value) {
  return usable(value) && !(may_show_sky(feature) && static_cast<double>(value) >= sky);
}

/// The range of a channel's values without spikes: from the quantile of 0.5 % to that of 99.5 %, widened by this
/// distance on either side. It is unbounded where the quantiles are equal, as a value that differs is no spike there.
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

/// sky: Frame::sky_depth.
FeatureStatistics statistics_of(const Feature& feature, double sky) {
  FeatureStatistics found;
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
      found.all.add(v);
      if (!usual.contains(v)) continue;
      ++count;
      found.usual.add(v);
      sum += v;
      square += v * v;
      const double variance = known_variance(feature.pass, c, i);
      noise += variance;
      noisy += variance > 0;
    }
    if (count == 0) continue;
    const double n = static_cast<double>(count), m = sum / n;
    found.variance += std::max(0.0, square / n - m * m) / mean.channels();
    found.noise += noise / n / mean.channels();
    found.usable_pixels = std::max(found.usable_pixels, pixels);
    found.noisy_pixels = std::max(found.noisy_pixels, noisy);
  }
  return found;
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

/// Whether a feature takes part in the fit, and why.
Decision decide_on_feature(const FeatureStatistics& found, const Feature& feature, const Steps& steps) {
  const std::string step = std::string("feature ") + name_of(feature.role);
  const Image& mean = feature.pass.mean;
  if (!steps.features.has(feature.role)) return {step, false, "not requested"};
  if (found.usable_pixels == 0) return {step, false, "no finite value"};
  if (!steps.decide) return {step, true, "requested"};
  const bool has_sky = may_show_sky(feature) && found.usable_pixels < mean.pixels();
  if (found.all.high - found.all.low <= 1e-6 * found.all.largest() && !has_sky)
    return {step, false, "constant", Spared::Columns, mean.channels()};
  if (found.noise > 0.9 * found.variance) return {step, false, "nothing but noise", Spared::Columns, mean.channels()};
  return {step, true, "varies over the frame"};
}

/// Whether a feature is prefiltered, and why.
Decision decide_on_prefilter(const std::string& feature, const Pass& pass, const FeatureStatistics& found,
                             const Steps& steps) {
  const std::string step = feature + " prefilter";
  if (!steps.prefilter) return {step, false, "not requested"};
  if (!pass.noise_is_known()) return {step, false, "its noise is unknown"};
  if (!steps.decide) return {step, true, "requested"};
  const bool noisy = found.noise > noise_floor * found.variance;
  if (!noisy) return {step, false, "the pass has no noise", Spared::Prefilter, pass.mean.channels()};
  const double share = static_cast<double>(found.noisy_pixels) / static_cast<double>(pass.mean.pixels());
  return {step, true, fmt::format("the pass is noisy in {:.0f} % of its pixels", 100 * share)};
}

}  // namespace

void require_usable(const Frame& frame) {
  if (!has_usable_pixel(frame.beauty.mean))
    throw Error(ExitCode::CheckFailed,
                "layer '" + frame.beauty.name + "': no pixel is finite and at most 1e15; render the frame again");
}

Preparation choose_features(const Frame& frame, const Steps& steps, const Image& sampled) {
  require_usable(frame);
  Preparation out;
  const double brightness = mean_brightness(frame.beauty.mean, sampled);
  out.epsilon = brightness > 0 ? 0.09 * brightness * brightness : 1;
  std::vector<FeatureStatistics> statistics(frame.features.size());
  in_parallel(statistics.size(), [&](std::size_t i) {
    const Feature& feature = frame.features[i];
    if (steps.features.has(feature.role)) statistics[i] = statistics_of(feature, frame.sky_depth);
  });
  int channels = 0;
  for (std::size_t i = 0; i < frame.features.size(); ++i) {
    const Feature& feature = frame.features[i];
    const FeatureStatistics& found = statistics[i];
    Decision decision = decide_on_feature(found, feature, steps);
    if (decision.run && channels + feature.pass.mean.channels() > BasisLayout::max_features) {
      decision.run = false;
      decision.reason = "the model is full: " + std::to_string(BasisLayout::max_features) + " channels";
    }
    out.decisions.push_back(decision);
    if (!decision.run) continue;
    channels += feature.pass.mean.channels();
    FeatureUse use;
    use.role = feature.role;
    use.index = i;
    const Decision prefilter = decide_on_prefilter(decision.step, feature.pass, found, steps);
    use.prefilter = prefilter.run;
    use.flatten = feature.pass.variance_is_estimated && !frame.beauty.noise_is_known();
    if (const double largest = found.usual.largest(); largest > 0) use.scale = std::exp2(-std::ilogb(largest));
    if (info_of(feature.role).transform == FeatureTransform::BoundedDepth)
      use.half_depth = median_depth(feature.pass.mean, frame.sky_depth);
    out.features.push_back(use);
    out.decisions.push_back(prefilter);
  }
  return out;
}

}  // namespace polyrecon
