#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

/// Works on the error map that `denoise` writes.
class Samplemap : public ProgramTest {
 protected:
  void SetUp() override {
    write_render(path("in.exr"));
    ASSERT_EQ(run({"denoise", "-i", "in.exr", "-o", "out.exr", "--error-map", "error.exr", "-q"}).code, 0);
  }
  Outcome samplemap(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"samplemap", "--error-map", "error.exr", "-o", "map.exr", "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  /// All samples of one channel of map.exr, row by row.
  std::vector<float> channel(const std::string& name) const {
    const OIIO::ImageBuf map = load(path("map.exr"));
    const int c = map.spec().channelindex(name);
    EXPECT_GE(c, 0) << name;
    std::vector<float> values;
    for (int y = map.ybegin(); y < map.yend(); ++y)
      for (int x = map.xbegin(); x < map.xend(); ++x) values.push_back(map.getchannel(x, y, 0, c));
    return values;
  }
  static double mean(const std::vector<float>& values) {
    double sum = 0;
    for (const float v : values) sum += v;
    return sum / static_cast<double>(values.size());
  }
};

TEST_F(Samplemap, SpendsTheBudgetAndSaysWhatItHolds) {
  const Outcome o = samplemap({"--budget", "32", "--samples", "16"});
  ASSERT_EQ(o.code, 0) << o.err;
  const std::vector<float> samples = channel("samples.Y"), importance = channel("importance.Y");
  EXPECT_NEAR(mean(samples), 32, 32e-6);
  EXPECT_EQ(*std::max_element(importance.begin(), importance.end()), 1);
  EXPECT_GE(*std::min_element(importance.begin(), importance.end()), 0);
  const OIIO::ImageBuf map = load(path("map.exr"));
  EXPECT_EQ(map.spec().get_float_attribute("budget"), 32);
  EXPECT_EQ(map.spec().get_float_attribute("max"), *std::max_element(samples.begin(), samples.end()));
  EXPECT_EQ(map.spec().get_float_attribute("min"), *std::min_element(samples.begin(), samples.end()));
  EXPECT_NEAR(map.spec().get_float_attribute("total"), 32 * 40 * 24, 0.1);
  EXPECT_NE(o.out.find("32 extra samples per pixel"), std::string::npos) << o.out;
}

TEST_F(Samplemap, IsTheMapThatDenoiseWrites) {
  ASSERT_EQ(
      run({"denoise", "-i", "in.exr", "-o", "out2.exr", "--sample-map", "direct.exr", "--budget", "8", "-q"}).code, 0);
  ASSERT_EQ(samplemap({"--budget", "8"}).code, 0);
  const OIIO::ImageBuf direct = load(path("direct.exr"));
  const std::vector<float> samples = channel("samples.Y");
  const int c = direct.spec().channelindex("samples.Y");
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x)
      ASSERT_EQ(direct.getchannel(x, y, 0, c), samples[static_cast<std::size_t>(y * 40 + x)]) << x << ", " << y;
}

TEST_F(Samplemap, ExportsWhatEachRendererTakes) {
  ASSERT_EQ(samplemap({"--budget", "8"}).code, 0);
  const std::vector<float> samples = channel("samples.Y"), importance = channel("importance.Y");
  ASSERT_EQ(samplemap({"--budget", "8", "--export", "appleseed"}).code, 0);
  EXPECT_THAT(load(path("map.exr")).spec().channelnames, ElementsAre("R"));
  EXPECT_EQ(channel("R"), importance);
  ASSERT_EQ(samplemap({"--budget", "8", "--export", "luxcore"}).code, 0);
  EXPECT_THAT(load(path("map.exr")).spec().channelnames, ElementsAre("Y"));
  EXPECT_EQ(channel("Y"), importance);
  ASSERT_EQ(samplemap({"--budget", "8", "--export", "vray"}).code, 0);
  EXPECT_THAT(load(path("map.exr")).spec().channelnames, ElementsAre("R", "G", "B"));
  const std::vector<float> mask = channel("G");
  for (std::size_t i = 0; i < mask.size(); ++i) ASSERT_EQ(mask[i], samples[i] >= 0.5f ? 1 : 0) << i;
}

