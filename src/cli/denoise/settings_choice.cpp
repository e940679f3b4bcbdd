#include "cli/denoise/settings_choice.h"

#include <fmt/format.h>

#include <algorithm>

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

// Seconds of writing a result over those of reading its input: it is compressed, and read back to be checked
// (docs/results/performance.md).
constexpr double write_over_read = 4;
// Pixels whose relative noise is below this share of the requested error hardly change its mean; they are skipped.
constexpr double skipped_noise = 0.1;

Json json_of(const Prediction& prediction) {
  return {{"settings", prediction.name}, {"seconds", prediction.seconds}, {"relmse", prediction.relative_mse}};
}

}  // namespace

ChosenSettings choose_settings_for(const Job& job, const FrameLimits& limits, const Frame& frame, double read_seconds,
                                   Progress& progress) {
  ChosenSettings out;
  out.pilot = run_pilot(frame, progress, job.denoiser.get());
  out.request.seconds = limits.after((1 + write_over_read) * read_seconds + out.pilot.spent).seconds;
  out.request.relative_mse = limits.relative_mse;
  out.choice = choose_settings(out.pilot, out.request, measured_figures());
  out.params = job.presets[out.choice.preset];
  out.params.enough = skipped_noise * out.request.relative_mse;
  return out;
}

std::string settings_choice_text(const ChosenSettings& s, double seconds) {
  const Prediction& chosen = s.choice.chosen;
  std::string text = fmt::format(
      "{}: {:.2g} s and relMSE {:.3g} predicted from {:.0f} % of the frame, the reconstruction took {:.2g} s",
      chosen.name, chosen.seconds, chosen.relative_mse, 100 * s.pilot.share, seconds);
  if (!s.choice.met) text += "; the request cannot be met";
  if (const auto& next = s.choice.next)
    text +=
        fmt::format("; the next more accurate settings, {}, would take {:.2g}x the time for {:.1f} % less error",
                    next->name, next->seconds / chosen.seconds, 100 * (1 - next->relative_mse / chosen.relative_mse));
  else
    text += "; no settings are more accurate: render more samples for less error";
  return text;
}

Json settings_choice_json(const ChosenSettings& s, double seconds) {
  return {{"met", s.choice.met},
          {"requested_seconds", s.request.seconds > 0 ? Json(s.request.seconds) : Json()},
          {"requested_relmse", s.request.relative_mse > 0 ? Json(s.request.relative_mse) : Json()},
          {"pilot", {{"share_of_frame", s.pilot.share}, {"seconds", s.pilot.spent}}},
          {"chosen", json_of(s.choice.chosen)},
          {"actual_seconds", seconds},
          {"next", s.choice.next ? json_of(*s.choice.next) : Json()}};
}

}  // namespace polyrecon
