#include "pipeline/savings.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rect.h"
#include "core/stopwatch.h"
#include "features/prefilter.h"

namespace polyrecon {
namespace {

// Part of the time of the fits that one feature channel takes. Without all 8 of them a run takes 0.63 of the time ("all
// features" in docs/results/accuracy.md).
constexpr double seconds_per_channel = 0.05;

/// Seconds that the prefilter takes for one channel of one pixel.
double prefilter_seconds(const Frame& frame, const PrefilterParams& prefilter_params) {
  const Rect block = intersect({0, 0, 128, 32}, frame.beauty.mean.bounds());
  const Image part = crop(frame.beauty.mean, block);
  const Stopwatch watch;
  prefilter({part, part}, Image(part.width(), part.height(), 3, Real(1)), prefilter_params, silent_progress());
  return watch.seconds() / (3.0 * static_cast<double>(part.pixels()));
}

}  // namespace

Decision decide_on_pixels(double skipped, const Params& params) {
  const std::string step = "noise-free pixels skipped";
  if (skipped == 0) return {step, false, params.steps.decide ? "every pixel has noise" : "all pixels are requested"};
  const char* why = params.enough > 0 ? "has little noise or none" : "has no noise";
  return {step, true, fmt::format("{:.1f} % of the frame {}", 100 * skipped, why), Spared::Pixels};
}

void estimate_savings(const Frame& frame, const PrefilterParams& prefilter_params, double skipped, double polynomials,
                      std::vector<Decision>& decisions) {
  const double rate = prefilter_seconds(frame, prefilter_params);
  const auto pixels = static_cast<double>(frame.beauty.mean.pixels());
  for (Decision& d : decisions) switch (d.spared) {
      case Spared::Nothing:
        break;
      case Spared::Pixels:
        if (skipped < 1) d.saved_seconds = polynomials * skipped / (1 - skipped);
        break;
      case Spared::Columns:
        d.saved_seconds = polynomials * seconds_per_channel * d.channels;
        break;
      case Spared::Prefilter:
        d.saved_seconds = rate * d.channels * pixels;
        break;
    }
}

}  // namespace polyrecon
