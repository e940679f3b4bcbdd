#include "html/plot.h"

#include <gtest/gtest.h>

#include <limits>
#include <regex>

namespace polyrecon {
namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

/// cx of every disc, in the order drawn.
std::vector<double> disc_centres(const std::string& svg) {
  std::vector<double> out;
  const std::regex disc("<circle cx='([0-9.]+)'");
  for (std::sregex_iterator at(svg.begin(), svg.end(), disc), end; at != end; ++at) out.push_back(std::stod((*at)[1]));
  return out;
}

TEST(Plot, AxesAreLogarithmic) {
  LogPlot plot{"seconds", "relMSE", {{"ours", "#000", Marker::Disc, false, {}}}, {}, {}};
  for (const double x : {1.0, 10.0, 100.0}) plot.series[0].points.push_back({x, 1 / x, "p", ""});
  const auto x = disc_centres(svg_of(plot));
  ASSERT_EQ(x.size(), 3u);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.2);  // written to a tenth of a pixel
  EXPECT_GT(x[1] - x[0], 200);
}

TEST(Plot, EveryPointThatCanBeDrawnIsDrawnAndNamed) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  LogPlot plot{"x", "y", {{"ours", "#000", Marker::Disc, false, {}}}, {}, {}};
  for (int k = 1; k <= 40; ++k)
    plot.series[0].points.push_back({1.0 + k % 7, 1.0 + k % 5, "point " + std::to_string(k), ""});
  plot.series[0].points.push_back({1, -1, "below", ""});
  plot.series[0].points.push_back({nan, 1, "nowhere", ""});
  const std::string svg = svg_of(plot);
  EXPECT_EQ(count(svg, "<circle"), 40u);
  for (int k = 1; k <= 40; ++k) EXPECT_NE(svg.find(">point " + std::to_string(k) + "</text>"), std::string::npos) << k;
  EXPECT_EQ(svg.find("below"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Plot, AxesHoldTheSeparateLine) {
  LogPlot plot{"x", "y", {{"ours", "#000", Marker::Disc, false, {{1, 1, "", ""}, {2, 1.5, "", ""}}}}, {}, {}};
  const auto before = disc_centres(svg_of(plot));
  plot.front = {{0.01, 0.01}, {100, 100}};
  const auto after = disc_centres(svg_of(plot));
  EXPECT_LT(after[1] - after[0], 0.2 * (before[1] - before[0]));
}

TEST(Plot, ALevelFarAboveThePointsDoesNotSqueezeThem) {
  LogPlot plot{"x", "y", {{"ours", "#000", Marker::Disc, false, {{1, 1, "", ""}, {2, 1.5, "", ""}}}}, {}, {}};
  const std::regex disc("cy='([0-9.]+)'");
  const auto heights = [&](const std::string& svg) {
    std::vector<double> out;
    for (std::sregex_iterator at(svg.begin(), svg.end(), disc), end; at != end; ++at)
      out.push_back(std::stod((*at)[1]));
    return out;
  };
  const auto before = heights(svg_of(plot));
  plot.levels = {{"noisy", 100}};
  const std::string svg = svg_of(plot);
  EXPECT_EQ(heights(svg), before);
  EXPECT_NE(svg.find("noisy: 100, above the scale"), std::string::npos);
  plot.levels = {{"noisy", 2}};
  EXPECT_NE(heights(svg_of(plot)), before);
}

TEST(Plot, FramesHaveRoundTicksAndAShortAxisHasThree) {
  FramePlot plot{"frame", "error", {{"ours", "#000", {}}}};
  for (int frame = -3; frame <= 96; ++frame) plot.series[0].points.push_back({frame, 15.0 + 0.01 * frame, "#"});
  const std::string svg = svg_of(plot);
  const std::regex tick("class='tick' x='[-0-9.]+' y='[-0-9.]+' text-anchor='(middle|end)'>([-0-9.e]+)<");
  std::vector<std::string> frames, values;
  for (std::sregex_iterator at(svg.begin(), svg.end(), tick), end; at != end; ++at)
    ((*at)[1] == "middle" ? frames : values).push_back((*at)[2]);
  EXPECT_EQ(frames, (std::vector<std::string>{"0", "10", "20", "30", "40", "50", "60", "70", "80", "90"}));
  EXPECT_GE(values.size(), 3u);
  EXPECT_EQ(count(svg, "tabindex='-1'"), 100u);  // Tab skips the points
}

TEST(Plot, NamesCannotBreakOut) {
  const std::string evil = "<script>'\"&";
  const LogPlot plot{evil, evil, {{evil, "#000", Marker::Diamond, false, {{1, 1, evil, evil}}}}, {}, {{evil, 1}}};
  const StackedBars bars{evil, {evil}, {{evil, {1}}}};
  for (const std::string& svg : {svg_of(plot), svg_of(bars)}) {
    EXPECT_EQ(svg.find("<script"), std::string::npos);
    EXPECT_NE(svg.find("&lt;script&gt;&#39;&quot;&amp;"), std::string::npos);
  }
}

TEST(Plot, NothingToDrawIsSaid) {
  EXPECT_NE(svg_of(LogPlot{"x", "y", {{"a", "#000", Marker::Disc, false, {{0, 0, "p", ""}}}}, {}, {}})
                .find("nothing to draw"),
            std::string::npos);
}

TEST(Plot, BarsAreStackedToTheirSum) {
  const std::string svg = svg_of(StackedBars{"s", {"a", "b"}, {{"one", {1, 3}}, {"two", {1, 1}}}});
  const std::regex bar("<rect x='([0-9.]+)' y='[0-9.]+' width='([0-9.]+)'");
  std::vector<double> x, w;
  for (std::sregex_iterator at(svg.begin(), svg.end(), bar), end; at != end; ++at) {
    x.push_back(std::stod((*at)[1]));
    w.push_back(std::stod((*at)[2]));
  }
  ASSERT_EQ(x.size(), 4u);
  EXPECT_NEAR(x[1], x[0] + w[0], 0.02);
  EXPECT_NEAR(w[1], 3 * w[0], 0.05);
  EXPECT_NEAR(w[2] + w[3], (w[0] + w[1]) / 2, 0.05);
}

}  // namespace
}  // namespace polyrecon