TEST_F(Samplemap, TheCostOfAPixelCounts) {
  write_exr(path("cost.exr"), 40, 24, {"Y"}, [](int x, int, int) { return x < 20 ? 1.0 : 4.0; });
  ASSERT_EQ(samplemap({"--budget", "8"}).code, 0);
  const std::vector<float> free = channel("samples.Y");
  ASSERT_EQ(samplemap({"--budget", "8", "--cost", "cost.exr"}).code, 0);
  const std::vector<float> paid = channel("samples.Y");
  const auto left = [](const std::vector<float>& v) {
    double sum = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
      if (i % 40 < 16) sum += v[i];  // clear of the seam, which is smoothed
    return sum;
  };
  EXPECT_GT(left(paid), left(free));
  write_exr(path("small.exr"), 4, 4, {"Y"}, [](int, int, int) { return 1.0; });
  EXPECT_EQ(samplemap({"--budget", "8", "--cost", "small.exr"}).code, 3);
  EXPECT_EQ(samplemap({"--budget", "8", "--cost", "in.exr"}).code, 4);
}

TEST_F(Samplemap, RefusesContradictions) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{},
                                               {"--budget", "8", "--target", "0.1"},
                                               {"--budget", "9", "--max-samples", "8"},
                                               {"--budget", "8", "--export", "pov"},
                                               {"--budget", "8", "-o", "error.exr"}}) {
    const Outcome o = samplemap(more);
    EXPECT_EQ(o.code, 2) << o.err;
    EXPECT_TRUE(is_one_error_line(o.err));
  }
  const Outcome same = run({"samplemap", "-e", "error.exr", "-o", "error.exr", "--budget", "8"});
  EXPECT_EQ(same.code, 2);
  const Outcome other = run({"samplemap", "-e", "in.exr", "-o", "map.exr", "--budget", "8"});
  EXPECT_EQ(other.code, 4) << other.err;
  EXPECT_FALSE(exists("map.exr"));
}

TEST_F(Samplemap, KeepsWindowsAndCountsAndSaysWhenNothingIsLeft) {
  // A map of a cropped frame, with 4 samples everywhere and no error at all.
  OIIO::ImageSpec spec(6, 4, 6, OIIO::TypeDesc::FLOAT);
  spec.x = 3, spec.y = -2, spec.full_width = 20, spec.full_height = 10;
  spec.channelnames = {"mse.R", "mse.G", "mse.B", "relmse.Y", "relvariance.Y", "samples.Y"};
  OIIO::ImageBuf error(spec);
  const std::vector<float> pixel{0, 0, 0, 0, 0, 4};
  for (int y = -2; y < 2; ++y)
    for (int x = 3; x < 9; ++x) error.setpixel(x, y, pixel.data());
  ASSERT_TRUE(error.write(path("error.exr"))) << error.geterror();
  const Outcome o = samplemap({"--budget", "8"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.out.find("more samples would not lower the error"), std::string::npos) << o.out;
  EXPECT_EQ(o.out.find("assumed"), std::string::npos) << o.out;
  EXPECT_EQ(mean(channel("samples.Y")), 0);
  const OIIO::ImageSpec written = load(path("map.exr")).spec();
  EXPECT_EQ(std::vector<int>({written.x, written.y, written.width, written.height}), std::vector<int>({3, -2, 6, 4}));
  EXPECT_EQ(written.full_width, 20);
  // Renderers' maps cover the frame itself, from its corner.
  ASSERT_EQ(samplemap({"--budget", "8", "--export", "appleseed"}).code, 0);
  const OIIO::ImageSpec canvas = load(path("map.exr")).spec();
  EXPECT_EQ(std::vector<int>({canvas.x, canvas.y, canvas.width, canvas.height}), std::vector<int>({0, 0, 20, 10}));
}

}  // namespace
}  // namespace polyrecon::testing
