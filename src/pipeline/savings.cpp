#include "pipeline/savings.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace polyrecon {
namespace {

// One more feature channel makes the polynomials dearer by about this part: without normal, albedo (3 channels each)
// and depth (1) a run takes 0.83, 0.80 and 0.91 of the time (docs/results/accuracy.md).
constexpr double seconds_per_channel = 0.05;

/// Seconds that one thread takes to clean one channel of one pixel.
double cleaning_seconds(const Frame& frame, const PrefilterParams& cleaning) {
  const Rect block = intersect({0, 0, 128, 32}, frame.beauty.mean.bounds());
  const Image part = crop(frame.beauty.mean, block);
  Progress silent;
  const auto start = std::chrono::steady_clock::now();
  prefilter({part, part}, Image(part.width(), part.height(), 3, Real(1)), cleaning, silent);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return seconds / (3.0 * static_cast<double>(part.pixels()));
}

}  // namespace

Decision decide_on_pixels(double left_alone, const Params& params) {
  const std::string effect = "quiet pixels left";
  if (left_alone == 0)
    return {effect, false, params.effects.decide ? "every pixel carries noise" : "all pixels are asked for"};
  const char* why = params.enough > 0 ? "carries little noise or none" : "carries no noise";
  return {effect, true, fmt::format("{:.1f} % of the frame {}", 100 * left_alone, why), Spared::Pixels};
}

void estimate_savings(const Frame& frame, const PrefilterParams& cleaning, double left_alone, double polynomials,
                      std::vector<Decision>& decisions) {
  const double rate = cleaning_seconds(frame, cleaning);
  const auto pixels = static_cast<double>(frame.beauty.mean.pixels());
  for (Decision& d : decisions) switch (d.spared) {
      case Spared::Nothing:
        break;
      case Spared::Pixels:
        if (left_alone < 1) d.saved_seconds = polynomials * left_alone / (1 - left_alone);
        break;
      case Spared::Columns:
        d.saved_seconds = polynomials * seconds_per_channel * d.channels;
        break;
      case Spared::Cleaning:
        d.saved_seconds = rate * d.channels * pixels;
        break;
    }
}

}  // namespace polyrecon
