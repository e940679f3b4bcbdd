#include "polyrecon/read_frame.h"

#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/exr_fixture.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using testing::error_of;
using testing::flat_layer;
using ::testing::HasSubstr;
using testing::holds;
using ::testing::IsEmpty;
using testing::join;
using testing::layer;
using testing::pattern;
using ::testing::SizeIs;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::with_text;
using testing::write_exr;

TestPart part_of(std::vector<testing::TestChannel> channels) {
  TestPart part;
  part.channels = std::move(channels);
  return part;
}

double everywhere(const Image& image, int c = 0) {
  for (std::size_t i = 1; i < image.pixels(); ++i)
    if (image.plane(c)[i] != image.plane(c)[0]) ADD_FAILURE() << "not constant";
  return static_cast<double>(image.plane(c)[0]);
}

TEST(ReadFrame, FillsEveryRoleAndCompanionOfASinglePartFile) {
  const TemporaryFolder folder;
  TestPart part = part_of(
      join({layer("V.Combined", "RGBA", 0), layer("V.Combined Variance", "RGB", 10), layer("V.Combined A", "RGB", 20),
            layer("V.Combined B", "RGB", 30), layer("V.Denoising Normal", "XYZ", 40),
            layer("V.Denoising Normal Variance", "XYZ", 43), layer("V.Denoising Albedo", "RGB", 50),
            layer("V.Denoising Depth", "Z", 60), layer("V.Denoising Depth A", "Z", 61),
            layer("V.Denoising Depth B", "Z", 62), layer("V.Visibility", "Z", 63), layer("V.Sample Count", "X", 64)}));
  part.window = {-4, 3, 9, 14};
  const ReadResult read = read_frame(write_exr(folder / "a.exr", {part}));
  const Frame& frame = read.frame;
  EXPECT_EQ(frame.data_window, part.window);
  EXPECT_EQ(frame.width(), 13);
  EXPECT_EQ(frame.height(), 11);
  EXPECT_EQ(frame.beauty.name, "V.Combined");
  for (int c = 0; c < 3; ++c) {
    EXPECT_TRUE(holds(frame.beauty.mean, c, part.window, c));
    EXPECT_TRUE(holds(frame.beauty.variance, c, part.window, 10 + c));
    EXPECT_TRUE(holds(frame.beauty.half_a, c, part.window, 20 + c));
    EXPECT_TRUE(holds(frame.beauty.half_b, c, part.window, 30 + c));
  }
  EXPECT_TRUE(holds(frame.alpha, 0, part.window, 3));
  ASSERT_THAT(frame.features, SizeIs(4));
  EXPECT_EQ(frame.features[0].role, Role::Normal);
  EXPECT_TRUE(holds(frame.features[0].pass.mean, 2, part.window, 42));
  EXPECT_TRUE(holds(frame.features[0].pass.variance, 2, part.window, 45));
  EXPECT_FALSE(frame.features[0].pass.has_halves());
  EXPECT_EQ(frame.features[1].role, Role::Albedo);
  EXPECT_EQ(frame.features[2].role, Role::Depth);
  EXPECT_EQ(frame.features[2].pass.mean.channels(), 1);
  EXPECT_TRUE(holds(frame.features[2].pass.half_b, 0, part.window, 62));
  EXPECT_EQ(frame.features[3].role, Role::Visibility);
  EXPECT_TRUE(holds(frame.sample_count, 0, part.window, 64));
  EXPECT_TRUE(frame.prior.mean.empty());
  EXPECT_EQ(read.source.alpha_layer, "V.Combined");
  EXPECT_THAT(read.notes, IsEmpty());
  EXPECT_THAT(read.source.chosen, SizeIs(12));
}

