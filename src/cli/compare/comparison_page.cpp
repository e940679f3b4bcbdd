#include "cli/compare/comparison_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cli/common/sequence_arguments.h"
#include "cli/compare/comparison_output.h"
#include "core/relmse.h"
#include "html/escaped.h"
#include "html/plot.h"

namespace polyrecon {
namespace {

constexpr std::size_t worst_count = 8;  // of each image and frame
constexpr std::size_t bad_count = 4;    // of them that are not finite
constexpr int worst_distance = 6;       // pixels

std::vector<std::string> texts(const std::vector<int>& frames) {
  std::vector<std::string> out;
  for (const int frame : frames) out.push_back(std::to_string(frame));
  return out;
}

/// The slot of a map of a layer.
std::string map_slot(const char* map, const std::string& layer, bool main) {
  return main ? std::string(map) : fmt::format("{} of {}", map, layer);
}

std::string title(const std::vector<std::string>& names) {
  return names.size() == 2 ? fmt::format("{} against {}", names[0], names[1])
                           : fmt::format("{} images against {}", names.size() - 1, names.back());
}

struct Column {
  const char* name;
  const char* format;
  double (*value)(const SequenceFigures&);
};

const std::vector<Column>& columns() {
  static const std::vector<Column> all{
      {"relMSE", "{:.5f}", [](const SequenceFigures& f) { return f.relative_mse; }},
      {"trimmed", "{:.5f}", [](const SequenceFigures& f) { return f.trimmed; }},
      {"energy", "{:+.5f}", [](const SequenceFigures& f) { return f.energy; }},
      {"FLIP", "{:.4f}", [](const SequenceFigures& f) { return f.flip; }},
      {"bad pixels", "{:.0f}", [](const SequenceFigures& f) { return static_cast<double>(f.bad); }},
      {"flicker", "{:.6f}", [](const SequenceFigures& f) { return f.flicker.value_or(std::nan("")); }}};
  return all;
}

/// A figure that does not exist, such as the trimmed error of a few pixels, is a dash.
std::string cell_text(const Column& column, const SequenceFigures& figures) {
  const double value = column.value(figures);
  return std::isfinite(value) ? figure_text(column.format, value) : "\u2013";
}

/// Text as a value of an address's fragment.
std::string in_address(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    plain ? out.append(1, c) : out.append(fmt::format("%{:02X}", byte));
  }
  return out;
}

/// Whether a pixel has a channel that is not finite.
Image bad_pixels(const Image& image) {
  Image out(image.width(), image.height(), 1);
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      if (!std::isfinite(image.plane(c)[i])) out.plane(0)[i] = 1;
  return out;
}

}  // namespace

ComparisonPage::ComparisonPage(const std::vector<std::string>& images, const std::vector<int>& frames,
                               bool one_reference, const DisplayParams& display, std::size_t max_bytes)
    : names_(short_names(images)),
      frames_(frames),
      page_(title(names_), display, max_bytes),
      one_reference_(one_reference),
      reference_layers_(one_reference ? 1 : frames.size()) {
  if (!frames.empty()) page_.set_frames("frame", texts(frames));
  for (std::size_t i = 0; i < images.size(); ++i) page_.add_image({names_[i], images[i], i + 1 == images.size()});
}

void ComparisonPage::put(std::size_t image, const std::vector<std::size_t>& frames, const ViewedLayer& layer,
                         const Image& values) {
  if (!page_.add_layer(image, frames, layer, values, false)) ++left_out_;
}

void ComparisonPage::add_reference(std::size_t frame, const ViewedLayer& layer, const Image& values) {
  std::vector<std::string>& known = reference_layers_[one_reference_ ? 0 : frame];
  if (std::find(known.begin(), known.end(), layer.slot) != known.end()) return;
  known.push_back(layer.slot);
  std::vector<std::size_t> frames{frame};
  if (one_reference_) {
    frames.resize(std::max<std::size_t>(frames_.size(), 1));
    std::iota(frames.begin(), frames.end(), std::size_t{0});
  }
  put(reference(), frames, layer, values);
}

