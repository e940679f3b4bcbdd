#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/common/decisions_output.h"
#include "cli/common/printed_text.h"
#include "cli/common/roles_output.h"
#include "cli/inspect/report.h"
#include "core/relmse.h"
#include "io/layers/channel_names.h"

namespace polyrecon {
namespace {

std::string text_of(const Rect& r) { return fmt::format("{}x{}{:+d}{:+d}", r.width(), r.height(), r.x0, r.y0); }

std::string text_of(const PartInfo& part, std::size_t index) {
  std::string kind = part.deep ? "deep " : "";
  kind += part.tiled ? "tiled" : "scanline";
  return text_line("part {} {}: data {}, display {}, {} {}, {} channels", index,
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
  return text_line("{}", line);
}

}  // namespace

std::string inspect_text(const InspectReport& report) {
  const Inspection& found = report.file;
  std::string text;
  for (const FileInfo& file : found.source.files) {
    text += text_line("{}: {}, {} bytes", file.path, file.format, file.bytes);
    for (std::size_t i = 0; i < file.parts.size(); ++i) text += text_of(file.parts[i], i);
  }
  text += text_line("  {:<38} {:<12} {:<20} {}", "layer", "role", "holds", "values");
  for (const Layer& layer : found.source.layers) text += text_of(layer, found.statistics_of(layer.name));
  text += roles_text(found.source);
  if (!found.missing.empty()) text += text_line("missing: {}", fmt::join(found.missing, ", "));
  for (const std::string& advice : advice_lines(report.advice)) text += text_line("better: {}", advice);
  if (found.samples > 0) text += text_line("samples per pixel: {:g}", found.samples);
  if (found.noise_level >= 0)
    text += text_line("noise level (variance / (mean^2 + {:g})): {:.4g}", relmse_floor, found.noise_level);
  for (const Decision& d : report.steps) text += text_line("step: {}: {}", d.step, decision_text(d));
  for (const FoundDenoiser& d : report.denoisers)
    text += text_line("--prior {}: {}", d.option, d.name.empty() ? d.problem : d.name + ", " + d.place);
  for (const std::string& note : found.notes) text += text_line("note: {}", note);
  return text;
}

}  // namespace polyrecon