TEST(ReadFrame, OnePartForEachPassAndAPrior) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts;
  int seed = 0;
  for (const auto& [name, letters] : std::vector<std::pair<std::string, std::string>>{
           {"V.Combined", "RGBA"}, {"V.Noisy Image", "RGBA"}, {"V.Denoising Albedo", "RGB"}, {"V.Depth", "Z"}}) {
    parts.push_back(part_of(layer(name, letters, seed)));
    parts.back().name = name;
    seed += 10;
  }
  FrameShape found;
  ReadOptions options;
  options.accept = [&](const std::string&, const FrameShape& shape) { found = shape; };
  const ReadResult read = read_frame(write_exr(folder / "a.exr", parts), options);
  EXPECT_EQ(found.prior_channels, 3);
  EXPECT_EQ(found.channels, 3 + 1 + 3 + 2 * 3 + 1);  // noisy, its alpha, prior, albedo and its noise, depth
  EXPECT_EQ(found.feature_channels, 4);
  EXPECT_EQ(read.frame.beauty.name, "V.Noisy Image");
  EXPECT_TRUE(holds(read.frame.beauty.mean, 0, parts[0].window, 10));
  EXPECT_TRUE(holds(read.frame.prior.mean, 0, parts[0].window, 0));
  EXPECT_TRUE(holds(read.frame.alpha, 0, parts[0].window, 13));
  ASSERT_THAT(read.frame.features, SizeIs(2));
  EXPECT_TRUE(holds(read.frame.features[1].pass.mean, 0, parts[0].window, 30));
}

TEST(ReadFrame, HalfTiledAndUintSamples) {
  const TemporaryFolder folder;
  TestPart part = part_of(join({layer("", "RGB", 0, Imf::HALF), layer("Sample Count", "X", 9, Imf::UINT)}));
  part.tile = 4;
  part.window = {0, 0, 21, 10};
  const Frame frame = read_frame(write_exr(folder / "a.exr", {part})).frame;
  EXPECT_TRUE(holds(frame.beauty.mean, 1, part.window, 1));
  EXPECT_TRUE(holds(frame.sample_count, 0, part.window, 9));
}

TEST(ReadFrame, KeepsNanAndInfinity) {
  const TemporaryFolder folder;
  TestPart part = part_of(layer("", "RGB"));
  part.channels[0].samples = [](int x, int) {
    return x == 1 ? std::numeric_limits<double>::quiet_NaN() : x == 2 ? std::numeric_limits<double>::infinity() : -1.0;
  };
  const Image mean = read_frame(write_exr(folder / "a.exr", {part})).frame.beauty.mean;
  EXPECT_TRUE(std::isnan(mean.at(1, 0, 0)));
  EXPECT_TRUE(std::isinf(mean.at(2, 0, 0)));
  EXPECT_EQ(mean.at(3, 0, 0), -1);
}

TEST(ReadFrame, OnePixel) {
  const TemporaryFolder folder;
  TestPart part = part_of(layer("", "RGB"));
  part.window = part.display = {5, 5, 6, 6};
  const Frame frame = read_frame(write_exr(folder / "a.exr", {part})).frame;
  EXPECT_EQ(frame.width() * frame.height(), 1);
  EXPECT_TRUE(holds(frame.beauty.mean, 2, part.window, 2));
}

TEST(ReadFrame, ASampleVarianceIsDividedByTheSampleCount) {
  // pbrt: Variance is that of one sample; 12 / 16 = 0.75.
  const TemporaryFolder folder;
  TestPart part = part_of(join({flat_layer("", "RGB", 2), flat_layer("Variance", "RGB", 12)}));
  part.edit = with_text("samplesPerPixel", "16");
  const ReadResult read = read_frame(write_exr(folder / "a.exr", {part}));
  EXPECT_EQ(everywhere(read.frame.beauty.variance, 1), 0.75);
}

TEST(ReadFrame, AVarianceThatNeedsAnUnknownSampleCountIsNotUsed) {
  const TemporaryFolder folder;
  const std::string path =
      write_exr(folder / "a.exr", {part_of(join({flat_layer("", "RGB", 2), flat_layer("Variance", "RGB", 12)}))});
  const ReadResult read = read_frame(path);
  EXPECT_TRUE(read.frame.beauty.variance.empty());
  EXPECT_THAT(read.notes, Contains(HasSubstr("--samples")));
  ReadOptions options;
  options.samples = 4;
  EXPECT_EQ(everywhere(read_frame(path, options).frame.beauty.variance), 3);
}

TEST(ReadFrame, ASecondMomentBecomesAVariance) {
  // Mean 3, mean square 21, 5 samples: the unbiased variance of the mean is (21 - 9) / (5 - 1) = 3. A mean square below
  // the squared mean (rounding) gives 0.
  const TemporaryFolder folder;
  TestPart part =
      part_of(join({flat_layer("albedo", "RGB", 3), flat_layer("m2_albedo", "RGB", 21), flat_layer("", "RGB", 1),
                    flat_layer("nn", "XYZ", 1), flat_layer("m2_nn", "XYZ", 0.5)}));
  ReadOptions options;
  options.samples = 5;
  const Frame frame = read_frame(write_exr(folder / "a.exr", {part}), options).frame;
  ASSERT_THAT(frame.features, SizeIs(2));
  EXPECT_EQ(everywhere(frame.features[0].pass.variance), 0);
  EXPECT_EQ(everywhere(frame.features[1].pass.variance), 3);
}

