// Files whose channels are named as other programs name them: the same render under every name is the same frame, and
// the result goes into the channels of the beauty.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "io/exr_fixture.h"
#include "io/inspect.h"
#include "io/layers/channel_names.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using testing::error_of;
using ::testing::HasSubstr;
using testing::holds;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using testing::TestChannel;
using testing::TestPart;
using testing::write_exr;

constexpr int beauty_seed = 0, alpha_seed = 3, albedo_seed = 10, normal_seed = 20, depth_seed = 30;

using Names = std::array<const char*, 3>;

/// A render: what the channels of each pass are called. An empty name: the pass is missing.
struct Naming {
  const char* program;
  Names beauty;
  const char* alpha;
  Names albedo, normal;
  const char* depth;
};

void add(std::vector<TestChannel>& channels, const std::string& name, int seed) {
  if (!name.empty()) channels.push_back({name, Imf::FLOAT, testing::pattern(seed)});
}

std::vector<TestChannel> channels_of(const Naming& naming) {
  std::vector<TestChannel> channels;
  for (int c = 0; c < 3; ++c) {
    const auto i = static_cast<std::size_t>(c);
    add(channels, naming.beauty[i], beauty_seed + c);
    add(channels, naming.albedo[i], albedo_seed + c);
    add(channels, naming.normal[i], normal_seed + c);
  }
  add(channels, naming.alpha, alpha_seed);
  add(channels, naming.depth, depth_seed);
  return channels;
}

void expect_color(const Image& image, int seed, const std::string& what) {
  ASSERT_EQ(image.channels(), 3) << what;
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(holds(image, c, seed + c)) << what << ", channel " << c;
}

const Image* feature_of(const Frame& frame, Role role) {
  for (const Feature& feature : frame.features)
    if (feature.role == role) return &feature.pass.mean;
  return nullptr;
}

void expect_colors(const Frame& frame, const Naming& naming) {
  expect_color(frame.beauty.mean, beauty_seed, fmt::format("{}: beauty", naming.program));
  for (const auto& [role, seed] : {std::pair(Role::Albedo, albedo_seed), std::pair(Role::Normal, normal_seed)}) {
    const std::string what = fmt::format("{}: {}", naming.program, name_of(role));
    const Image* image = feature_of(frame, role);
    ASSERT_TRUE(image) << what;
    expect_color(*image, seed, what);
  }
  const Image* depth = feature_of(frame, Role::Depth);
  ASSERT_TRUE(depth) << naming.program;
  EXPECT_TRUE(holds(*depth, 0, depth_seed)) << naming.program;
}

void expect_frame(const Frame& frame, const Naming& naming) {
  expect_colors(frame, naming);
  EXPECT_TRUE(holds(frame.alpha, 0, alpha_seed)) << naming.program;
}

