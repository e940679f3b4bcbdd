#include "cli/denoise/report.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <utility>

#include "cli/common/advice_output.h"
#include "cli/common/decisions_output.h"
#include "cli/common/printed_text.h"
#include "cli/common/roles_output.h"
#include "core/mean.h"
#include "io/layers/channel_names.h"
#include "pipeline/report_json.h"

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

std::string rgb_text(const std::array<double, 3>& v) { return fmt::format("{:.5g} {:.5g} {:.5g}", v[0], v[1], v[2]); }

std::string line(const std::string& name, const std::string& value) { return text_line("  {:<26} {}", name, value); }

std::string windows_text(const Report& r) {
  std::string orders;
  for (std::size_t k = 0; k < r.windows_per_order.size(); ++k)
    if (r.windows_per_order[k])
      orders += fmt::format(", {} {}", k == 0 ? std::string("mean:") : fmt::format("order {}:", k - 1),
                            r.windows_per_order[k]);
  return fmt::format("{}{}", r.windows, orders);
}

/// "ViewLayer.Combined with normal, albedo, variance"
std::string layers_text(const ReadResult& in) {
  std::string beauty, with;
  bool has_variance = false, has_halves = false;
  for (const RoleChoice& choice : in.source.chosen) {
    const bool is_mean = choice.companion == Companion::Mean;
    if (choice.role == Role::Beauty && is_mean) beauty = choice.layer.empty() ? "RGB" : choice.layer;
    if (choice.role == Role::Beauty && is_variance(choice.companion)) has_variance = true;
    if (choice.role == Role::Beauty && choice.companion == Companion::HalfA) has_halves = true;
    if (is_mean && (info_of(choice.role).feature || choice.role == Role::Prior))
      with += fmt::format("{}{}", with.empty() ? "" : ", ", name_of(choice.role));
  }
  for (const auto& [has, name] : {std::pair(has_variance, "variance"), std::pair(has_halves, "halves")})
    if (has) with += fmt::format("{}{}", with.empty() ? "" : ", ", name);
  const std::size_t aovs = in.frame.aovs.size();
  return fmt::format("{}{}{}{}", beauty, with.empty() ? "" : " with ", with,
                     aovs > 0 ? fmt::format(", and {} light AOV{}", aovs, aovs == 1 ? "" : "s") : "");
}

std::string short_text(const RunReport& run, const std::vector<std::string>& advice) {
  const Report& r = run.reconstruction;
  const std::string before = std::isfinite(run.noise_before) ? fmt::format("{:.3g} -> ", run.noise_before) : "";
  std::string text =
      text_line("{}{}: estimated relMSE {}{:.3g}, {:.1f} s", run.output, run.title.empty() ? "" : ", " + run.title,
                before, r.estimated_relative_mse, run.seconds);
  if (run.chosen) text += line("settings chosen", settings_choice_text(*run.chosen, reconstruction_seconds(r)));
  for (const std::string& better : advice) text += text_line("  better: {}", better);
  for (const std::string& note : run.notes) text += text_line("  note: {}", note);
  return text;
}

std::string all_figures(const RunReport& run, const std::vector<std::string>& advice) {
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
  for (const std::string& better : advice) text += line("better", better);
  for (const std::string& note : run.notes) text += line("note", note);
  return text;
}

}  // namespace

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts in kilobytes
}

std::string input_text(const ReadResult& in, const std::string& picture, Verbosity verbosity) {
  if (verbosity == Verbosity::Quiet) return {};
  std::string line = fmt::format("{}: {} x {}", in.source.path, in.frame.width(), in.frame.height());
  if (!picture.empty() && (in.source.pictures.size() > 1 || verbosity == Verbosity::Full)) line += ", " + picture;
  if (verbosity == Verbosity::Full) return text_line("{}", line) + roles_text(in.source);
  if (const double samples = mean_samples(in.frame.sample_count); samples > 0)
    line += fmt::format(", {:.4g} samples per pixel", samples);
  return text_line("{}, {}", line, layers_text(in));
}

std::string report_text(const RunReport& run, const std::vector<std::string>& advice, Verbosity verbosity) {
  if (verbosity == Verbosity::Quiet) return {};
  return verbosity == Verbosity::Full ? all_figures(run, advice) : short_text(run, advice);
}

Json report_json(const RunReport& run, const FrameSource& source) {
  const Report& r = run.reconstruction;
  Json json{{"polyrecon", run.version},
            {"input", run.input},
            {"output", run.output},
            {"settings", run.settings},
            {"view_layer", run.picture.place.view_layer},
            {"view", run.picture.place.view},
            {"layer", run.picture.layer},
            {"roles", roles_json(source)},
            {"settings_choice", run.chosen ? settings_choice_json(*run.chosen, reconstruction_seconds(r)) : Json()},
            {"seconds",
             {{"read", run.read_seconds},
              {"reconstruct", reconstruction_seconds(r)},
              {"write", run.write_seconds},
              {"total", run.seconds}}},
            {"peak_memory_bytes", run.peak_memory}};
  json.update(report_json(r));
  json["noise_before"] = std::isfinite(run.noise_before) ? Json(run.noise_before) : Json();
  json["advice"] = advice_json(run.advice);
  json["missed"] = run.missed;
  json["notes"] = run.notes;
  return json;
}

}  // namespace polyrecon
