#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/commands.h"
#include "cli/common/checks.h"
#include "cli/common/decisions_output.h"
#include "cli/common/read_limits.h"
#include "cli/common/roles_output.h"
#include "features/prepare.h"
#include "io/inspect.h"
#include "noise/variance.h"
#include "pipeline/savings.h"
#include "sweep/settings_choice.h"

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

struct InspectOptions {
  std::string input;
  ReadOptions read;
  bool json = false;
};

std::string text_of(const Rect& r) { return fmt::format("{}x{}{:+d}{:+d}", r.width(), r.height(), r.x0, r.y0); }

Json json_of(const Rect& r) { return {{"x", r.x0}, {"y", r.y0}, {"width", r.width()}, {"height", r.height()}}; }

Json json_of(const PartInfo& part) {
  auto channels = Json::array();
  for (const ChannelInfo& c : part.channels) channels.push_back({{"name", c.name}, {"type", name_of(c.type)}});
  return {{"name", part.name},
          {"view", part.view},
          {"data_window", json_of(part.data_window)},
          {"display_window", json_of(part.display_window)},
          {"compression", part.compression},
          {"tiled", part.tiled},
          {"deep", part.deep},
          {"readable", part.readable()},
          {"channels", channels}};
}

Json json_of(const Layer& layer, const LayerStatistics* s) {
  Json out{{"name", layer.name},
           {"view_layer", layer.view_layer},
           {"view", layer.view},
           {"file", layer.file},
           {"part", layer.part},
           {"channels", layer.channels},
           {"role", name_of(layer.role)},
           {"holds", name_of(layer.companion)},
           {"of", layer.of},
           {"why", layer.why}};
  if (s)
    out.update({{"nan", s->nan},
                {"infinite", s->infinite},
                {"negative", s->negative},
                {"minimum", s->minimum},
                {"maximum", s->maximum},
                {"mean", s->mean}});
  return out;
}

const LayerStatistics* statistics_of(const Inspection& found, const std::string& layer) {
  const auto at = std::find_if(found.statistics.begin(), found.statistics.end(),
                               [&](const LayerStatistics& s) { return s.layer == layer; });
  return at == found.statistics.end() ? nullptr : &*at;
}

/// Which steps denoise would run, and what the others would take at standard quality, by a pilot on some tiles; none
/// to tell of a file without a beauty. Outliers show only in the work itself.
std::vector<Decision> steps_of(const InspectOptions& o, const Inspection& found) {
  const auto& chosen = found.source.chosen;
  if (std::none_of(chosen.begin(), chosen.end(), [](const RoleChoice& c) { return c.role == Role::Beauty; })) return {};
  Frame frame = read_frame(o.input, o.read).frame;
  require_usable(frame);
  const double seconds = standard_seconds(run_pilot(frame, silent_progress()), measured_figures());
  estimate_feature_variance(frame,
                            silent_progress());  // after the pilot, whose tiles have theirs estimated by themselves
  std::vector<Decision> decisions = look_at(frame).decisions;
  estimate_savings(frame, params_for(Quality::Standard).prefilter, 0, seconds, decisions);
  return decisions;
}

Json json_of(const Inspection& found, const std::vector<Decision>& decisions) {
  Json files = Json::array(), layers = Json::array();
  for (const FileInfo& file : found.source.files) {
    Json parts = Json::array();
    for (const PartInfo& part : file.parts) parts.push_back(json_of(part));
    files.push_back({{"path", file.path}, {"format", file.format}, {"bytes", file.bytes}, {"parts", parts}});
  }
  for (const Layer& layer : found.source.layers) layers.push_back(json_of(layer, statistics_of(found, layer.name)));
  return {{"files", files},
          {"layers", layers},
          {"view_layer", found.source.view_layer},
          {"roles", roles_json(found.source)},
          {"missing", found.missing},
          {"samples", found.samples > 0 ? Json(found.samples) : Json()},
          {"noise_level", found.noise_level >= 0 ? Json(found.noise_level) : Json()},
          {"steps", decisions_json(decisions)},
          {"notes", found.notes}};
}

std::string text_of(const PartInfo& part, std::size_t index) {
  std::string kind = part.deep ? "deep " : "";
  kind += part.tiled ? "tiled" : "scanline";
  return fmt::format("part {} {}: data {}, display {}, {} {}, {} channels\n", index,
                     part.name.empty() ? "(no name)" : "'" + part.name + "'", text_of(part.data_window),
                     text_of(part.display_window), kind, part.compression, part.channels.size());
}

std::string text_of(const Layer& layer, const LayerStatistics* s) {
  const std::string view = layer.view.empty() ? "" : fmt::format(" [{}]", layer.view);
  std::string line = fmt::format("  {:<38} {:<12} {:<20}", (layer.name.empty() ? "(no name)" : layer.name) + view,
                                 name_of(layer.role), name_of(layer.companion));
  if (s) {
    line += fmt::format(" {:>11.4g} .. {:<11.4g} mean {:<10.4g}", s->minimum, s->maximum, s->mean);
    if (s->nan) line += fmt::format(" {} NaN", s->nan);
    if (s->infinite) line += fmt::format(" {} Inf", s->infinite);
    if (s->negative) line += fmt::format(" {} negative", s->negative);
  }
  return line + "\n";
}

std::string text_of(const Inspection& found, const std::vector<Decision>& decisions) {
  std::string text;
  for (const FileInfo& file : found.source.files) {
    text += fmt::format("{}: {}, {} bytes\n", file.path, file.format, file.bytes);
    for (std::size_t i = 0; i < file.parts.size(); ++i) text += text_of(file.parts[i], i);
  }
  text += fmt::format("  {:<38} {:<12} {:<20} {}\n", "layer", "role", "holds", "values");
  for (const Layer& layer : found.source.layers) text += text_of(layer, statistics_of(found, layer.name));
  text += roles_text(found.source);
  if (!found.missing.empty()) text += fmt::format("missing: {}\n", fmt::join(found.missing, ", "));
  if (found.samples > 0) text += fmt::format("samples per pixel: {:g}\n", found.samples);
  if (found.noise_level >= 0)
    text += fmt::format("noise level (variance / (mean^2 + 0.01)): {:.4g}\n", found.noise_level);
  for (const Decision& d : decisions) text += fmt::format("step: {}: {}\n", d.step, decision_text(d));
  for (const std::string& note : found.notes) text += fmt::format("note: {}\n", note);
  return text;
}

void run(const InspectOptions& o) {
  require_readable(o.input);
  const Inspection found = inspect(o.input, o.read);
  const std::vector<Decision> steps = steps_of(o, found);
  std::fputs((o.json ? json_of(found, steps).dump(2) + "\n" : text_of(found, steps)).c_str(), stdout);
}

}  // namespace

void setup_inspect(CLI::App& app, Command& chosen) {
  const auto o = std::make_shared<InspectOptions>();
  CLI::App* sub = app.add_subcommand("inspect", "Tells what a file holds and the role of each layer");
  sub->add_option("file", o->input, "Render to look at")->required()->type_name("FILE");
  sub->add_flag("--json", o->json, "Print JSON");
  sub->add_option("--view-layer", o->read.view_layer, "View layer to choose roles from")->type_name("NAME");
  OptionSet set(*sub);
  add_read_limits(set, o->read.limits);
  sub->footer(
      "Examples:\n"
      "  polyrecon inspect render.exr\n"
      "  polyrecon inspect render.exr --json");
  sub->callback([o, &chosen] { chosen = [o] { run(*o); }; });
}

}  // namespace polyrecon