const std::vector<Naming>& namings() {
  static const std::vector<Naming> all{
      {"plain", {"R", "G", "B"}, "A", {"albedo.R", "albedo.G", "albedo.B"}, {"N.X", "N.Y", "N.Z"}, "Z"},
      {"lower case", {"r", "g", "b"}, "a", {"albedo.r", "albedo.g", "albedo.b"}, {"N.x", "N.y", "N.z"}, "z"},
      {"words",
       {"red", "green", "blue"},
       "alpha",
       {"albedo.R", "albedo.G", "albedo.B"},
       {"N.X", "N.Y", "N.Z"},
       "depth"},
      {"Nuke",
       {"beauty.red", "beauty.green", "beauty.blue"},
       "beauty.alpha",
       {"albedo.red", "albedo.green", "albedo.blue"},
       {"N.red", "N.green", "N.blue"},
       "depth.Z"},
      {"Karma", {"C.r", "C.g", "C.b"}, "C.a", {"albedo.r", "albedo.g", "albedo.b"}, {"N.x", "N.y", "N.z"}, "depth.z"},
      {"Mantra", {"C.R", "C.G", "C.B"}, "C.A", {"albedo.R", "albedo.G", "albedo.B"}, {"N.X", "N.Y", "N.Z"}, "Pz.Z"},
      {"Hydra",
       {"color.R", "color.G", "color.B"},
       "color.A",
       {"albedo.R", "albedo.G", "albedo.B"},
       {"Neye.X", "Neye.Y", "Neye.Z"},
       "cameraDepth.Z"},
      {"no dots", {"R", "G", "B"}, "A", {"AlbedoR", "AlbedoG", "AlbedoB"}, {"NormalX", "NormalY", "NormalZ"}, "Depth"},
      {"no dots at all",
       {"BeautyR", "BeautyG", "BeautyB"},
       "BeautyA",
       {"albedo_r", "albedo_g", "albedo_b"},
       {"normal_x", "normal_y", "normal_z"},
       "depth"},
      {"Redshift",
       {"R", "G", "B"},
       "A",
       {"DiffuseFilter.red", "DiffuseFilter.green", "DiffuseFilter.blue"},
       {"BumpNormals.red", "BumpNormals.green", "BumpNormals.blue"},
       "Z"},
      {"Octane",
       {"Beauty.R", "Beauty.G", "Beauty.B"},
       "Beauty.A",
       {"DiffuseFilterInfo.R", "DiffuseFilterInfo.G", "DiffuseFilterInfo.B"},
       {"NormalShading.R", "NormalShading.G", "NormalShading.B"},
       "ZDepth.Z"},
      {"Octane in Blender",
       {"ViewLayer.OctBeauty.R", "ViewLayer.OctBeauty.G", "ViewLayer.OctBeauty.B"},
       "ViewLayer.OctBeauty.A",
       {"ViewLayer.OctDiffFilter.R", "ViewLayer.OctDiffFilter.G", "ViewLayer.OctDiffFilter.B"},
       {"ViewLayer.OctShadingNormal.X", "ViewLayer.OctShadingNormal.Y", "ViewLayer.OctShadingNormal.Z"},
       "ViewLayer.OctZDepth.Z"},
      {"Unreal",
       {"R", "G", "B"},
       "A",
       {"FinalImageBaseColor.R", "FinalImageBaseColor.G", "FinalImageBaseColor.B"},
       {"FinalImageWorldNormal.R", "FinalImageWorldNormal.G", "FinalImageWorldNormal.B"},
       "FinalImageMovieRenderQueue_WorldDepth.R"},
      {"Arnold for noice",
       {"R", "G", "B"},
       "A",
       {"denoise_albedo.R", "denoise_albedo.G", "denoise_albedo.B"},
       {"N_noice.X", "N_noice.Y", "N_noice.Z"},
       "Z_noice.Z"},
      {"Arnold, AOVs with another filter too",
       {"R", "G", "B"},
       "A",
       {"denoise_albedo_noice.R", "denoise_albedo_noice.G", "denoise_albedo_noice.B"},
       {"N_noice.X", "N_noice.Y", "N_noice.Z"},
       "Z_noice.Z"},
      {"V-Ray",
       {"R", "G", "B"},
       "A",
       {"VRayDiffuseFilter.R", "VRayDiffuseFilter.G", "VRayDiffuseFilter.B"},
       {"VRayBumpNormals.R", "VRayBumpNormals.G", "VRayBumpNormals.B"},
       "VRayZDepth.R"},
      {"V-Ray without bump",
       {"RGB color.R", "RGB color.G", "RGB color.B"},
       "RGB color.A",
       {"VRayDiffuseFilter.R", "VRayDiffuseFilter.G", "VRayDiffuseFilter.B"},
       {"VRayNormals.X", "VRayNormals.Y", "VRayNormals.Z"},
       "VRayZDepth.Z"},
      {"Octane's names in brackets",
       {"R", "G", "B"},
       "A",
       {"Diffuse filter (info).R", "Diffuse filter (info).G", "Diffuse filter (info).B"},
       {"Normal (smooth).R", "Normal (smooth).G", "Normal (smooth).B"},
       "Z-depth.R"},
      {"Corona",
       {"R", "G", "B"},
       "A",
       {"CShading_Albedo.R", "CShading_Albedo.G", "CShading_Albedo.B"},
       {"CGeometry_NormalsShading.R", "CGeometry_NormalsShading.G", "CGeometry_NormalsShading.B"},
       "CGeometry_ZDepth.R"},
      {"Karma, ray hits",
       {"C.R", "C.G", "C.B"},
       "C.A",
       {"albedo.R", "albedo.G", "albedo.B"},
       {"hitN.X", "hitN.Y", "hitN.Z"},
       "hitPz"},
      {"colons", {"R", "G", "B"}, "A", {"albedo:R", "albedo:G", "albedo:B"}, {"N:X", "N:Y", "N:Z"}, "Z"},
      {"Blender's File Output node",
       {"Image.R", "Image.G", "Image.B"},
       "Image.A",
       {"Denoising Albedo.R", "Denoising Albedo.G", "Denoising Albedo.B"},
       {"Denoising Normal.X", "Denoising Normal.Y", "Denoising Normal.Z"},
       "Denoising Depth.V"},
      {"depth in the layer of the beauty",
       {"beauty.R", "beauty.G", "beauty.B"},
       "beauty.A",
       {"albedo.R", "albedo.G", "albedo.B"},
       {"N.X", "N.Y", "N.Z"},
       "beauty.Z"},
      {"a colour in CIE XYZ",
       {"X", "Y", "Z"},
       "A",
       {"albedo.R", "albedo.G", "albedo.B"},
       {"N.X", "N.Y", "N.Z"},
       "depth.Z"},
  };
  return all;
}