TEST(ReadFrame, AVarianceThatIsNamedByHandKeepsTheKindOfItsName) {
  // RenderMan's _var is the variance of one sample, 12 / 4; of a layer whose name says nothing it is that of the mean.
  const TemporaryFolder folder;
  const std::string path = write_exr(
      folder / "a.exr",
      {part_of(join({flat_layer("light", "RGB", 2), flat_layer("light_var", "RGB", 12), flat_layer("v", "RGB", 5)}))});
  ReadOptions options;
  options.samples = 4;
  options.map = {parse_mapping("beauty=light"), parse_mapping("variance=light_var")};
  EXPECT_EQ(everywhere(read_frame(path, options).frame.beauty.variance), 3);
  options.map.back() = parse_mapping("variance=v");
  EXPECT_EQ(everywhere(read_frame(path, options).frame.beauty.variance), 5);
  options.map.back() = parse_mapping("variance=light_var");
  options.variance_kind = VarianceKind::Mean;
  EXPECT_EQ(everywhere(read_frame(path, options).frame.beauty.variance), 12);
}

TEST(ReadFrame, VarianceKindOverridesTheNames) {
  const TemporaryFolder folder;
  const std::string path =
      write_exr(folder / "a.exr",
                {part_of(join({flat_layer("L.Combined", "RGB", 2), flat_layer("L.Combined Variance", "RGB", 12)}))});
  ReadOptions options;
  options.samples = 4;
  EXPECT_EQ(everywhere(read_frame(path, options).frame.beauty.variance), 12);
  options.variance_kind = VarianceKind::Sample;
  EXPECT_EQ(everywhere(read_frame(path, options).frame.beauty.variance), 3);
  options.variance_kind = VarianceKind::SecondMoment;  // (12 - 4) / 3
  EXPECT_FLOAT_EQ(static_cast<float>(everywhere(read_frame(path, options).frame.beauty.variance)), 8.f / 3.f);
  options.variance_kind = VarianceKind::Mean;
  EXPECT_EQ(everywhere(read_frame(path, options).frame.beauty.variance), 12);
}

TEST(ReadFrame, AFractionOfTheSampleCountBecomesANumber) {
  const TemporaryFolder folder;
  TestPart part = part_of(join({layer("V.Combined", "RGB"), flat_layer("V.Debug Sample Count", "X", 0.25)}));
  const std::string unknown = write_exr(folder / "b.exr", {part});
  part.edit = with_text("cycles.V.samples", "64");
  EXPECT_EQ(everywhere(read_frame(write_exr(folder / "a.exr", {part})).frame.sample_count), 16);
  const ReadResult read = read_frame(unknown);
  EXPECT_TRUE(read.frame.sample_count.empty());
  EXPECT_THAT(read.notes, SizeIs(1));
}

TEST(ReadFrame, TheSampleCountOfTheMetadataOrTheOptionIsThatOfAllPixels) {
  const TemporaryFolder folder;
  TestPart part = part_of(layer("V.Combined", "RGB"));
  const std::string unknown = write_exr(folder / "b.exr", {part});
  EXPECT_TRUE(read_frame(unknown).frame.sample_count.empty());
  ReadOptions options;
  options.samples = 9;
  EXPECT_EQ(everywhere(read_frame(unknown, options).frame.sample_count), 9);
  part.edit = with_text("cycles.V.samples", "64");
  EXPECT_EQ(everywhere(read_frame(write_exr(folder / "a.exr", {part})).frame.sample_count), 64);
}

/// (X, Y) lead to the place in the frame before, (Z, W) come from the one in the frame after, rows upwards;
/// Frame::motion leads to both, rows downwards. Checked against renders of Blender 5: the albedo is found again along
/// them.
TEST(ReadFrame, MotionVectorsAreReadOnRequest) {
  const TemporaryFolder folder;
  write_exr(folder / "in.exr", {part_of(join({layer("V.Combined", "RGB", 0), layer("V.Vector", "XYZW", 10)}))});
  EXPECT_TRUE(read_frame(folder / "in.exr").frame.motion.empty());
  ReadOptions options;
  options.motion = true;
  const Image motion = read_frame(folder / "in.exr", options).frame.motion;
  ASSERT_EQ(motion.channels(), 4);
  const double sign[] = {1, -1, -1, 1};
  for (int c = 0; c < 4; ++c) EXPECT_EQ(static_cast<double>(motion.at(0, 0, c)), sign[c] * pattern(10 + c)(0, 0)) << c;
}

