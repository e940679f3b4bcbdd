#include "cli/compare/comparison_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "cli/compare/comparison_output.h"
#include "core/relmse.h"
#include "core/resample.h"
#include "html/page.h"
#include "io/pictures/false_color.h"
#include "io/pictures/png_file.h"

namespace polyrecon {
namespace {

constexpr int widest = 1920;  // pixels of a picture

constexpr int page_width = 1280;  // CSS pixels

constexpr const char* rules = R"(
td.best{font-weight:700}
.viewer{display:flex;flex-wrap:wrap;gap:.3rem;margin-top:.8rem}
.viewer input{position:absolute;opacity:0}
.viewer label{padding:.15rem .7rem;border:1px solid var(--line);border-radius:4px;cursor:pointer}
.viewer input:checked+label{background:var(--text);color:var(--ground)}
.viewer input:focus-visible+label{outline:2px solid #3b82f6;outline-offset:2px}
.shown{flex-basis:100%;display:grid}
.shown figure{grid-area:1/1;margin:0;visibility:hidden}
.shown img{width:100%;display:block;image-rendering:pixelated}
.shown .scale{height:.7rem;margin-top:.4rem}
.ends{display:flex;justify-content:space-between}
)";

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// A picture that the viewer can show.
struct View {
  std::string name, picture;  ///< picture: a data URI.
  std::string below;          ///< HTML below it: the scale of a picture in false colours.
};

/// A bar of colours, the values of its ends, and what the values are.
std::string scale(const Image& colors, const std::string& low, const std::string& high, const std::string& meaning) {
  return fmt::format(
      "<img class='scale' alt='' src='{}'><div class='ends soft'><span>{}</span><span>{}</span><span>{}</span></div>",
      png_data_uri(colors), low, meaning, high);
}

/// 256 values from low to high, evenly spaced or evenly spaced in their logarithm.
Image ramp(double low, double high, bool logarithmic) {
  Image values(256, 1, 1);
  for (int i = 0; i < 256; ++i)
    values.at(i, 0, 0) =
        static_cast<Real>(logarithmic ? low * std::pow(high / low, i / 255.0) : low + (high - low) * i / 255);
  return values;
}

std::string error_scale(const LogRange& range) {
  if (range.high <= 0) return "<p class='soft'>no difference</p>";
  return scale(false_color(ramp(range.low, range.high, true), range), fmt::format("{:.3g}", range.low),
               fmt::format("{:.3g}", range.high), "squared relative error, logarithmic");
}

/// The reference, the images, then the differences: one press of an arrow key shows the next one.
std::vector<View> views_of(const std::vector<const Comparison*>& images, const LogRange& range,
                           const DisplayParams& display) {
  const auto picture = [](const Image& rgb) { return png_data_uri(at_most_wide(rgb, widest)); };
  std::vector<View> views{{"reference", picture(to_display(images.front()->reference, display)), {}}};
  for (const Comparison* c : images)
    views.push_back({file_name(c->image), picture(to_display(c->picture, display)), {}});
  const std::string flip_scale = scale(flip_color(ramp(0, 1, false)), "0", "1", "FLIP");
  const std::string relative_scale = error_scale(range);
  for (const Comparison* c : images) {
    const std::string name = images.size() > 1 ? " of " + file_name(c->image) : "";
    views.push_back({"FLIP" + name, picture(flip_color(c->flip_map)), flip_scale});
    views.push_back({"error" + name, picture(false_color(c->error, range)), relative_scale});
  }
  return views;
}

/// Radio buttons above the picture of the selected one. The style sheet switches the pictures, without a script.
std::string viewer(const std::vector<View>& views, std::size_t section) {
  std::string buttons, figures, choices;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string id = fmt::format("view{}-{}", section, i);
    buttons += fmt::format("<input type='radio' name='view{0}' id='{1}'{2}><label for='{1}'>{3}</label>\n", section, id,
                           i == 0 ? " checked" : "", escaped(views[i].name));
    figures += fmt::format("<figure><img alt='{}' src='{}'>{}</figure>\n", escaped(views[i].name), views[i].picture,
                           views[i].below);
    choices += fmt::format("#{}:checked~.shown figure:nth-child({}){{visibility:visible}}\n", id, i + 1);
  }
  return fmt::format("<style>{}</style>\n<div class='viewer'>{}<div class='shown'>{}</div></div>\n", choices, buttons,
                     figures);
}

/// A row of figures for each image. Where there are several, the best figure of each column stands out.
std::string table(const std::vector<const Comparison*>& images) {
  struct Column {
    const char* name;
    const char* format;
    double (*value)(const Comparison&);
  };
  static const std::vector<Column> columns{
      {"relMSE", "{:.5f}", [](const Comparison& c) { return c.score.relative_mse; }},
      {"trimmed", "{:.5f}", [](const Comparison& c) { return c.score.trimmed; }},
      {"energy", "{:+.5f}", [](const Comparison& c) { return c.score.energy; }},
      {"FLIP", "{:.4f}", [](const Comparison& c) { return c.flip; }},
      {"bad pixels", "{:.0f}", [](const Comparison& c) { return static_cast<double>(c.score.bad); }}};
  std::string head, rows;
  for (const Column& column : columns) head += fmt::format("<th>{}</th>", column.name);
  for (const Comparison* c : images) {
    rows += fmt::format("<tr><td>{}</td>", escaped(c->image));
    for (const Column& column : columns) {
      const double value = std::abs(column.value(*c));
      const bool best = images.size() > 1 && std::none_of(images.begin(), images.end(), [&](const Comparison* other) {
                          return std::abs(column.value(*other)) < value;
                        });
      rows += fmt::format("<td{}>{}</td>", best ? " class='best'" : "",
                          fmt::format(fmt::runtime(column.format), column.value(*c)));
    }
    rows += "</tr>\n";
  }
  return fmt::format("<div class='table'><table><tr><th>image</th>{}</tr>\n{}</table></div>\n", head, rows);
}

}  // namespace

std::string comparison_page(const std::string& reference, const std::vector<Comparison>& comparisons,
                            const DisplayParams& display) {
  const std::string title = "Against " + reference;
  std::string html =
      page_head(title, page_width, rules) + "<h1>" + escaped(title) +
      fmt::format("</h1>\n<p class='soft'>relMSE: mean of ((x - r)² - Var r) / (r² + {:g}); ", relmse_floor) +
      "trimmed: without the 0.1 % worst pixels; energy: mean(x) / mean(r) - 1; FLIP: the difference that a viewer "
      "notices when the pictures alternate, "
      "0 "
      "to 1. Arrow keys alternate the pictures.</p>\n";
  std::size_t section = 0;
  for (const std::string& layer : layers_of(comparisons)) {
    std::vector<const Comparison*> images;
    for (const Comparison& c : comparisons)
      if (c.layer == layer) images.push_back(&c);
    html += fmt::format("<h2>{}</h2>\n", escaped(shown_layer(*images.front()))) + table(images);
    html += viewer(views_of(images, error_range(comparisons, layer), display), section++);
  }
  return html + page_end();
}

}  // namespace polyrecon