TEST(InputNames, OneRenderIsTheSameFrameUnderEveryName) {
  const TemporaryFolder folder;
  for (const Naming& naming : namings()) {
    TestPart part;
    part.channels = channels_of(naming);
    const ReadResult read = read_frame(write_exr(folder / "a.exr", {part}));
    expect_frame(read.frame, naming);
    EXPECT_THAT(read.notes, IsEmpty()) << naming.program;
  }
}

TEST(InputNames, TheResultGoesIntoTheChannelsOfTheBeautyInTheirOrder) {
  const TemporaryFolder folder;
  for (const Naming& naming : namings()) {
    TestPart part;
    part.channels = channels_of(naming);
    const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}));
    Image result = read.frame.beauty.mean;
    for (int c = 0; c < 3; ++c) std::fill_n(result.plane(c), result.pixels(), static_cast<Real>(100 + c));
    write_result(read.source, {{read.frame.beauty.name, result, false, {0, 0, 8, 6}}}, folder / "out.exr");
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_THAT(testing::stored_floats(folder / "out.exr", 0, naming.beauty[c]), ::testing::Each(100 + c))
          << naming.program;
    EXPECT_EQ(testing::stored_bytes(folder / "out.exr", 0, naming.albedo[0]),
              testing::stored_bytes(folder / "in.exr", 0, naming.albedo[0]))
        << naming.program;
    EXPECT_EQ(find_layers(describe_file(folder / "in.exr")).size(), 4U) << naming.program;
    EXPECT_EQ(picture_layer(find_layers(describe_file(folder / "out.exr")))->channels.front(), naming.beauty[0])
        << naming.program;
  }
}

TestPart part_of(const char* name, const Names& channels, int seed) {
  TestPart part;
  part.name = name;
  for (std::size_t c = 0; c < 3; ++c) add(part.channels, channels[c], seed + static_cast<int>(c));
  return part;
}

double offset_of(int seed) { return 1 + seed % 3; }

/// The channels with values that are by the offset of their seed above (sign 1) or below (sign -1) the fixture's.
std::vector<TestChannel> shifted(const Naming& naming, int sign) {
  std::vector<TestChannel> channels = channels_of(naming);
  const auto shift = [&](const char* name, int seed) {
    for (TestChannel& channel : channels)
      if (channel.name == name)
        channel.samples = [=](int x, int y) { return testing::pattern(seed)(x, y) + sign * offset_of(seed); };
  };
  for (std::size_t c = 0; c < 3; ++c) {
    shift(naming.beauty[c], beauty_seed + static_cast<int>(c));
    shift(naming.albedo[c], albedo_seed + static_cast<int>(c));
  }
  return channels;
}

/// Two renders d above and below their mean: the variance of the mean is d^2.
void expect_variance(const Image& variance, int seed, const std::string& what) {
  ASSERT_EQ(variance.channels(), 3) << what;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < variance.pixels(); ++i)
      ASSERT_EQ(variance.plane(c)[i], offset_of(seed + c) * offset_of(seed + c)) << what << ", channel " << c;
}

TEST(InputNames, MergedRendersHaveTheVarianceOfEachChannel) {
  const TemporaryFolder folder;
  for (const Naming& naming : namings()) {
    TestPart above, below;
    above.channels = shifted(naming, 1);
    below.channels = shifted(naming, -1);
    merge({write_exr(folder / "a.exr", {above}), write_exr(folder / "b.exr", {below})}, folder / "merged.exr");
    const Frame frame = read_frame(folder / "merged.exr").frame;
    expect_frame(frame, naming);
    expect_variance(frame.beauty.variance, beauty_seed, naming.program);
    ASSERT_EQ(frame.features[1].role, Role::Albedo);
    expect_variance(frame.features[1].pass.variance, albedo_seed, naming.program);
  }
}