void ComparisonPage::add(std::size_t image, std::size_t frame, const std::vector<Comparison>& comparisons,
                         const Image& estimated) {
  static const std::vector<std::string> rgb{"R", "G", "B"};
  for (const Comparison& c : comparisons) {
    const bool main = &c == &comparisons.front();
    ViewedLayer picture{main ? "" : c.layer, shown_layer(c), rgb, c.x, c.y};
    put(image, {frame}, picture, c.picture);
    add_reference(frame, picture, c.reference);
    ViewedLayer error{
        map_slot("relMSE", c.layer, main), map_slot("relative error", c.layer, main), {"Y"}, c.x, c.y, true};
    if (const LogRange range = log_range(c.error); range.high > range.low)
      error.scale = MapScale{range.low, range.high, true};
    error.listed = main;
    put(image, {frame}, error, c.error);
    ViewedLayer flip{map_slot("FLIP", c.layer, main),
                     map_slot("FLIP", c.layer, main),
                     {"Y"},
                     c.x,
                     c.y,
                     true,
                     MapScale{0, 1, false},
                     MapColors::Magma};
    flip.listed = main;
    put(image, {frame}, flip, c.flip_map);
  }
  const Comparison& main = comparisons.front();
  for (const WorstPixel& pixel : worst_pixels(bad_pixels(main.picture), bad_count, worst_distance))
    worst_.push_back({image, frame, main.x + pixel.x, main.y + pixel.y, INFINITY});
  for (const WorstPixel& pixel : worst_pixels(main.error, worst_count, worst_distance))
    worst_.push_back({image, frame, main.x + pixel.x, main.y + pixel.y, pixel.value});
  if (estimated.empty()) return;
  ViewedLayer map{"estimated", "estimated relative error", {"Y"}, main.x, main.y, true};
  if (const LogRange range = log_range(estimated); range.high > range.low)
    map.scale = MapScale{range.low, range.high, true};
  map.listed = true;
  put(image, {frame}, map, estimated);
  reliability_.push_back({image, frame, reliability(estimated, main.picture, main.reference, main.reference_variance)});
}

std::string ComparisonPage::link(std::size_t image, std::size_t frame, const std::string& more) const {
  return fmt::format("#a={}&amp;b={}{}{}", image, reference(), frame > 0 ? fmt::format("&amp;frame={}", frame) : "",
                     more);
}

