#include "html/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/pi.h"
#include "html/escaped.h"

namespace polyrecon {
namespace {

constexpr double width = 1000, height = 620, left = 74, right = 16, top = 14, bottom = 52;
/// A level that is so many times the highest point would squeeze all points into one end of the axis.
constexpr double far = 3;
constexpr double letter_width = 6.1, letter_height = 11;  // of the labels in pixels, for a sans-serif font of 11 px

/// The next number from a step upwards that is 1, 2 or 5 times a power of ten.
double round_step(double step) {
  const double power = std::pow(10.0, std::floor(std::log10(step)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= step * (1 - 1e-9)) return digit * power;
  return 10 * power;
}

/// A logarithmic axis from the pixel `begin` to the pixel `end`.
class LogAxis {
 public:
  LogAxis(double low, double high, double begin, double end) : begin_(begin), end_(end) {
    const double margin = std::pow(high / low, 0.06) * 1.1;
    low_ = std::log(low / margin);
    high_ = std::log(high * margin);
  }
  double at(double value) const { return begin_ + (end_ - begin_) * (std::log(value) - low_) / (high_ - low_); }
  /// 1, 2 and 5 times the powers of ten; only the powers on a long axis, more values on a short one. Where fewer than
  /// three of these would be left, even steps.
  std::vector<double> ticks() const {
    std::vector<double> out;
    const double decades = (high_ - low_) / std::log(10.0);
    std::vector<double> digits{1, 2, 5};
    if (decades > 4) digits = {1};
    if (decades < 1.2) digits = {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8};
    for (int decade = static_cast<int>(std::floor(low_ / std::log(10.0))); decade * std::log(10.0) < high_; ++decade)
      for (const double digit : digits) {
        const double value = digit * std::pow(10.0, decade);
        if (std::log(value) >= low_ && std::log(value) <= high_) out.push_back(value);
      }
    if (out.size() >= 3) return out;
    out.clear();
    const double low = std::exp(low_), high = std::exp(high_), step = round_step((high - low) / 5);
    for (double k = std::ceil(low / step); k * step <= high; ++k) out.push_back(k * step);
    return out;
  }

 private:
  double begin_, end_, low_ = 0, high_ = 0;
};

struct Box {
  double x0, y0, x1, y1;
};

bool overlap(const Box& a, const Box& b) { return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1; }

bool drawn(const PlotPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0 && p.y > 0; }

/// Finds a free place for each label, as close to its point as possible.
class Labels {
 public:
  void keep_free(const Box& box) { taken_.push_back(box); }

  std::string place(double x, double y, const std::string& text, const std::string& color) {
    const double half = 0.5 * letter_width * static_cast<double>(text.size());
    for (double distance = 10; distance < 170; distance += 9)
      for (int step = 0; step < 16; ++step) {
        const double angle = 2 * pi * step / 16;
        const double cx = x + std::cos(angle) * (distance + half * std::abs(std::cos(angle)));
        const double cy = y - std::sin(angle) * (distance + letter_height / 2 * std::abs(std::sin(angle)));
        const Box box{cx - half, cy - letter_height / 2, cx + half, cy + letter_height / 2};
        if (box.x0 < left || box.x1 > width - right || box.y0 < top || box.y1 > height - bottom || blocked(box))
          continue;
        taken_.push_back(box);
        return (distance > 20 ? leader(x, y, box, color) : std::string()) + text_at(cx, cy, text);
      }
    return text_at(x, y - letter_height, text);  // no free place: it overlaps another label
  }

 private:
  std::vector<Box> taken_;

  bool blocked(const Box& box) const {
    return std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return overlap(box, other); });
  }
  static std::string leader(double x, double y, const Box& box, const std::string& color) {
    return fmt::format("<line class='leader' stroke='{}' x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}'/>", color, x,
                       y, std::clamp(x, box.x0, box.x1), std::clamp(y, box.y0, box.y1));
  }
  static std::string text_at(double x, double y, const std::string& text) {
    return fmt::format("<text class='label' x='{:.1f}' y='{:.1f}'>{}</text>\n", x, y + 0.35 * letter_height,
                       escaped(text));
  }
};

std::string marker_at(double x, double y, const PlotSeries& series, const PlotPoint& point) {
  std::string shape;
  switch (series.marker) {
    case Marker::Disc:
      shape = fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4.5'", x, y);
      break;
    case Marker::Diamond:
      shape = fmt::format("<path d='M{:.1f} {:.1f}l7 7l-7 7l-7 -7z'", x, y - 7);
      break;
    case Marker::Square:
      shape = fmt::format("<rect x='{:.1f}' y='{:.1f}' width='9' height='9'", x - 4.5, y - 4.5);
      break;
  }
  const char* const tag = series.marker == Marker::Disc ? "circle" : series.marker == Marker::Diamond ? "path" : "rect";
  const std::string marker =
      fmt::format("{} fill='{}' class='point'><title>{}</title></{}>", shape, series.color,
                  escaped(point.name + (point.details.empty() ? "" : "\n" + point.details)), tag);
  return point.address.empty() ? marker + "\n" : fmt::format("<a href='{}'>{}</a>\n", point.address, marker);
}

/// Lines for the values of the axis upwards, and its name; low: the lower end of the drawing.
std::string upward_grid(const std::string& label, const LogAxis& y, double low) {
  std::string svg;
  for (const double value : y.ticks())
    svg += fmt::format(
        "<line class='grid' y1='{0:.1f}' y2='{0:.1f}' x1='{1}' x2='{2}'/><text class='tick' x='{3}' y='{4:.1f}' "
        "text-anchor='end'>{5:g}</text>\n",
        y.at(value), left, width - right, left - 7, y.at(value) + 4, value);
  const double middle = (top + low - bottom) / 2;
  return svg + fmt::format(
                   "<text class='axis' transform='rotate(-90 16 {0})' x='16' y='{0}' text-anchor='middle'>{1}</text>\n",
                   middle, escaped(label));
}

std::string axes(const LogPlot& plot, const LogAxis& x, const LogAxis& y) {
  std::string svg;
  for (const double value : x.ticks())
    svg += fmt::format(
        "<line class='grid' x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}'/><text class='tick' x='{0:.1f}' y='{3}' "
        "text-anchor='middle'>{4:g}</text>\n",
        x.at(value), top, height - bottom, height - bottom + 17, value);
  svg += fmt::format("<text class='axis' x='{}' y='{}' text-anchor='middle'>{}</text>\n", (left + width - right) / 2,
                     height - 12, escaped(plot.x_label));
  return svg + upward_grid(plot.y_label, y, height);
}

template <typename Points>
std::string polyline(const Points& points, const LogAxis& x, const LogAxis& y, const std::string& css_class,
                     const std::string& color) {
  std::string path;
  for (const auto& [px, py] : points)
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", x.at(px), y.at(py));
  return path.empty() ? path : fmt::format("<path class='{}' stroke='{}' d='{}'/>\n", css_class, color, path);
}

/// The names of the series with their colours.
std::string legend(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string html = "<p class='legend'>";
  for (const auto& [name, color] : entries)
    html += fmt::format(
        "<span><svg class='swatch' viewBox='0 0 10 10'><rect width='10' height='10' fill='{}'/></svg>{}</span> ", color,
        escaped(name));
  return html + "</p>\n";
}

struct Range {
  double low = 0, high = 0;
  void add(double value) {
    low = high == 0 ? value : std::min(low, value);
    high = std::max(high, value);
  }
};

std::string series_svg(const LogPlot& plot, const LogAxis& x, const LogAxis& y) {
  std::string svg, points;
  Labels labels;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& p : series.points)
      if (drawn(p)) labels.keep_free({x.at(p.x) - 5, y.at(p.y) - 5, x.at(p.x) + 5, y.at(p.y) + 5});
  for (const PlotSeries& series : plot.series) {
    std::vector<std::pair<double, double>> line;
    for (const PlotPoint& p : series.points) {
      if (!drawn(p)) continue;
      line.emplace_back(p.x, p.y);
      points += marker_at(x.at(p.x), y.at(p.y), series, p);
      if (!p.name.empty()) svg += labels.place(x.at(p.x), y.at(p.y), p.name, series.color);
    }
    if (series.joined) svg += polyline(line, x, y, "joined", series.color);
  }
  return svg + points;
}

}  // namespace

