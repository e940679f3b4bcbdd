// Depths of the sky: 1e10 in Blender before 5.2, the largest float over the samples from then on, +Inf in LuxCore.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/exr_fixture.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/reconstruct.h"

namespace polyrecon {
namespace {

using testing::layer;
using testing::stored_floats;
using testing::TemporaryFolder;
using testing::TestChannel;
using testing::TestPart;
using testing::write_exr;

constexpr int width = 40, height = 32;

/// A slope under a sky of this depth, in the manner of Blender: the row at the horizon is sky in renders of odd seeds.
TestPart render(double sky, int seed, const char* depth = "V.Denoising Depth") {
  const Rect picture{0, 0, width, height};
  TestPart part = testing::part_over(picture, picture, testing::join({layer("V.Combined", "RGB"), layer(depth, "Z")}));
  for (TestChannel& channel : part.channels)
    channel.samples = [=](int x, int y) { return y / 64.0 + 0.1 * testing::grain(x, y, seed); };
  part.channels.back().samples = [=](int x, int y) {
    return y < 16 || (y == 16 && seed % 2 == 1) ? sky : 100.0 - y + 0.01 * ((x + seed) % 3);
  };
  return part;
}

std::string merged(const TemporaryFolder& folder, double sky, const char* depth = "V.Denoising Depth") {
  std::vector<std::string> paths;
  for (int seed = 0; seed < 4; ++seed)
    paths.push_back(write_exr(folder / std::to_string(seed), {render(sky, seed, depth)}));
  const std::string out = folder / "merged.exr";
  merge(paths, out);
  return out;
}

constexpr std::array skies{1e10, static_cast<double>(std::numeric_limits<float>::max()) / 4,
                           static_cast<double>(std::numeric_limits<float>::max()),
                           std::numeric_limits<double>::infinity()};

TEST(SkyDepth, OneRenderIsReadAlikeWhateverTheRendererWritesForTheSky) {
  const TemporaryFolder folder;
  for (const double sky : skies) {
    const Frame frame = read_frame(write_exr(folder / "a.exr", {render(sky, 0)})).frame;
    const Image& depth = frame.features.front().pass.mean;
    EXPECT_EQ(depth.at(3, 3, 0), Real(1e10)) << sky;
    EXPECT_EQ(depth.at(3, 20, 0), Real(80)) << sky;
  }
}

TEST(SkyDepth, MergedRendersHaveAFiniteVariance) {
  const TemporaryFolder folder;
  const std::vector<float> expected = stored_floats(merged(folder, 1e10), 0, "V.Denoising Depth Variance.Z");
  EXPECT_EQ(expected[0], 0);
  EXPECT_GT(expected[20 * width], 0);
  for (const double sky : skies) {
    const std::string path = merged(folder, sky);
    EXPECT_EQ(stored_floats(path, 0, "V.Denoising Depth Variance.Z"), expected) << sky;
    EXPECT_EQ(stored_floats(path, 0, "V.Denoising Depth.Z")[0], 1e10F) << sky;
    EXPECT_EQ(stored_floats(path, 0, "V.Denoising Depth.Z")[16 * width], 5e9F + 42) << sky;
  }
}

TEST(SkyDepth, SkyNeedsNoRepair) {
  const TemporaryFolder folder;
  for (const double sky : skies) {
    Frame frame = read_frame(merged(folder, sky)).frame;
    const Report report = reconstruct(frame, params_for(Quality::Draft), silent_progress()).report;
    EXPECT_EQ(report.repaired_pixels, 0U) << sky;
  }
}

TEST(SkyDepth, ADepthForCompositingIsMergedOnlyWhereItIsAlone) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(stored_floats(merged(folder, 1e10, "V.Depth"), 0, "V.Depth Variance.Z"));
  std::vector<std::string> paths;
  for (int seed = 0; seed < 2; ++seed) {
    TestPart part = render(1e10, seed);
    part.channels.push_back({"V.Depth.Z", Imf::FLOAT, testing::constant(seed + 1)});
    paths.push_back(write_exr(folder / std::to_string(seed), {part}));
  }
  const std::string out = folder / "both.exr";
  merge(paths, out);
  EXPECT_THAT(stored_floats(out, 0, "V.Depth.Z"), ::testing::Each(1.0F));
  EXPECT_THROW(stored_floats(out, 0, "V.Depth Variance.Z"), std::runtime_error);
}

}  // namespace
}  // namespace polyrecon