TEST(InputNames, AMergedFileOfPartsHasItsBeauty) {
  const TemporaryFolder folder;
  std::vector<std::string> paths;
  for (const int sign : {1, -1}) {
    TestPart part;
    part.name = "subimage00";
    part.channels = shifted({"", {"R", "G", "B"}, "A", {"", "", ""}, {"", "", ""}, ""}, sign);
    paths.push_back(
        write_exr(folder / (sign > 0 ? "a.exr" : "b.exr"),
                  {part, part_of("albedo", {"R", "G", "B"}, albedo_seed), part_of("glow", {"R", "G", "B"}, 40)}));
  }
  merge(paths, folder / "merged.exr");
  const Frame frame = read_frame(folder / "merged.exr").frame;
  expect_color(frame.beauty.mean, beauty_seed, "beauty");
  expect_variance(frame.beauty.variance, beauty_seed, "beauty");
  ASSERT_EQ(frame.features.size(), 1U);
  expect_color(frame.features[0].pass.mean, albedo_seed, "albedo");
}

TEST(InputNames, TheNoisyLayerThatIsKeptHasItsChannelsInOrder) {
  const TemporaryFolder folder;
  for (const Naming& naming : namings()) {
    TestPart part;
    part.channels = channels_of(naming);
    const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}));
    WriteOptions options;
    options.keep_noisy = true;
    write_result(read.source, {{read.frame.beauty.name, Image(8, 6, 3, Real(7)), false, {0, 0, 8, 6}}},
                 folder / "out.exr", options);
    const Frame again = read_frame(folder / "out.exr").frame;
    expect_colors(again, naming);
    EXPECT_EQ(again.prior.mean.channels(), 3) << naming.program;
  }
}

/// A file with a part for each pass.
std::string write_parts(const std::string& path, const char* beauty, const std::vector<TestPart>& more) {
  TestPart part;
  part.name = beauty;
  for (int c = 0; c < 3; ++c) add(part.channels, std::string(1, "RGB"[c]), beauty_seed + c);
  add(part.channels, "A", alpha_seed);
  std::vector<TestPart> parts{part};
  parts.insert(parts.end(), more.begin(), more.end());
  return write_exr(path, parts);
}

TEST(InputNames, PartsThatAreNotNamedAfterTheBeauty) {
  const TemporaryFolder folder;
  TestPart depth;
  depth.name = "depth";
  add(depth.channels, "Z", depth_seed);
  for (const char* beauty : {"C", "Main", "subimage00", "rgba", "render_0"}) {
    const ReadResult read = read_frame(
        write_parts(folder / "a.exr", beauty,
                    {part_of("albedo", {"albedo.r", "albedo.g", "albedo.b"}, albedo_seed),
                     part_of("N", {"X", "Y", "Z"}, normal_seed), depth, part_of("emission", {"R", "G", "B"}, 40)}));
    expect_frame(read.frame, {beauty, {}, {}, {}, {}, {}});
    EXPECT_EQ(read.frame.beauty.name, beauty);
  }
}

TEST(InputNames, PartsWhoseNamesOnlyCountHaveTheNamesOfTheirChannels) {
  const TemporaryFolder folder;
  TestPart depth;
  depth.name = "subimage03";
  add(depth.channels, "Z", depth_seed);
  TestPart albedo = part_of("subimage01", {"albedo.R", "albedo.G", "albedo.B"}, albedo_seed);
  TestPart normal = part_of("subimage02", {"N.X", "N.Y", "N.Z"}, normal_seed);
  const ReadResult read = read_frame(write_parts(folder / "a.exr", "subimage00", {albedo, normal, depth}));
  expect_frame(read.frame, {"subimage00", {}, {}, {}, {}, {}});
  EXPECT_THAT(read.notes, IsEmpty());
}

TEST(InputNames, BareChannelsNextToPrefixedOnesDoNotTakeTheNameOfTheirPart) {
  const TemporaryFolder folder;
  TestPart beauty = part_of("beauty", {"Ci.r", "Ci.g", "Ci.b"}, beauty_seed);
  add(beauty.channels, "a", alpha_seed);
  TestPart depth;
  depth.name = "z";
  add(depth.channels, "z", depth_seed);
  const ReadResult read = read_frame(
      write_exr(folder / "a.exr", {beauty, part_of("albedo", {"albedo.r", "albedo.g", "albedo.b"}, albedo_seed),
                                   part_of("normal", {"normal.x", "normal.y", "normal.z"}, normal_seed), depth}));
  expect_frame(read.frame, {"RenderMan", {}, {}, {}, {}, {}});
  EXPECT_THAT(read.notes, IsEmpty());
}

TEST(InputNames, AnUnknownNameThatSaysFeatureIsNotedWhereTheFeatureIsMissing) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = testing::join({testing::layer("", "RGB"), testing::layer("rndrAlbedoPass", "RGB"),
                                 testing::layer("N", "XYZ"), testing::layer("myNormals", "XYZ")});
  const std::string path = write_exr(folder / "a.exr", {part});
  const ReadResult read = read_frame(path);
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_THAT(read.notes[0], HasSubstr("rndrAlbedoPass is not used"));
  EXPECT_THAT(read.notes[0], HasSubstr("--map albedo=rndrAlbedoPass"));
  EXPECT_EQ(inspect(path).notes, read.notes);
  ReadOptions options;
  options.map = {parse_mapping("albedo=rndrAlbedoPass")};
  EXPECT_THAT(read_frame(path, options).notes, IsEmpty());
}