TEST(ReadFrame, AVisibilityInColorIsAveraged) {
  // Means 1, 2, 6 -> 3. Standard deviations 1, 2, 3 of one and the same noise -> (6 / 3)^2 = 4.
  const TemporaryFolder folder;
  TestPart part =
      part_of(join({layer("V.Combined", "RGB"), flat_layer("V.Shadow", "R", 1), flat_layer("V.Shadow", "G", 2),
                    flat_layer("V.Shadow", "B", 6), flat_layer("V.Shadow Variance", "R", 1),
                    flat_layer("V.Shadow Variance", "G", 4), flat_layer("V.Shadow Variance", "B", 9)}));
  const Frame frame = read_frame(write_exr(folder / "a.exr", {part})).frame;
  ASSERT_THAT(frame.features, SizeIs(1));
  EXPECT_EQ(frame.features[0].pass.mean.channels(), 1);
  EXPECT_EQ(everywhere(frame.features[0].pass.mean), 3);
  EXPECT_EQ(everywhere(frame.features[0].pass.variance), 4);
}

TEST(ReadFrame, AGrayBeautyIsRepeated) {
  const TemporaryFolder folder;
  const Frame frame = read_frame(write_exr(folder / "a.exr", {part_of(layer("beauty", "Y", 5))})).frame;
  ASSERT_EQ(frame.beauty.mean.channels(), 3);
  EXPECT_TRUE(holds(frame.beauty.mean, 2, {0, 0, 8, 6}, 5));
}

TEST(ReadFrame, ViewLayersAreChosenByName) {
  const TemporaryFolder folder;
  const std::string path = write_exr(
      folder / "a.exr", {part_of(join({layer("Back.v1.Combined", "RGB", 0), layer("Back.v1.Depth", "Z", 5),
                                       layer("Vorder.Combined", "RGB", 10), layer("Vorder.Depth", "Z", 15)}))});
  EXPECT_EQ(read_frame(path).source.view_layer, "Back.v1");
  ReadOptions options;
  options.view_layer = "Vorder";
  const ReadResult read = read_frame(path, options);
  EXPECT_TRUE(holds(read.frame.beauty.mean, 0, {0, 0, 8, 6}, 10));
  ASSERT_THAT(read.frame.features, SizeIs(1));
  EXPECT_TRUE(holds(read.frame.features[0].pass.mean, 0, {0, 0, 8, 6}, 15));
  options.view_layer = "None";
  EXPECT_EQ(error_of([&] { read_frame(path, options); }).code(), ExitCode::Missing);
}

TEST(ReadFrame, StereoViews) {
  const TemporaryFolder folder;
  TestPart part = part_of(join(
      {layer("", "RGB", 0), layer("right", "RGB", 10), layer("depth.left", "Z", 5), layer("depth.right", "Z", 15)}));
  part.edit = [](Imf::Header& header) { Imf::addMultiView(header, {"left", "right"}); };
  const std::string path = write_exr(folder / "a.exr", {part});
  EXPECT_TRUE(holds(read_frame(path).frame.features.at(0).pass.mean, 0, part.window, 5));
  ReadOptions options;
  options.view = "right";
  const Frame frame = read_frame(path, options).frame;
  EXPECT_TRUE(holds(frame.beauty.mean, 0, part.window, 10));
  EXPECT_TRUE(holds(frame.features.at(0).pass.mean, 0, part.window, 15));
}

