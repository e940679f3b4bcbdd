#include "cli/compare/comparison_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/common/frame_names.h"
#include "cli/common/printed_text.h"
#include "io/pictures/false_color.h"

namespace polyrecon {
namespace {

using Json = nlohmann::ordered_json;

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(); }

}  // namespace

std::string figure_text(const char* format, double value) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "nan";
}

std::vector<std::string> notes_of(const std::vector<Comparison>& comparisons) {
  std::vector<std::string> notes;
  for (const Comparison& c : comparisons)
    for (const std::string& note : c.notes)
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  return notes;
}

std::string comparison_text(const std::vector<Comparison>& comparisons) {
  std::string text;
  for (const Comparison& c : comparisons)
    text += text_line("{}: {}  relMSE {}  trimmed {}  energy {}  FLIP {:.4f}  bad {}", c.image, shown_layer(c),
                      figure_text("{:.5f}", c.score.relative_mse), figure_text("{:.5f}", c.score.trimmed),
                      figure_text("{:+.5f}", c.score.energy), c.flip, c.score.bad);
  for (const std::string& note : notes_of(comparisons)) text += text_line("note: {}", note);
  return text;
}

SequenceFigures sequence_figures(const std::vector<const Comparison*>& frames) {
  SequenceFigures sum;
  double changes = 0;
  for (const Comparison* c : frames) {
    const auto count = static_cast<double>(frames.size());
    sum.relative_mse += c->score.relative_mse / count;
    sum.trimmed += c->score.trimmed / count;
    sum.energy += c->score.energy / count;
    sum.flip += c->flip / count;
    sum.bad += c->score.bad;
    if (!c->flicker) continue;
    sum.flicker = sum.flicker.value_or(0) + *c->flicker;
    ++changes;
  }
  if (sum.flicker) *sum.flicker /= changes;
  return sum;
}

std::string sequences_text(const std::string& image, const std::vector<Comparison>& comparisons) {
  std::string text;
  for (const std::string& layer : layers_of(comparisons)) {
    std::vector<const Comparison*> frames;
    for (const Comparison& c : comparisons)
      if (c.layer == layer) frames.push_back(&c);
    const SequenceFigures f = sequence_figures(frames);
    text += text_line("{}: {}  {} frames  relMSE {}  trimmed {}  energy {}  FLIP {:.4f}  bad {}{}", image,
                      shown_layer(*frames.front()), frames.size(), figure_text("{:.5f}", f.relative_mse),
                      figure_text("{:.5f}", f.trimmed), figure_text("{:+.5f}", f.energy), f.flip, f.bad,
                      f.flicker ? fmt::format("  flicker {:.6f}", *f.flicker) : std::string());
  }
  return text;
}

Json comparison_json(const std::string& reference, const std::vector<Comparison>& comparisons) {
  Json results = Json::array();
  for (const Comparison& c : comparisons)
    results.push_back({{"image", c.image},
                       {"layer", c.layer},
                       {"relMSE", number(c.score.relative_mse)},
                       {"trimmed", number(c.score.trimmed)},
                       {"energy", number(c.score.energy)},
                       {"FLIP", number(c.flip)},
                       {"bad", c.score.bad},
                       {"frame", c.frame ? Json(*c.frame) : Json()},
                       {"flicker", c.flicker ? number(*c.flicker) : Json()}});
  return {{"reference", reference}, {"results", results}, {"notes", notes_of(comparisons)}};
}

std::vector<std::string> layers_of(const std::vector<Comparison>& comparisons) {
  std::vector<std::string> layers;
  for (const Comparison& c : comparisons)
    if (std::find(layers.begin(), layers.end(), c.layer) == layers.end()) layers.push_back(c.layer);
  return layers;
}

LogRange error_range(const std::vector<Comparison>& comparisons, const std::string& layer) {
  LogRange range;
  for (const Comparison& c : comparisons) {
    const LogRange found = c.layer == layer ? log_range(c.error) : LogRange();
    if (found.high > range.high) range = found;
  }
  return range;
}

Image comparison_picture(const std::vector<Comparison>& comparisons, const DisplayParams& display) {
  std::vector<Image> rows;
  for (const std::string& layer : layers_of(comparisons)) {
    const LogRange range = error_range(comparisons, layer);
    std::vector<Panel> panels;
    for (const Comparison& c : comparisons) {
      if (c.layer != layer) continue;
      if (panels.empty()) panels.push_back({to_display(c.reference, display), "reference: " + shown_layer(c), {}});
      panels.push_back({to_display(c.picture, display), file_name(c.image), {}});
      panels.push_back({false_color(c.error, range),
                        fmt::format("relMSE {:.4g}, FLIP {:.3g}", c.score.relative_mse, c.flip), range});
    }
    rows.push_back(compose(panels));
  }
  return stack(rows);
}

}  // namespace polyrecon