TEST(InputNames, APartWithABareColorKeepsItsOtherBareChannels) {
  const TemporaryFolder folder;
  TestPart part;
  part.name = "Main";
  part.channels = channels_of(namings().front());
  TestPart matte = part_of("matte", {"R", "G", "B"}, 40);
  const ReadResult read = read_frame(write_exr(folder / "a.exr", {part, matte}));
  expect_frame(read.frame, {"Main", {}, {}, {}, {}, {}});
}

TEST(InputNames, TheOnlyColorLayerIsTheBeautyWithANote) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = channels_of(
      {"", {"sunset.R", "sunset.G", "sunset.B"}, "", {"albedo.R", "albedo.G", "albedo.B"}, {"N.X", "N.Y", "N.Z"}, "Z"});
  const ReadResult read = read_frame(write_exr(folder / "a.exr", {part}));
  EXPECT_EQ(read.frame.beauty.name, "sunset");
  EXPECT_THAT(read.notes, Contains(HasSubstr("sunset is taken for the beauty")));
  part.channels.push_back({"dawn.R"});
  part.channels.push_back({"dawn.G"});
  part.channels.push_back({"dawn.B"});
  const Error error = error_of([&] { read_frame(write_exr(folder / "b.exr", {part})); });
  EXPECT_EQ(error.code(), ExitCode::Missing);
  EXPECT_THAT(error.what(), HasSubstr("--map beauty=LAYER"));
}

TEST(InputNames, AWrongNumberOfChannelsIsRefusedBeforeAnyWork) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = testing::join({testing::layer("beauty", "RGBXY"), testing::layer("C", "RGB")});
  const std::string path = write_exr(folder / "a.exr", {part});
  ReadOptions options;
  options.map = {parse_mapping("beauty=beauty")};
  const Error error = error_of([&] { read_frame_header(path, options); });
  EXPECT_EQ(error.code(), ExitCode::BadInput);
  EXPECT_THAT(error.what(), HasSubstr("layer beauty cannot be the beauty: it has the 5 channels beauty.R"));
  EXPECT_EQ(read_frame(path).frame.beauty.name, "C");
}

TEST(InputNames, ALayerOfAnotherFileTakesNoResult) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = testing::layer("", "RGB");
  const std::string path = write_exr(folder / "a.exr", {part}), other = write_exr(folder / "b.exr", {part});
  ReadOptions options;
  options.map = {parse_mapping("beauty=" + other)};
  const Error error = error_of([&] { read_frame_header(path, options); });
  EXPECT_EQ(error.code(), ExitCode::BadInput);
  EXPECT_THAT(error.what(), HasSubstr("the beauty is a layer of the input"));
}

TEST(InputNames, AMisshapenFeatureIsNotedAndMissing) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = testing::join({testing::layer("", "RGB"), testing::layer("albedo", "UV")});
  const Inspection found = inspect(write_exr(folder / "a.exr", {part}));
  EXPECT_THAT(found.missing, Contains("albedo"));
  EXPECT_THAT(found.notes, Contains(HasSubstr("albedo is not used as albedo: it has 2 channels")));
}

TEST(InputNames, AFileWithoutABeautyMissesOnlyWhatItDoesNotHold) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = testing::join({testing::layer("albedo", "RGB"), testing::layer("N", "XYZ")});
  const Inspection found = inspect(write_exr(folder / "a.exr", {part}));
  EXPECT_THAT(found.missing, Contains("beauty"));
  EXPECT_THAT(found.missing, Contains("depth"));
  EXPECT_THAT(found.missing, ::testing::Not(Contains("albedo")));
  EXPECT_THAT(found.missing, ::testing::Not(Contains("normal")));
}

TEST(InputNames, AVarianceThatCannotBeUsedIsMissing) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels =
      testing::join({testing::layer("", "RGB"), testing::layer("Variance", "RGB")});  // pbrt's: of one sample
  const std::string path = write_exr(folder / "a.exr", {part});
  EXPECT_THAT(inspect(path).missing, Contains("variance"));
  ReadOptions options;
  options.samples = 16;
  EXPECT_THAT(inspect(path, options).missing, ::testing::Not(Contains("variance")));
}

}  // namespace
}  // namespace polyrecon