TEST(ReadFrame, RolesByHand) {
  const TemporaryFolder folder;
  const std::string path =
      write_exr(folder / "a.exr",
                {part_of(join({layer("V.Foo", "RGB", 0), layer("V.FooVar", "RGB", 10), layer("V.One", "RGB", 20),
                               layer("V.Two", "RGB", 30), layer("V.Kd", "RGB", 40), layer("V.Pos", "XYZ", 50)}))});
  EXPECT_EQ(error_of([&] { read_frame(path); }).code(), ExitCode::Missing);
  ReadOptions options;
  for (const char* text :
       {"beauty=V.Foo", "variance=V.FooVar", "half-a=V.One", "half-b=V.Two", "albedo=V.Kd", "depth=V.Pos.Z"})
    options.map.push_back(parse_mapping(text));
  const Rect window{0, 0, 8, 6};
  const Frame frame = read_frame(path, options).frame;
  EXPECT_TRUE(holds(frame.beauty.mean, 0, window, 0));
  EXPECT_TRUE(holds(frame.beauty.variance, 0, window, 10));
  EXPECT_TRUE(holds(frame.beauty.half_a, 0, window, 20));
  EXPECT_TRUE(holds(frame.beauty.half_b, 0, window, 30));
  ASSERT_THAT(frame.features, SizeIs(2));
  EXPECT_TRUE(holds(frame.features[0].pass.mean, 0, window, 40));
  EXPECT_TRUE(holds(frame.features[1].pass.mean, 0, window, 52));
  options.map = {parse_mapping("beauty=V.None")};
  const Error error = error_of([&] { read_frame(path, options); });
  EXPECT_EQ(error.code(), ExitCode::Missing);
  EXPECT_THAT(error.what(), HasSubstr("V.Kd"));
}

TEST(ReadFrame, ARoleFromAnotherFile) {
  const TemporaryFolder folder;
  const std::string beauty = write_exr(folder / "noisy.exr", {part_of(layer("", "RGB", 0))});
  const std::string extra = write_exr(folder / "extra.exr", {part_of(layer("", "RGB", 10))});
  ReadOptions options;
  options.map.push_back(parse_mapping("albedo=" + extra));
  const ReadResult read = read_frame(beauty, options);
  ASSERT_THAT(read.frame.features, SizeIs(1));
  EXPECT_TRUE(holds(read.frame.features[0].pass.mean, 1, {0, 0, 8, 6}, 11));
  ASSERT_THAT(read.source.files, SizeIs(2));
}

TEST(ReadFrame, ARoleFromAFileOfManyLayersIsTheLayerWithThatRoleElseTheBeauty) {
  const TemporaryFolder folder;
  const TestPart noisy = part_of(layer("", "RGB"));
  const std::string in = write_exr(folder / "in.exr", {noisy});
  const std::string other = write_exr(
      folder / "other.exr", {part_of(join({layer("V.Combined A", "RGB", 20), layer("V.Combined B", "RGB", 30),
                                           layer("V.Combined", "RGB", 40), layer("V.Denoising Albedo", "RGB", 50)}))});
  ReadOptions options;
  options.map = {parse_mapping("prior=" + other), parse_mapping("albedo=" + other)};
  const Frame frame = read_frame(in, options).frame;
  ASSERT_EQ(frame.prior.mean.channels(), 3);
  EXPECT_TRUE(holds(frame.prior.mean, 0, noisy.window, 40));
  ASSERT_THAT(frame.features, SizeIs(1));
  EXPECT_TRUE(holds(frame.features[0].pass.mean, 0, noisy.window, 50));
}

TEST(ReadFrame, OnePassAFileIsGathered) {
  // Tungsten: <name>Color.exr and its companions, <name>Albedo.exr and so on, all plain RGB.
  const TemporaryFolder folder;
  int seed = 0;
  for (const char* name : {"sceneColor", "sceneColorVariance", "sceneColorA", "sceneColorB", "sceneAlbedo",
                           "sceneNormal", "sceneDepth", "otherVisibility", "sceneNotes"})
    write_exr(folder / (std::string(name) + ".exr"), {part_of(layer("", "RGB", 10 * seed++))});
  const Rect window{0, 0, 8, 6};
  const ReadResult read = read_frame(folder / "sceneColor.exr");
  EXPECT_TRUE(holds(read.frame.beauty.mean, 0, window, 0));
  EXPECT_TRUE(holds(read.frame.beauty.variance, 0, window, 10));
  EXPECT_TRUE(holds(read.frame.beauty.half_a, 0, window, 20));
  EXPECT_TRUE(holds(read.frame.beauty.half_b, 0, window, 30));
  ASSERT_THAT(read.frame.features, SizeIs(3));
  EXPECT_TRUE(holds(read.frame.features[0].pass.mean, 0, window, 50));
  EXPECT_TRUE(holds(read.frame.features[1].pass.mean, 0, window, 40));
  EXPECT_EQ(read.frame.features[2].role, Role::Depth);
  EXPECT_THAT(read.notes, Contains(HasSubstr("sceneAlbedo.exr")));
}

