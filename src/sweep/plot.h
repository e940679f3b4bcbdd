#pragma once

#include <string>
#include <utility>
#include <vector>

namespace polyrecon {

enum class Marker { Disc, Diamond, Square };

struct PlotPoint {
  double x = 0, y = 0;
  std::string name;     ///< Written beside the point.
  std::string details;  ///< Shown where the pointer rests on it.
};

struct PlotSeries {
  std::string name;   ///< In the legend.
  std::string color;  ///< CSS
  Marker marker = Marker::Disc;
  bool joined = false;  ///< By a line through the points, in their order.
  std::vector<PlotPoint> points;
};

/// Both axes are logarithmic; points that are not positive and finite are left out.
struct LogPlot {
  std::string x_label, y_label;
  std::vector<PlotSeries> series;
  std::vector<std::pair<double, double>> front;        ///< Drawn as a line of its own.
  std::vector<std::pair<std::string, double>> levels;  ///< Named horizontal lines.
};

/// One bar a row, made of the parts.
struct StackedBars {
  std::string unit;
  std::vector<std::string> parts;
  struct Row {
    std::string name;
    std::vector<double> values;  ///< As parts.
  };
  std::vector<Row> rows;
};

/// Inline SVG, every text escaped.
std::string svg_of(const LogPlot& plot);
std::string svg_of(const StackedBars& bars);

/// Text as it must stand in HTML and SVG, inside attributes too.
std::string escaped(const std::string& text);

/// One of ten colours that are told apart by colour-blind eyes as well as ten can be.
std::string plot_color(std::size_t index);

}  // namespace polyrecon