std::string plot_color(std::size_t index) {
  constexpr std::array<const char*, 10> colors{"#1f5fa8", "#d1495b", "#2a9d5c", "#b07d00", "#7a4fb5",
                                               "#0f8b8d", "#c2611f", "#8c3b6b", "#4f6d2f", "#5a6472"};
  return colors[index % colors.size()];
}

std::string svg_of(const LogPlot& plot) {
  Range xs, ys;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& p : series.points)
      if (drawn(p)) {
        xs.add(p.x);
        ys.add(p.y);
      }
  for (const auto& [x, y] : plot.front) {
    xs.add(x);
    ys.add(y);
  }
  if (xs.high == 0) return "<p>No point has an error above zero: nothing to draw.</p>\n";
  const auto near = [&](double value) { return value <= far * ys.high; };
  Range all = ys;
  for (const auto& [name, value] : plot.levels)
    if (std::isfinite(value) && value > 0 && near(value)) all.add(value);
  const LogAxis x(xs.low, xs.high, left, width - right), y(all.low, all.high, height - bottom, top);
  std::string svg = fmt::format("<svg viewBox='0 0 {} {}' role='img'>\n", width, height) + axes(plot, x, y);
  for (const auto& [name, value] : plot.levels)
    if (std::isfinite(value) && value > 0)
      svg += fmt::format(
          "<line class='level' x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}'/><text "
          "class='level-name' x='{3}' y='{4:.1f}'>{5}</text>\n",
          left, width - right, near(value) ? y.at(value) : top, width - right - 4,
          near(value) ? y.at(value) - 5 : top + 13,
          near(value) ? escaped(name) : fmt::format("{}: {:.3g}, above the scale", escaped(name), value));
  svg += polyline(plot.front, x, y, "front-line", "currentColor") + series_svg(plot, x, y) + "</svg>\n";
  std::vector<std::pair<std::string, std::string>> names;
  for (const PlotSeries& series : plot.series)
    if (!series.points.empty()) names.emplace_back(series.name, series.color);
  return svg + legend(names);
}

