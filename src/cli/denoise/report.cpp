#include "cli/denoise/report.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <array>
#include <cmath>

#include "cli/common/decisions_output.h"
#include "cli/common/printed_text.h"
#include "cli/common/roles_output.h"

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN: what is not finite is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json rgb(const std::array<double, 3>& v) { return Json::array({number(v[0]), number(v[1]), number(v[2])}); }

std::string rgb_text(const std::array<double, 3>& v) { return fmt::format("{:.5g} {:.5g} {:.5g}", v[0], v[1], v[2]); }

double pixels_of(const Report& r) { return static_cast<double>(r.width) * static_cast<double>(r.height); }

double reconstruction_seconds(const Report& r) {
  double sum = 0;
  for (const PhaseTime& phase : r.phases) sum += phase.seconds;
  return sum;
}

double pixels_per_second(const Report& r) {
  const double seconds = reconstruction_seconds(r);
  return seconds > 0 ? pixels_of(r) / seconds : 0;
}

/// after / before - 1 of the sum over RGB.
double energy_change(const Report& r) {
  const double before = r.energy_before[0] + r.energy_before[1] + r.energy_before[2];
  const double after = r.energy_after[0] + r.energy_after[1] + r.energy_after[2];
  return before != 0 ? after / before - 1 : 0;
}

std::string line(const std::string& name, const std::string& value) { return text_line("  {:<26} {}", name, value); }

std::string windows_text(const Report& r) {
  std::string orders;
  for (std::size_t k = 0; k < r.windows_per_order.size(); ++k)
    if (r.windows_per_order[k])
      orders += fmt::format(", {} {}", k == 0 ? std::string("mean:") : fmt::format("order {}:", k - 1),
                            r.windows_per_order[k]);
  return fmt::format("{}{}", r.windows, orders);
}

Json windows_json(const Report& r) {
  Json per_order{{"constant", r.windows_per_order[0]}};
  for (std::size_t k = 1; k < r.windows_per_order.size(); ++k)
    per_order[std::to_string(k - 1)] = r.windows_per_order[k];
  return {{"count", r.windows}, {"per_order", per_order}, {"rank_deficient", r.rank_deficient_windows}};
}

}  // namespace

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts in kilobytes
}

std::string report_text(const RunReport& run) {
  const Report& r = run.reconstruction;
  std::string text = text_line("{} -> {}, {} x {}{}", run.input, run.output, r.width, r.height,
                               run.title.empty() ? "" : ", " + run.title);
  text += line("read", fmt::format("{:.2f} s", run.read_seconds));
  for (const PhaseTime& phase : r.phases) text += line(phase.phase, fmt::format("{:.2f} s", phase.seconds));
  text += line("write", fmt::format("{:.2f} s", run.write_seconds));
  text +=
      line("total", fmt::format("{:.2f} s, {:.0f} pixels/s in the reconstruction", run.seconds, pixels_per_second(r)));
  text += line("peak memory", fmt::format("{:.0f} MB", static_cast<double>(run.peak_memory) / 1e6));
  text += line("variance", r.variance_source);
  for (const Decision& d : r.decisions) text += line(d.step, decision_text(d));
  if (run.chosen) text += line("settings chosen", settings_choice_text(*run.chosen, reconstruction_seconds(r)));
  if (r.neighbours > 0)
    text += line("neighbours in time",
                 fmt::format("{} frames, mean weight {:.2f} (the frame itself: 1)", r.neighbours, r.neighbour_weight));
  text += line("windows", windows_text(r));
  text += line("corrections", fmt::format("{} windows rank-deficient, {} not finite; {} pixels kept noisy, "
                                          "{} raised to the input",
                                          r.rank_deficient_windows, r.windows_not_finite, r.pixels_kept_noisy,
                                          r.pixels_raised_to_input));
  text += line("input pixels", fmt::format("{} repaired, {} negative", r.repaired_pixels, r.negative_pixels));
  text += line("fireflies", fmt::format("{}, redistributed energy {}", r.outliers, rgb_text(r.outlier_energy)));
  text += line("energy (mean RGB)", fmt::format("{} -> {} ({:+.3f} %)", rgb_text(r.energy_before),
                                                rgb_text(r.energy_after), 100 * energy_change(r)));
  text += line("restored gain", fmt::format("{:+.3f} {:+.3f} {:+.3f} %", 100 * r.restored_gain[0],
                                            100 * r.restored_gain[1], 100 * r.restored_gain[2]));
  text += line("estimated relMSE", fmt::format("{:.5g}", r.estimated_relative_mse));
  for (const std::string& note : run.notes) text += line("note", note);
  return text;
}

Json report_json(const RunReport& run, const FrameSource& source) {
  const Report& r = run.reconstruction;
  Json phases = Json::array();
  for (const PhaseTime& phase : r.phases) phases.push_back({{"phase", phase.phase}, {"seconds", phase.seconds}});
  return {{"polyrecon", run.version},
          {"input", run.input},
          {"output", run.output},
          {"settings", run.settings},
          {"view_layer", run.picture.place.view_layer},
          {"view", run.picture.place.view},
          {"layer", run.picture.layer},
          {"width", r.width},
          {"height", r.height},
          {"roles", roles_json(source)},
          {"settings_choice", run.chosen ? settings_choice_json(*run.chosen, reconstruction_seconds(r)) : Json()},
          {"variance_source", r.variance_source},
          {"decisions", decisions_json(r.decisions)},
          {"phases", phases},
          {"seconds",
           {{"read", run.read_seconds},
            {"reconstruct", reconstruction_seconds(r)},
            {"write", run.write_seconds},
            {"total", run.seconds}}},
          {"pixels_per_second", pixels_per_second(r)},
          {"peak_memory_bytes", run.peak_memory},
          {"neighbours",
           {{"frames", r.neighbours},
            {"mean_weight", number(r.neighbour_weight)},
            {"shared_noise", number(r.neighbour_shared_noise)}}},
          {"windows", windows_json(r)},
          {"corrections",
           {{"windows_not_finite", r.windows_not_finite},
            {"pixels_kept_noisy", r.pixels_kept_noisy},
            {"pixels_raised_to_input", r.pixels_raised_to_input}}},
          {"repaired_pixels", r.repaired_pixels},
          {"negative_pixels", r.negative_pixels},
          {"fireflies", {{"count", r.outliers}, {"energy", rgb(r.outlier_energy)}}},
          {"energy",
           {{"before", rgb(r.energy_before)},
            {"after", rgb(r.energy_after)},
            {"restored_gain", rgb(r.restored_gain)},
            {"relative_change", number(energy_change(r))}}},
          {"estimated_relmse", number(r.estimated_relative_mse)},
          {"notes", run.notes}};
}

}  // namespace polyrecon