TEST(ReadFrame, RequestedAovsAndTheirCompanions) {
  const TemporaryFolder folder;
  const std::string path = write_exr(
      folder / "a.exr",
      {part_of(join({layer("V.Combined", "RGB", 0), layer("V.DiffDir", "RGB", 10), layer("V.DiffDir A", "RGB", 20),
                     layer("V.DiffDir B", "RGB", 30), layer("V.GlossDir", "RGB", 40), layer("V.UV", "UV", 50)}))});
  EXPECT_THAT(read_frame(path).frame.aovs, IsEmpty());
  ReadOptions options;
  options.aovs = {"V.GlossDir", "DiffDir"};
  const Frame frame = read_frame(path, options).frame;
  ASSERT_THAT(frame.aovs, SizeIs(2));
  EXPECT_EQ(frame.aovs[1].name, "V.DiffDir");
  EXPECT_TRUE(holds(frame.aovs[0].mean, 0, {0, 0, 8, 6}, 40));
  EXPECT_TRUE(holds(frame.aovs[1].half_b, 2, {0, 0, 8, 6}, 32));
  options.aovs = {"Nothing"};
  EXPECT_EQ(error_of([&] { read_frame(path, options); }).code(), ExitCode::Missing);
  options.aovs = {"UV"};
  EXPECT_EQ(error_of([&] { read_frame(path, options); }).code(), ExitCode::BadInput);
}

TEST(ReadFrame, PartsOfOtherWindowsAreCutAndFilledUp) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts{part_of(layer("beauty", "RGB", 0)), part_of(layer("albedo", "RGB", 10)),
                              part_of(layer("normal", "XYZ", 20))};
  for (TestPart& part : parts) part.name = part.channels[0].name.substr(0, part.channels[0].name.find('.'));
  parts[0].window = {1, 1, 7, 5};
  parts[1].window = {-2, -2, 8, 9};
  parts[2].window = {2, 1, 7, 5};
  const ReadResult read = read_frame(write_exr(folder / "a.exr", parts));
  ASSERT_THAT(read.frame.features, SizeIs(2));
  EXPECT_TRUE(holds(read.frame.features[1].pass.mean, 0, parts[0].window, 10));
  const Image& normal = read.frame.features[0].pass.mean;
  EXPECT_EQ(normal.at(0, 0, 0), 0);
  EXPECT_EQ(static_cast<double>(normal.at(1, 0, 0)), pattern(20)(2, 1));
}

TEST(ReadFrame, NeedsMemoryWithinTheLimit) {
  const TemporaryFolder folder;
  const std::string path = write_exr(folder / "a.exr", {part_of(join({layer("", "RGB"), layer("albedo", "RGB")}))});
  ReadOptions options;
  options.limits.max_bytes = 8 * 6 * 6 * sizeof(Real) - 1;
  EXPECT_EQ(error_of([&] { read_frame(path, options); }).code(), ExitCode::OutOfMemory);
  ++options.limits.max_bytes;
  EXPECT_NO_THROW(read_frame(path, options));
}

TEST(ReadFrameHeader, ChoosesAsReadFrameDoes) {
  const TemporaryFolder folder;
  const std::string path = write_exr(folder / "a.exr", {part_of(join({layer("", "RGB"), layer("albedo", "RGB")}))});
  const ReadResult header = read_frame_header(path), read = read_frame(path);
  EXPECT_TRUE(header.frame.beauty.mean.empty());
  ASSERT_EQ(header.source.chosen.size(), read.source.chosen.size());
  for (std::size_t i = 0; i < header.source.chosen.size(); ++i)
    EXPECT_EQ(header.source.chosen[i].layer, read.source.chosen[i].layer);
}

TEST(ParseMapping, RefusesWhatItDoesNotKnow) {
  for (const char* text : {"beauty", "beauty=", "=X", "beuty=X", "color=X", "other=X", "beauty-half=X"})
    EXPECT_EQ(error_of([&] { parse_mapping(text); }).code(), ExitCode::Usage) << text;
  const RoleMapping mapping = parse_mapping("normal-variance=My.Layer=1");
  EXPECT_EQ(mapping.role, Role::Normal);
  EXPECT_EQ(mapping.companion, Companion::VarianceOfMean);
  EXPECT_EQ(mapping.layer, "My.Layer=1");
}

}  // namespace
}  // namespace polyrecon
