#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/common/decisions_output.h"
#include "cli/common/roles_output.h"
#include "cli/inspect/report.h"
#include "io/channel_names.h"

namespace polyrecon {
namespace {

std::string text_of(const Rect& r) { return fmt::format("{}x{}{:+d}{:+d}", r.width(), r.height(), r.x0, r.y0); }

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

}  // namespace

std::string inspect_text(const InspectReport& report) {
  const Inspection& found = report.file;
  std::string text;
  for (const FileInfo& file : found.source.files) {
    text += fmt::format("{}: {}, {} bytes\n", file.path, file.format, file.bytes);
    for (std::size_t i = 0; i < file.parts.size(); ++i) text += text_of(file.parts[i], i);
  }
  text += fmt::format("  {:<38} {:<12} {:<20} {}\n", "layer", "role", "holds", "values");
  for (const Layer& layer : found.source.layers) text += text_of(layer, found.statistics_of(layer.name));
  text += roles_text(found.source);
  if (!found.missing.empty()) text += fmt::format("missing: {}\n", fmt::join(found.missing, ", "));
  if (found.samples > 0) text += fmt::format("samples per pixel: {:g}\n", found.samples);
  if (found.noise_level >= 0)
    text += fmt::format("noise level (variance / (mean^2 + 0.01)): {:.4g}\n", found.noise_level);
  for (const Decision& d : report.steps) text += fmt::format("step: {}: {}\n", d.step, decision_text(d));
  for (const FoundDenoiser& d : report.denoisers)
    text += fmt::format("--prior {}: {}\n", d.option, d.name.empty() ? d.problem : d.name + ", " + d.place);
  for (const std::string& note : found.notes) text += fmt::format("note: {}\n", note);
  return text;
}

}  // namespace polyrecon
