#pragma once

#include <string>
#include <utility>
#include <vector>

namespace polyrecon {

enum class Marker { Disc, Diamond, Square };

struct PlotPoint {
  double x = 0, y = 0;
  std::string name;          ///< Written next to the point.
  std::string details;       ///< Shown while the pointer is on it.
  std::string address = {};  ///< A link's, escaped; empty: none.
};

struct PlotSeries {
  std::string name;   ///< In the legend.
  std::string color;  ///< CSS
  Marker marker = Marker::Disc;
  bool joined = false;  ///< Whether a line connects the points in their order.
  std::vector<PlotPoint> points;
};

/// A plot with two logarithmic axes. Points that are not positive and finite are not drawn.
struct LogPlot {
  std::string x_label, y_label;
  std::vector<PlotSeries> series;
  std::vector<std::pair<double, double>> front;  ///< Drawn as a separate line, all of it.
  std::vector<std::pair<std::string, double>>
      levels;  ///< Named horizontal lines; those far above all points are drawn at the upper end, with their values.
};

/// A bar for each row, made of parts.
struct StackedBars {
  std::string unit;
  std::vector<std::string> parts;
  struct Row {
    std::string name;
    std::vector<double> values;  ///< One for each of the parts.
  };
  std::vector<Row> rows;
};

/// A line for each image over the numbers of frames, with a logarithmic axis upwards. Tab skips its points: there can
/// be hundreds, and the viewer has a slider over the frames.
struct FramePlot {
  std::string x_label, y_label;
  struct Point {
    int frame = 0;
    double value = 0;     ///< Not drawn where it is not positive and finite.
    std::string address;  ///< A link's, escaped.
  };
  struct Series {
    std::string name, color;
    std::vector<Point> points;
  };
  std::vector<Series> series;
};

/// Inline SVG, every text escaped.
std::string svg_of(const LogPlot& plot);
std::string svg_of(const FramePlot& plot);
std::string svg_of(const StackedBars& bars);

/// One of ten colours that colour-blind readers can distinguish as well as is possible with ten.
std::string plot_color(std::size_t index);

}  // namespace polyrecon
