// Grey renders: one channel is fine for every role, and an alpha channel is never the beauty.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/reconstruct.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::TestChannel;
using testing::TestPart;
using testing::write_exr;

constexpr int side = 48;

double grey_albedo(int x, int) { return x / 8 % 2 == 0 ? 0.8 : 0.1; }
double grey_truth(int x, int y) { return 0.5 * grey_albedo(x, y); }

/// Noise of mean 0 from the place of a pixel, uniform within one half of the truth.
double grey_noisy(int x, int y) {
  std::uint64_t h =
      static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15U + static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FU;
  h = (h ^ h >> 29) * 0xBF58476D1CE4E5B9U;
  h = (h ^ h >> 32) * 0x94D049BB133111EBU;
  const double unit = static_cast<double>((h ^ h >> 29) >> 11) / 9007199254740992.0;
  return grey_truth(x, y) * (0.5 + unit);
}

std::string write_grey(const std::string& path, const std::vector<std::string>& beauty,
                       const std::vector<std::string>& albedo) {
  TestPart part;
  part.window = part.display = {0, 0, side, side};
  for (const std::string& name : beauty) part.channels.push_back({name, Imf::FLOAT, grey_noisy});
  for (const std::string& name : albedo) part.channels.push_back({name, Imf::FLOAT, grey_albedo});
  part.channels.push_back({"A", Imf::FLOAT, testing::constant(1)});
  return write_exr(path, {part});
}

double mean_squared_error(const Image& image) {
  double sum = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double error = static_cast<double>(image.at(x, y, 0)) - grey_truth(x, y);
      sum += error * error;
    }
  return sum / (side * side);
}

Image denoised(const std::string& path) {
  Frame frame = read_frame(path).frame;
  return reconstruct(frame, params_for(Quality::Draft), silent_progress()).beauty;
}

TEST(InputGrey, TheResultIsThatOfTheSameRenderInThreeChannels) {
  const TemporaryFolder folder;
  const Image grey = denoised(write_grey(folder / "grey.exr", {"Y"}, {"albedo.Y"}));
  const Image rgb = denoised(write_grey(folder / "rgb.exr", {"R", "G", "B"}, {"albedo.R", "albedo.G", "albedo.B"}));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) ASSERT_EQ(grey.at(x, y, 0), rgb.at(x, y, 0)) << x << ' ' << y;
  const Image without = denoised(write_grey(folder / "without.exr", {"Y"}, {}));
  EXPECT_LT(mean_squared_error(grey), 0.5 * mean_squared_error(without));
}

TEST(InputGrey, ALuminanceIsTheBeautyAndItsChannelTakesTheResult) {
  const TemporaryFolder folder;
  for (const auto& name : {"Y", "beauty.Y", "R"}) {
    const ReadResult read = read_frame(write_grey(folder / "in.exr", {name}, {"albedo"}));
    EXPECT_EQ(read.frame.features.size(), 1U) << name;
    EXPECT_FALSE(std::string(name) != "beauty.Y" && read.frame.alpha.empty()) << name;
    const Image result(side, side, 3, Real(7));
    write_result(read.source, {{read.frame.beauty.name, result, false, {0, 0, side, side}}}, folder / "out.exr");
    EXPECT_THAT(testing::stored_floats(folder / "out.exr", 0, name), ::testing::Each(7.0F));
    EXPECT_THAT(testing::stored_floats(folder / "out.exr", 0, "A"), ::testing::Each(1.0F));
  }
}

TEST(InputGrey, AnAlphaAloneIsNoBeauty) {
  const TemporaryFolder folder;
  const std::string path = write_grey(folder / "a.exr", {}, {"albedo.R", "albedo.G", "albedo.B"});
  EXPECT_EQ(error_of([&] { read_frame(path); }).code(), ExitCode::Missing);
  const ReadResult read = read_frame(write_grey(folder / "b.exr", {"Ci.r", "Ci.g", "Ci.b"}, {}));
  EXPECT_EQ(read.frame.beauty.name, "Ci");
  ASSERT_FALSE(read.frame.alpha.empty());
  EXPECT_EQ(read.frame.alpha.at(0, 0, 0), 1);
}

TEST(InputGrey, ALuminanceNextToAColorIsNotTheBeauty) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_frame(write_grey(folder / "a.exr", {"R", "G", "B", "Y"}, {})).frame.beauty.name, "RGBA");
  EXPECT_EQ(
      read_frame(write_grey(folder / "b.exr", {"beauty.R", "beauty.G", "beauty.B", "img.Y"}, {})).frame.beauty.name,
      "beauty");
}

TEST(InputGrey, TwoChannelsAreNoBeauty) {
  const TemporaryFolder folder;
  const Error error = error_of([&] { read_frame(write_grey(folder / "a.exr", {"R", "G"}, {})); });
  EXPECT_EQ(error.code(), ExitCode::Missing);
  EXPECT_THAT(error.what(), HasSubstr("layer RGBA is no beauty: it has the"));
}

}  // namespace
}  // namespace polyrecon