/// A row of figures for each image. The best ones of each column stand out, unless all look alike.
std::string ComparisonPage::figures(const std::vector<std::vector<Comparison>>& comparisons,
                                    const std::string& layer) const {
  std::vector<std::pair<std::size_t, SequenceFigures>> rows;
  bool flickers = false, main = true;
  std::string shown;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    std::vector<const Comparison*> frames;
    for (const Comparison& c : comparisons[i])
      if (c.layer == layer) frames.push_back(&c);
    if (frames.empty()) continue;
    shown = shown_layer(*frames.front());
    main = main && &comparisons[i].front() == frames.front();
    rows.emplace_back(i, sequence_figures(frames));
    flickers = flickers || rows.back().second.flicker;
  }
  std::string html = fmt::format("<h2>{}</h2>\n<div class=\"table\"><table><tr><th>image</th>", escaped(shown));
  for (const Column& column : columns())
    if (flickers || column.name != std::string("flicker")) html += fmt::format("<th>{}</th>", column.name);
  html += "</tr>\n";
  for (const auto& row : rows) {
    const std::size_t image = row.first;
    const SequenceFigures& figures = row.second;
    const std::string picture = main ? "" : "&amp;layer=" + in_address(layer);
    const auto to = [&](const char* what) -> std::string {
      if (what == std::string("relMSE") || what == std::string("FLIP"))
        return link(image, 0, "&amp;layer=" + in_address(map_slot(what, layer, main)));
      if (what == std::string("energy")) return link(image, 0, picture + "&amp;mode=difference&amp;kind=relative");
      return "";
    };
    html += fmt::format("<tr><td><a href=\"{}\">{}</a></td>", link(image, 0, picture), escaped(names_[image]));
    for (const Column& column : columns()) {
      if (!flickers && column.name == std::string("flicker")) continue;
      const double value = column.value(figures);
      const std::string text = cell_text(column, figures), address = to(column.name);
      const auto looks_alike = [&](const auto& other) { return cell_text(column, other.second) == text; };
      const auto is_better = [&](const auto& other) {
        return !looks_alike(other) && std::abs(column.value(other.second)) < std::abs(value);
      };
      const bool best = std::isfinite(value) && !std::all_of(rows.begin(), rows.end(), looks_alike) &&
                        std::none_of(rows.begin(), rows.end(), is_better);
      html += fmt::format("<td{}>{}</td>", best ? " class=\"best\"" : "",
                          address.empty() ? text : fmt::format("<a href=\"{}\">{}</a>", address, text));
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string ComparisonPage::over_time(const std::vector<std::vector<Comparison>>& comparisons) const {
  if (frames_.size() < 2) return {};
  FramePlot error{"frame", "relMSE", {}}, flicker_plot{"frame", "flicker", {}};
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    if (comparisons[i].empty()) continue;
    FramePlot::Series errors{names_[i], plot_color(i), {}}, flickers{names_[i], plot_color(i), {}};
    for (const Comparison& c : comparisons[i]) {
      if (c.layer != comparisons[i].front().layer) continue;
      const auto at = std::find(frames_.begin(), frames_.end(), *c.frame) - frames_.begin();
      const std::string address = link(i, static_cast<std::size_t>(at), "");
      errors.points.push_back({*c.frame, c.score.relative_mse, address});
      if (c.flicker) flickers.points.push_back({*c.frame, *c.flicker, address});
    }
    error.series.push_back(std::move(errors));
    if (!flickers.points.empty()) flicker_plot.series.push_back(std::move(flickers));
  }
  return "<h2>Error over time</h2>\n" + svg_of(error) +
         (flicker_plot.series.empty() ? std::string()
                                      : "<h2>Flicker</h2>\n<p class=\"soft\">Half the mean squared change of the "
                                        "relative error since the frame "
                                        "before, without what the reference's noise adds.</p>\n" +
                                            svg_of(flicker_plot));
}

std::string ComparisonPage::worst_section() const {
  std::vector<Worst> worst = worst_;
  std::stable_sort(worst.begin(), worst.end(), [](const Worst& a, const Worst& b) { return a.value > b.value; });
  std::string html =
      "<h2>Worst pixels</h2>\n<p class=\"soft\">The largest relative errors of each image, at most one within 6 "
      "pixels. A "
      "link goes there.</p>\n<div class=\"lists\">\n";
  for (std::size_t image = 0; image < reference(); ++image) {
    html += fmt::format("<div><h3>{}</h3><ol>", escaped(names_[image]));
    std::size_t count = 0;
    for (const Worst& pixel : worst) {
      if (pixel.image != image || count == worst_count) continue;
      ++count;
      html +=
          fmt::format("<li><a href=\"{}\">{}{}, {}</a>: {}</li>",
                      link(image, pixel.frame,
                           fmt::format("&amp;pixel=[{0},{1}]&amp;x={0}.5&amp;y={1}.5&amp;zoom=24", pixel.x, pixel.y)),
                      frames_.empty() ? "" : fmt::format("frame {}: ", frames_[pixel.frame]), pixel.x, pixel.y,
                      std::isfinite(pixel.value) ? fmt::format("{:.4g}", pixel.value) : "not finite");
    }
    html += count == 0 ? "<li>no difference</li></ol></div>\n" : "</ol></div>\n";
  }
  return html + "</div>\n";
}

std::string ComparisonPage::reliability_section() const {
  if (reliability_.empty()) return {};
  LogPlot plot{"estimated relative error", "true relative error", {}, {}, {}};
  double low = INFINITY, high = 0;
  for (const Reliability& one : reliability_) {
    const std::string name =
        frames_.empty() ? names_[one.image] : fmt::format("{}, frame {}", names_[one.image], frames_[one.frame]);
    PlotSeries series{name, plot_color(plot.series.size()), Marker::Disc, true, {}};
    for (std::size_t k = 0; k < one.deciles.size(); ++k) {
      const ReliabilityDecile& decile = one.deciles[k];
      series.points.push_back(
          {decile.estimated, decile.measured, "",
           fmt::format("tenth {}: estimated {:.3g}, true {:.3g}", k + 1, decile.estimated, decile.measured)});
      if (!(decile.estimated > 0) || !(decile.measured > 0)) continue;
      low = std::min({low, decile.estimated, decile.measured});
      high = std::max({high, decile.estimated, decile.measured});
    }
    plot.series.push_back(std::move(series));
  }
  if (high > low) plot.front = {{low, low}, {high, high}};
  return "<h2>Reliability of the error map</h2>\n<p class=\"soft\">A point for each tenth of the pixels, from the "
         "lowest "
         "estimates to the highest. On the grey line the estimate is right; above it, the error is larger than "
         "estimated.</p>\n" +
         svg_of(plot);
}

std::string ComparisonPage::html(const std::vector<std::vector<Comparison>>& comparisons) {
  if (left_out_ > 0)
    page_.add_note(
        fmt::format("{} pictures and maps were left out, as the page would be larger than --max-size.", left_out_));
  std::vector<std::string> layers;
  for (const std::vector<Comparison>& of_image : comparisons)
    for (const Comparison& c : of_image)
      if (std::find(layers.begin(), layers.end(), c.layer) == layers.end()) layers.push_back(c.layer);
  std::string report =
      fmt::format("<p class=\"soft\">relMSE: mean of ((x - r)² - Var r) / (r² + {:g}); ", relmse_floor) +
      "trimmed: without the 0.1 % worst pixels; energy: mean(x) / mean(r) - 1; FLIP: the difference that a viewer "
      "notices when the pictures alternate, 0 to 1. The links show the figures of each pixel.</p>\n";
  std::vector<Comparison> all;
  for (const std::vector<Comparison>& of_image : comparisons)
    for (const Comparison& c : of_image) all.push_back(without_images(c));
  for (const std::string& note : notes_of(all)) report += fmt::format("<p>{}</p>\n", escaped(note));
  for (const std::string& layer : layers) report += figures(comparisons, layer);
  report += worst_section() + over_time(comparisons) + reliability_section();
  return page_.html("polyrecon compare", report);
}

}  // namespace polyrecon
