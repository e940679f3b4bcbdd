// Films of Mitsuba's integrator moment.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using ::testing::ElementsAre;
using testing::flat_layer;
using ::testing::HasSubstr;
using testing::join;
using testing::TemporaryFolder;
using testing::TestChannel;
using testing::TestPart;
using testing::write_exr;

std::vector<TestChannel> values(const std::string& name, const std::string& letters, const std::vector<double>& v) {
  auto channels = testing::layer(name, letters);
  for (std::size_t c = 0; c < channels.size(); ++c) channels[c].samples = testing::constant(v[c]);
  return channels;
}

/// A colour whose n = 5 samples are the mean times factors of variance 0.4: each channel's variance of the mean is
/// mean^2 * 0.4 / (5 - 1).
struct NoisyColor {
  double r = 0.8, g = 0.3, b = 0.1;
  double x = 0.412453 * r + 0.357580 * g + 0.180423 * b;
  double y = 0.212671 * r + 0.715160 * g + 0.072169 * b;
  double z = 0.019334 * r + 0.119193 * g + 0.950227 * b;

  std::vector<TestChannel> channels() const {
    return join({values("", "RGB", {r, g, b}), values("img", "XYZ", {x, y, z}),
                 values("m2_img", "XYZ", {1.4 * x * x, 1.4 * y * y, 1.4 * z * z})});
  }
};

TEST(MitsubaMoments, ThoseOfXyzBecomeTheVarianceOfRgb) {
  const TemporaryFolder folder;
  const NoisyColor color;
  TestPart part;
  part.channels = color.channels();
  ReadOptions options;
  options.samples = 5;
  const Pass beauty = read_frame(write_exr(folder / "a.exr", {part}), options).frame.beauty;
  ASSERT_FALSE(beauty.variance.empty());
  EXPECT_NEAR(beauty.variance.at(3, 2, 0) / (color.r * color.r * 0.1), 1, 1e-4);
  EXPECT_NEAR(beauty.variance.at(3, 2, 1) / (color.g * color.g * 0.1), 1, 1e-4);
  EXPECT_NEAR(beauty.variance.at(3, 2, 2) / (color.b * color.b * 0.1), 1, 1e-4);
}

TEST(MitsubaMoments, OfAPictureWithAlphaThoseOfRgbAreTaken) {
  const TemporaryFolder folder;
  const NoisyColor color;
  TestPart part;
  part.channels = join({color.channels(), values("img.img", "RGBA", {color.r, color.g, color.b, 1}),
                        values("m2_img.img", "RGBA", {2 * color.r * color.r, color.g * color.g, color.b * color.b, 1}),
                        flat_layer("img.pos", "XYZ", 3), flat_layer("m2_img.pos", "XYZ", 9)});
  ReadOptions options;
  options.samples = 5;
  const Pass beauty = read_frame(write_exr(folder / "a.exr", {part}), options).frame.beauty;
  EXPECT_NEAR(beauty.variance.at(3, 2, 0), color.r * color.r / 4, 1e-6);
  EXPECT_NEAR(beauty.variance.at(3, 2, 1), 0, 1e-6);
}

TEST(MitsubaMoments, APositionIsNoPicture) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = join({flat_layer("", "RGB", 1), flat_layer("img.pos", "XYZ", 3), flat_layer("m2_img.pos", "XYZ", 9)});
  ReadOptions options;
  options.samples = 5;
  EXPECT_TRUE(read_frame(write_exr(folder / "a.exr", {part}), options).frame.beauty.variance.empty());
}

TEST(MitsubaMoments, AreFoundInAnIntegratorAov) {
  const TemporaryFolder folder;
  const NoisyColor color;
  TestPart part;
  part.channels =
      join({values("", "RGB", {color.r, color.g, color.b}), values("img", "RGBA", {color.r, color.g, color.b, 1}),
            flat_layer("nn", "XYZ", 0.5), values("img.m", "XYZ", {color.x, color.y, color.z}),
            values("img.m2_m", "XYZ", {1.4 * color.x * color.x, 1.4 * color.y * color.y, 1.4 * color.z * color.z})});
  ReadOptions options;
  const std::string path = write_exr(folder / "a.exr", {part});
  EXPECT_THAT(read_frame(path).notes, ::testing::Contains(::testing::HasSubstr("img.m2_m is not used")));
  options.samples = 5;
  const Pass beauty = read_frame(path, options).frame.beauty;
  ASSERT_FALSE(beauty.variance.empty());
  EXPECT_NEAR(beauty.variance.at(3, 2, 0) / (color.r * color.r * 0.1), 1, 1e-4);
  EXPECT_NEAR(beauty.variance.at(3, 2, 2) / (color.b * color.b * 0.1), 1, 1e-4);
}

TEST(MitsubaMoments, OfAFilmInXyzOrOfLuminanceAreTakenAsTheyAre) {
  const TemporaryFolder folder;
  const NoisyColor color;
  const auto nested =
      join({values("m", "XYZ", {color.x, color.y, color.z}),
            values("m2_m", "XYZ", {1.4 * color.x * color.x, 1.8 * color.y * color.y, 2.2 * color.z * color.z}),
            values("m.img", "RGBA", {color.r, color.g, color.b, 1}), values("m2_m.img", "RGBA", {9, 9, 9, 1})});
  ReadOptions options;
  options.samples = 5;
  TestPart xyz;
  xyz.channels = join({values("", "XYZ", {color.x, color.y, color.z}), nested});
  const Pass of_xyz = read_frame(write_exr(folder / "xyz.exr", {xyz}), options).frame.beauty;
  ASSERT_FALSE(of_xyz.variance.empty());
  EXPECT_NEAR(of_xyz.variance.at(3, 2, 0) / (color.x * color.x * 0.1), 1, 1e-5);
  EXPECT_NEAR(of_xyz.variance.at(3, 2, 1) / (color.y * color.y * 0.2), 1, 1e-5);
  EXPECT_NEAR(of_xyz.variance.at(3, 2, 2) / (color.z * color.z * 0.3), 1, 1e-5);
  TestPart grey;
  grey.channels = join({values("", "Y", {color.y}), nested});
  const Pass of_grey = read_frame(write_exr(folder / "grey.exr", {grey}), options).frame.beauty;
  ASSERT_FALSE(of_grey.variance.empty());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(of_grey.variance.at(3, 2, c) / (color.y * color.y * 0.2), 1, 1e-5);
}

TEST(MitsubaMoments, ALayerOfTheChannelTIsTheDepth) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = join({flat_layer("", "RGB", 1), flat_layer("dd.y", "T", 7)});
  const Frame frame = read_frame(write_exr(folder / "a.exr", {part})).frame;
  ASSERT_EQ(frame.features.size(), 1U);
  EXPECT_EQ(frame.features.front().role, Role::Depth);
  EXPECT_EQ(frame.features.front().pass.mean.at(0, 0, 0), 7);
}

TEST(MitsubaMoments, AMomentWithoutItsPictureHasANote) {
  const TemporaryFolder folder;
  const NoisyColor color;
  TestPart part;
  part.channels = join({values("", "RGB", {color.r, color.g, color.b}), values("m2_img", "XYZ", {1, 1, 1})});
  ReadOptions options;
  options.samples = 5;
  const ReadResult read = read_frame(write_exr(folder / "a.exr", {part}), options);
  EXPECT_TRUE(read.frame.beauty.variance.empty());
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("m2_img is not used: it is the second moment of img")));
}

}  // namespace
}  // namespace polyrecon