std::string svg_of(const FramePlot& plot) {
  constexpr double lower = 300;
  Range ys;
  int first = 0, last = 0;
  bool some = false;
  for (const FramePlot::Series& series : plot.series)
    for (const FramePlot::Point& p : series.points) {
      first = some ? std::min(first, p.frame) : p.frame;
      last = some ? std::max(last, p.frame) : p.frame;
      some = true;
      if (std::isfinite(p.value) && p.value > 0) ys.add(p.value);
    }
  if (ys.high == 0) return "<p>No value above zero: nothing to draw.</p>\n";
  const LogAxis y(ys.low, ys.high, lower - bottom, top);
  const auto x = [&](int frame) {
    return left + 12 + (width - right - left - 24) * (frame - first) / std::max(last - first, 1);
  };
  std::string svg =
      fmt::format("<svg viewBox='0 0 {} {}' role='img'>\n", width, lower) + upward_grid(plot.y_label, y, lower);
  const int step = std::max(1, static_cast<int>(round_step((last - first) / 12.0)));
  for (int frame = first - (first % step + step) % step; frame <= last; frame += step) {
    if (frame < first) continue;
    svg += fmt::format("<text class='tick' x='{:.1f}' y='{}' text-anchor='middle'>{}</text>\n", x(frame),
                       lower - bottom + 17, frame);
  }
  svg += fmt::format("<text class='axis' x='{}' y='{}' text-anchor='middle'>{}</text>\n", (left + width - right) / 2,
                     lower - 12, escaped(plot.x_label));
  std::vector<std::pair<std::string, std::string>> names;
  for (const FramePlot::Series& series : plot.series) {
    std::string path, points;
    for (const FramePlot::Point& p : series.points) {
      if (!std::isfinite(p.value) || p.value <= 0) continue;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : " L", x(p.frame), y.at(p.value));
      points += fmt::format(
          "<a href='{}' tabindex='-1'><circle cx='{:.1f}' cy='{:.1f}' r='4.5' fill='{}' class='point'><title>{}, frame "
          "{}: {:.4g}"
          "</title></circle></a>\n",
          p.address, x(p.frame), y.at(p.value), series.color, escaped(series.name), p.frame, p.value);
    }
    if (!path.empty()) svg += fmt::format("<path class='joined' stroke='{}' d='{}'/>\n", series.color, path) + points;
    names.emplace_back(series.name, series.color);
  }
  return svg + "</svg>\n" + legend(names);
}

std::string svg_of(const StackedBars& bars) {
  constexpr double bar = 20, gap = 8, names = 170, numbers = 74;
  double longest = 0;
  for (const StackedBars::Row& row : bars.rows) {
    double sum = 0;
    for (const double value : row.values) sum += value;
    longest = std::max(longest, sum);
  }
  if (!(longest > 0)) return "";
  const double scale = (width - names - numbers) / longest;
  std::string svg = fmt::format("<svg viewBox='0 0 {} {}' role='img'>\n", width,
                                static_cast<double>(bars.rows.size()) * (bar + gap) + gap);
  double y = gap;
  for (const StackedBars::Row& row : bars.rows) {
    double sum = 0;
    svg += fmt::format("<text class='axis' x='{}' y='{:.1f}' text-anchor='end'>{}</text>", names - 8, y + 15,
                       escaped(row.name));
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      svg += fmt::format(
          "<rect x='{:.2f}' y='{:.1f}' width='{:.2f}' height='{}' fill='{}' class='part'><title>{}: {:.3g} "
          "{}</title></rect>",
          names + sum * scale, y, row.values[k] * scale, bar, plot_color(k), escaped(bars.parts[k]), row.values[k],
          escaped(bars.unit));
      sum += row.values[k];
    }
    svg += fmt::format("<text class='axis' x='{:.1f}' y='{:.1f}'>{:.3g} {}</text>\n", names + sum * scale + 6, y + 15,
                       sum, escaped(bars.unit));
    y += bar + gap;
  }
  std::vector<std::pair<std::string, std::string>> parts;
  for (std::size_t k = 0; k < bars.parts.size(); ++k) parts.emplace_back(bars.parts[k], plot_color(k));
  return svg + "</svg>\n" + legend(parts);
}

}  // namespace polyrecon
