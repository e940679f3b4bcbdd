#include "io/pictures/color.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "io/pictures/false_color.h"
#include "io/pictures/preview.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
constexpr Real inf = std::numeric_limits<Real>::infinity();

Image grey(double value) { return {1, 1, 3, static_cast<Real>(value)}; }

double shown(double value, const DisplayParams& params = {}) { return to_display(grey(value), params).at(0, 0, 0); }

/// Sets OCIO for one test, and restores what was there.
class Environment {
 public:
  explicit Environment(const std::string& value) {
    if (const char* old = std::getenv("OCIO")) old_ = old;
    ::setenv("OCIO", value.c_str(), 1);
  }
  ~Environment() { old_.empty() ? ::unsetenv("OCIO") : ::setenv("OCIO", old_.c_str(), 1); }

 private:
  std::string old_;
};

class Display : public ::testing::Test {
 protected:
  Environment built_in_{""};  // the tests below must not depend on who runs them
};

TEST_F(Display, StandardIsTheSrgbCurve) {
  // IEC 61966-2-1: 12.92 v up to 0.0031308, then 1.055 v^(1/2.4) - 0.055.
  EXPECT_NEAR(shown(0.002), 0.02584, 1e-4);
  EXPECT_NEAR(shown(0.18), 0.461356, 1e-4);
  EXPECT_NEAR(shown(1.0), 1.0, 1e-4);
  EXPECT_EQ(shown(0.0), 0);
}

TEST_F(Display, ExposureIsStops) {
  DisplayParams params;
  params.exposure = 2;
  EXPECT_NEAR(shown(0.045, params), shown(0.18), 1e-5);
}

TEST_F(Display, StaysWithinTheDisplaysRange) {
  EXPECT_EQ(shown(1e6), 1);
  EXPECT_EQ(shown(-1), 0);
}

TEST_F(Display, FilmicRisesFromBlackToWhiteThroughMiddleGrey) {
  DisplayParams params;
  params.view = "Filmic";
  EXPECT_NEAR(shown(0.18, params), 0.46, 0.02);
  double before = -1;
  for (double stop = -9; stop <= 6; stop += 0.25) {
    const double now = shown(0.18 * std::exp2(stop), params);
    EXPECT_GE(now, before) << stop;
    before = now;
  }
  EXPECT_GT(before, 0.97);
  EXPECT_LT(shown(0.18 * std::exp2(-9), params), 0.05);
  EXPECT_LT(shown(1.0, params), 0.95);  // the shoulder leaves room above 1
}

TEST_F(Display, WhatIsNotFiniteIsMagenta) {
  Image image(2, 1, 3, Real{0.18f});
  image.at(1, 0, 1) = nan;
  const Image out = to_display(image, {});
  EXPECT_NEAR(out.at(0, 0, 1), 0.461356, 1e-4);
  EXPECT_EQ(out.at(1, 0, 0), 1);
  EXPECT_EQ(out.at(1, 0, 1), 0);
  EXPECT_EQ(out.at(1, 0, 2), 1);
}

TEST_F(Display, AnUnknownViewNamesTheKnownOnes) {
  DisplayParams params;
  params.view = "Log";
  try {
    to_display(grey(1), params);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::Usage);
    EXPECT_NE(std::string(e.what()).find("Standard, Filmic"), std::string::npos) << e.what();
  }
}

TEST(DisplayConfig, TheEnvironmentsConfigurationIsUsed) {
  const auto file =
      std::filesystem::temp_directory_path() / ("polyrecon-color-" + std::to_string(::getpid()) + ".ocio");
  std::ofstream(file) << R"(ocio_profile_version: 2
roles: {default: lin, scene_linear: lin}
file_rules: [!<Rule> {name: Default, colorspace: default}]
displays: {Test: [!<View> {name: Halved, colorspace: half}]}
colorspaces:
  - !<ColorSpace> {name: lin}
  - !<ColorSpace> {name: half, from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}}
)";
  const Environment environment(file.string());
  EXPECT_NEAR(shown(0.8), 0.4, 1e-6);
  std::filesystem::remove(file);
}

TEST(DisplayConfig, AConfigurationThatIsNotThereIsAnError) {
  const Environment environment("/no/such/config.ocio");
  EXPECT_THROW(shown(1), Error);
}

TEST(FalseColor, IsBlackAtTheLowAndYellowAtTheHighEnd) {
  Image values(4, 1, 1);
  values.at(0, 0, 0) = 1;
  values.at(1, 0, 0) = 1000;
  values.at(2, 0, 0) = nan;
  values.at(3, 0, 0) = -5;
  const Image out = false_color(values, {1, 1000});
  // inferno: (0.0015, 0.0005, 0.0139) to (0.9884, 0.9984, 0.6449)
  EXPECT_NEAR(out.at(0, 0, 2), 0.0139, 2e-3);
  EXPECT_NEAR(out.at(1, 0, 0), 0.9884, 2e-3);
  EXPECT_NEAR(out.at(1, 0, 2), 0.6449, 2e-3);
  EXPECT_EQ(out.at(2, 0, 0), 0);
  EXPECT_EQ(out.at(2, 0, 1), 1);
  EXPECT_EQ(out.at(3, 0, 2), out.at(0, 0, 2));
}

TEST(FalseColor, TheScaleIsLogarithmic) {
  // 10 is the middle of 1 .. 100: inferno(0.5) = (0.7357, 0.2158, 0.3302).
  const Image out = false_color(Image(1, 1, 1, 10), {1, 100});
  EXPECT_NEAR(out.at(0, 0, 0), 0.7357, 5e-3);
  EXPECT_NEAR(out.at(0, 0, 1), 0.2158, 5e-3);
  EXPECT_NEAR(out.at(0, 0, 2), 0.3302, 5e-3);
}

TEST(LogRange, SpansAtMostFourPowersOfTen) {
  Image values(1001, 1, 1);
  for (int x = 0; x < 1001; ++x) values.at(x, 0, 0) = static_cast<Real>(x == 0 ? 1e-12 : 1.0 + x);
  const LogRange narrow = log_range(values);
  EXPECT_NEAR(narrow.low, 11, 1);
  EXPECT_NEAR(narrow.high, 1000, 2);
  Image wide(2, 1, 1, Real{1e-9f});
  wide.at(1, 0, 0) = 1;
  EXPECT_EQ(log_range(wide).high, static_cast<double>(Real{1e-9f}));  // two values: the 99.9th percentile is the lower
  Image odd(3, 1, 1, nan);
  odd.at(1, 0, 0) = inf;
  odd.at(2, 0, 0) = 0;
  EXPECT_EQ(log_range(odd).high, 0);
}

TEST(Compose, ABarePictureKeepsItsSize) {
  const Image out = compose({{Image(5, 3, 3, Real{0.5}), "", {}}});
  EXPECT_EQ(out.width(), 5);
  EXPECT_EQ(out.height(), 3);
  EXPECT_EQ(out.at(4, 2, 1), Real{0.5});
}

TEST(Compose, PanelsStandApartAndKeepTheirPixels) {
  const Image red = [] {
    Image image(10, 6, 3);
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 10; ++x) image.at(x, y, 0) = 1;
    return image;
  }();
  const Image out = compose({{red, "a", {}}, {Image(4, 4, 3, 1), "b", {0.1, 10}}});
  EXPECT_EQ(out.width(), 10 + 4 + 3 * 8);
  EXPECT_EQ(out.at(8, 8, 0), 1);
  EXPECT_EQ(out.at(17, 13, 0), 1);
  EXPECT_EQ(out.at(17, 13, 1), 0);
  EXPECT_LT(out.at(18, 8, 0), Real{0.2f});  // ground between the panels
  EXPECT_EQ(out.at(26, 8, 2), 1);
}

TEST(Compose, TheLegendMarksThePowersOfTen) {
  // A panel 320 wide from 0.01 to 10: 0.1 and 1 lie at one and two thirds. Their ticks cut the lower half of the bar.
  const Image out = compose({{Image(320, 4, 3, 1), "", {0.01, 10}}});
  const int bar = 8 + 4 + 8;  // below the margin, the picture and a gap
  const auto is_tick = [&](int x) {
    return out.at(x, bar + 11, 0) < Real{0.1f} && out.at(x, bar + 11, 0) == out.at(x, bar + 11, 2);
  };
  std::vector<int> ticks;
  for (int x = 8 + 1; x < 8 + 319; ++x)
    if (is_tick(x)) ticks.push_back(x - 8);
  EXPECT_EQ(ticks, (std::vector<int>{106, 212}));
}

/// Pixels of the strip of numbers below the legend of a panel `width` wide that are not ground.
int pixels_of_numbers(int width, const LogRange& range) {
  const Image out = compose({{Image(width, 4, 3, 1), "", range}});
  const int below = 8 + 4 + 8 + 12;  // margin, picture, gap, bar
  int pixels = 0;
  for (int y = below; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) pixels += out.at(x, y, 0) > Real{0.2f};
  return pixels;
}

TEST(Compose, NumbersThatDoNotFitAreLeftOutAndNotCut) {
  if (!has_font()) GTEST_SKIP() << "no font";
  EXPECT_GT(pixels_of_numbers(200, {3.44e-6, 0.0344}), 0);
  EXPECT_EQ(pixels_of_numbers(80, {3.44e-6, 0.0344}), 0);  // "3.44e-06" and "0.0344" need some 110 pixels
}

TEST(Stack, RowsStandBelowEachOtherFromTheLeft) {
  const Image out = stack({Image(3, 2, 3, 1), Image(5, 1, 3, Real{0.5})});
  EXPECT_EQ(out.width(), 5);
  EXPECT_EQ(out.height(), 3);
  EXPECT_EQ(out.at(2, 1, 0), 1);
  EXPECT_LT(out.at(3, 1, 0), Real{0.2f});  // ground next to the narrower row
  EXPECT_EQ(out.at(4, 2, 2), Real{0.5});
}

TEST(FlipColor, IsMagmaOnALinearScale) {
  Image values(2, 1, 1);
  values.at(1, 0, 0) = 1;
  const Image out = flip_color(values);
  // magma: (0.0015, 0.0005, 0.0139) to (0.9871, 0.9914, 0.7495)
  EXPECT_NEAR(out.at(0, 0, 2), 0.0139, 2e-3);
  EXPECT_NEAR(out.at(1, 0, 0), 0.9871, 2e-3);
  EXPECT_NEAR(out.at(1, 0, 2), 0.7495, 2e-3);
}

TEST(Compose, RefusesAPictureBeyondReason) {
  std::vector<Panel> panels(2, Panel{Image(20000, 1, 3), "", {}});
  panels[1].rgb = Image(1, 20000, 3);
  EXPECT_THROW(compose(panels), Error);
}

}  // namespace
}  // namespace polyrecon
