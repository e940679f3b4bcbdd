// Files with several view layers and stereo views: each beauty gets the features of its own view layer and view.

#include <OpenEXR/ImfStandardAttributes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "io/exr_fixture.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/write_result.h"

namespace polyrecon {
namespace {

using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::TestChannel;
using testing::TestPart;
using testing::write_exr;

enum Seed { left_beauty = 0, left_albedo = 10, right_beauty = 20, right_albedo = 30 };

void add(std::vector<TestChannel>& channels, const std::string& prefix, const std::string& letters, int seed) {
  for (const char letter : letters)
    channels.push_back(
        {prefix.empty() ? std::string(1, letter) : prefix + "." + letter, Imf::FLOAT, testing::pattern(seed++)});
}

TestPart part_of(const std::vector<std::pair<std::string, int>>& layers, const std::string& name = {},
                 const std::string& view = {}) {
  TestPart part;
  part.name = name;
  part.view = view;
  for (const auto& [layer, seed] : layers) add(part.channels, layer, "RGB", seed);
  return part;
}

void set_views(TestPart& part) {
  part.edit = [](Imf::Header& header) { Imf::addMultiView(header, {"left", "right"}); };
}

bool holds_colors(const Image& image, int seed) {
  for (int c = 0; c < 3; ++c)
    if (!testing::holds(image, c, seed + c)) return false;
  return true;
}

/// Reads one picture of the file and compares its beauty and its only feature.
void expect_picture(const std::string& path, const LayerView& place, int beauty, int albedo) {
  ReadOptions options;
  options.picture = place;
  const Frame frame = read_frame(path, options).frame;
  const std::string title = name_of(place);
  EXPECT_TRUE(holds_colors(frame.beauty.mean, beauty)) << title;
  ASSERT_EQ(frame.features.size(), 1U) << title;
  EXPECT_TRUE(holds_colors(frame.features[0].pass.mean, albedo)) << title;
}

/// A file with both eyes.
void expect_eyes(const std::string& path, const std::string& view_layer = {}) {
  EXPECT_THAT(read_frame_header(path).source.pictures,
              ElementsAre(LayerView{view_layer, "left"}, LayerView{view_layer, "right"}));
  expect_picture(path, {view_layer, "left"}, left_beauty, left_albedo);
  expect_picture(path, {view_layer, "right"}, right_beauty, right_albedo);
}

TEST(InputViews, NamesOfOpenExrAndOfNukeWithAndWithoutAList) {
  const TemporaryFolder folder;
  TestPart openexr =
      part_of({{"", left_beauty}, {"albedo", left_albedo}, {"right", right_beauty}, {"albedo.right", right_albedo}});
  TestPart nuke =
      part_of({{"", left_beauty}, {"albedo", left_albedo}, {"right", right_beauty}, {"right.albedo", right_albedo}});
  TestPart both_named = part_of(
      {{"left", left_beauty}, {"left.albedo", left_albedo}, {"right", right_beauty}, {"right.albedo", right_albedo}});
  for (TestPart part : {openexr, nuke, both_named}) {
    expect_eyes(write_exr(folder / "without.exr", {part}));
    set_views(part);
    expect_eyes(write_exr(folder / "with.exr", {part}));
  }
}

TEST(InputViews, TheNoisyLayersThatAreKeptStayInTheirViews) {
  const TemporaryFolder folder;
  for (const std::string right : {"right", "Combined.right", "V.Combined.right", "right.beauty"}) {
    TestPart part = part_of({{"", left_beauty}, {right, right_beauty}});
    set_views(part);
    ReadOptions options;
    options.view = "right";
    const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}), options);
    WriteOptions keep;
    keep.keep_noisy = true;
    write_result(read.source, {{read.frame.beauty.name, Image(8, 6, 3, Real(7)), false, {0, 0, 8, 6}}},
                 folder / "out.exr", keep);
    const Frame again = read_frame(folder / "out.exr", options).frame;
    EXPECT_TRUE(holds_colors(again.beauty.mean, right_beauty)) << right;
    ASSERT_EQ(again.prior.mean.channels(), 3) << right;
    EXPECT_EQ(again.prior.mean.at(0, 0, 0), 7) << right;
    options.view = "left";
    EXPECT_TRUE(holds_colors(read_frame(folder / "out.exr", options).frame.beauty.mean, left_beauty)) << right;
  }
}

TEST(InputViews, BlenderPutsTheViewBehindThePass) {
  const TemporaryFolder folder;
  TestPart part = part_of({{"ViewLayer.Combined.left", left_beauty},
                           {"ViewLayer.Denoising Albedo.left", left_albedo},
                           {"ViewLayer.Combined.right", right_beauty},
                           {"ViewLayer.Denoising Albedo.right", right_albedo}});
  set_views(part);
  expect_eyes(write_exr(folder / "a.exr", {part}), "ViewLayer");
}

TEST(InputViews, PartsOfAViewAreNamedInSeveralWays) {
  const TemporaryFolder folder;
  for (const auto& [left, right] : {std::pair("rgba.left", "rgba.right"), std::pair("rgba_left", "rgba_right"),
                                    std::pair("left", "right"), std::pair("right_eye left", "right_eye right")})
    for (const bool listed : {true, false}) {
      const std::string l = listed ? "left" : "", r = listed ? "right" : "";
      expect_eyes(write_exr(folder / "a.exr", {part_of({{"", left_beauty}, {"albedo", left_albedo}}, left, l),
                                               part_of({{"", right_beauty}, {"albedo", right_albedo}}, right, r)}));
    }
}

TEST(InputViews, PartsForEachPassAndView) {
  const TemporaryFolder folder;
  expect_eyes(write_exr(
      folder / "a.exr",
      {part_of({{"", left_beauty}}, "rgba_left", "left"), part_of({{"", right_beauty}}, "rgba_right", "right"),
       part_of({{"", left_albedo}}, "albedo_left", "left"), part_of({{"", right_albedo}}, "albedo_right", "right")}));
}

TEST(InputViews, AFeatureWithoutAViewBelongsToBoth) {
  const TemporaryFolder folder;
  const std::string path = write_exr(
      folder / "a.exr", {part_of({{"", left_beauty}}, "rgba_left", "left"),
                         part_of({{"", right_beauty}}, "rgba_right", "right"), part_of({{"", left_albedo}}, "albedo")});
  expect_picture(path, {"", "left"}, left_beauty, left_albedo);
  expect_picture(path, {"", "right"}, right_beauty, left_albedo);
}

TEST(InputViews, PartsMayCallTheEyesLAndR) {
  const TemporaryFolder folder;
  const std::string path = write_exr(
      folder / "a.exr", {part_of({{"", left_beauty}}, "beauty.L"), part_of({{"", right_beauty}}, "beauty.R"),
                         part_of({{"", left_albedo}}, "albedo.L"), part_of({{"", right_albedo}}, "albedo.R")});
  EXPECT_THAT(read_frame_header(path).source.pictures, ElementsAre(LayerView{"", "L"}, LayerView{"", "R"}));
  expect_picture(path, {"", "L"}, left_beauty, left_albedo);
  expect_picture(path, {"", "R"}, right_beauty, right_albedo);
}

TEST(InputViews, EyesAloneAreViewsWithoutFeaturesOfTheirOwn) {
  const TemporaryFolder folder;
  const std::string path =
      write_exr(folder / "a.exr", {part_of({{"albedo", left_albedo}, {"left", left_beauty}, {"right", right_beauty}})});
  EXPECT_THAT(read_frame_header(path).source.pictures, ElementsAre(LayerView{"", "left"}, LayerView{"", "right"}));
  expect_picture(path, {"", "left"}, left_beauty, left_albedo);
  expect_picture(path, {"", "right"}, right_beauty, left_albedo);
}

TEST(InputViews, ALoneLayerCalledRightIsNoted) {
  const TemporaryFolder folder;
  const std::string path = write_exr(folder / "a.exr", {part_of({{"", left_beauty}, {"right", right_beauty}})});
  const auto notes = [&](const ReadOptions& options) { return read_frame_header(path, options).notes; };
  EXPECT_THAT(notes({}), ElementsAre(HasSubstr("right stays as it is: --aov right")));
  ReadOptions light;
  light.aovs = {"right"};
  EXPECT_THAT(notes(light), ElementsAre());
  ReadOptions eye;
  eye.map = {{Role::Beauty, Companion::Mean, "right", {}}};
  EXPECT_THAT(notes(eye), ElementsAre());
}

TEST(InputViews, ALightCalledRightIsNoView) {
  const TemporaryFolder folder;
  const std::string path =
      write_exr(folder / "a.exr", {part_of({{"", left_beauty}, {"albedo", left_albedo}, {"right", 40}, {"left", 50}})});
  EXPECT_THAT(read_frame_header(path).source.pictures, ElementsAre(LayerView{}));
  expect_picture(path, {}, left_beauty, left_albedo);
}

std::string write_layers(const std::string& path) {
  return write_exr(path, {part_of({{"Back.Ground.Combined", left_beauty},
                                   {"Back.Ground.Denoising Albedo", left_albedo},
                                   {"Fore.Combined", right_beauty},
                                   {"Fore.Denoising Albedo", right_albedo},
                                   {"Fore.Mine", 40}})});
}

TEST(InputViews, EachViewLayerHasItsOwnFeatures) {
  const TemporaryFolder folder;
  const std::string path = write_layers(folder / "a.exr");
  EXPECT_THAT(read_frame_header(path).source.pictures,
              ElementsAre(LayerView{"Back.Ground", ""}, LayerView{"Fore", ""}));
  expect_picture(path, {"Back.Ground", ""}, left_beauty, left_albedo);
  expect_picture(path, {"Fore", ""}, right_beauty, right_albedo);
}

TEST(InputViews, PartsThatHoldAViewLayerEach) {
  const TemporaryFolder folder;
  const std::string path = write_exr(folder / "a.exr", {part_of({{"", left_beauty}, {"albedo", left_albedo}}, "bg"),
                                                        part_of({{"", right_beauty}, {"albedo", right_albedo}}, "fg")});
  expect_picture(path, {"bg", ""}, left_beauty, left_albedo);
  expect_picture(path, {"fg", ""}, right_beauty, right_albedo);
}

TEST(InputViews, AMappedBeautyTakesTheFeaturesOfItsOwnViewLayer) {
  const TemporaryFolder folder;
  const std::string path = write_layers(folder / "a.exr");
  for (const auto& [mapping, seed] :
       {std::pair("beauty=Fore.Combined", int{right_beauty}), std::pair("beauty=Fore.Mine", 40),
        std::pair("beauty=Mine", 40), std::pair("beauty=Fore.Mine.R", -1)}) {
    ReadOptions options;
    options.map = {parse_mapping(mapping)};
    const ReadResult read = read_frame(path, options);
    EXPECT_EQ(read.source.view_layer, "Fore") << mapping;
    EXPECT_EQ(read.source.pictures.size(), 1U) << mapping;
    EXPECT_TRUE(seed < 0 || holds_colors(read.frame.beauty.mean, seed)) << mapping;
    ASSERT_EQ(read.frame.features.size(), 1U) << mapping;
    EXPECT_TRUE(holds_colors(read.frame.features[0].pass.mean, right_albedo)) << mapping;
  }
}

TEST(InputViews, AMappedFeatureStaysInItsViewLayer) {
  const TemporaryFolder folder;
  const std::string path = write_layers(folder / "a.exr");
  ReadOptions options;
  options.map = {parse_mapping("albedo=Mine")};
  options.picture = LayerView{"Fore", ""};
  EXPECT_TRUE(holds_colors(read_frame(path, options).frame.features[0].pass.mean, 40));
  options.picture = LayerView{"Back.Ground", ""};
  const ReadResult back = read_frame(path, options);
  EXPECT_TRUE(holds_colors(back.frame.features[0].pass.mean, left_albedo));
  EXPECT_THAT(back.notes, ElementsAre(HasSubstr("Mine is not used as albedo of view layer Back.Ground")));
}

TEST(InputViews, OptionsSelectAndUnknownOnesAreRefused) {
  const TemporaryFolder folder;
  const std::string path = write_layers(folder / "a.exr");
  ReadOptions options;
  options.view_layer = "Fore";
  EXPECT_THAT(read_frame_header(path, options).source.pictures, ElementsAre(LayerView{"Fore", ""}));
  EXPECT_TRUE(read_frame_header(path, options).notes.empty());
  options.view_layer = "Middle";
  const Error layer = error_of([&] { read_frame_header(path, options); });
  EXPECT_EQ(layer.code(), ExitCode::Missing);
  EXPECT_THAT(layer.what(), HasSubstr("no view layer Middle; there are: Back.Ground, Fore"));
  options = {};
  options.view = "left";
  EXPECT_EQ(error_of([&] { read_frame_header(path, options); }).code(), ExitCode::Missing);
}

TEST(InputViews, SeveralPicturesAndASecondBeautyAreNoted) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_frame_header(write_layers(folder / "a.exr")).notes,
              ElementsAre(HasSubstr("view layer Back.Ground; view layer Fore; --view-layer and --view choose")));
  const std::string two = write_exr(folder / "b.exr", {part_of({{"", left_beauty}, {"beauty", right_beauty}})});
  EXPECT_THAT(read_frame_header(two).notes, ElementsAre(HasSubstr("beauty stays as it is: the beauty is RGBA")));
}

TEST(InputViews, AnEyeWithoutFeaturesNextToOneWithThemIsNoted) {
  const TemporaryFolder folder;
  TestPart part = part_of({{"left", left_beauty}, {"left.albedo", left_albedo}, {"right", right_beauty}});
  set_views(part);
  const std::string path = write_exr(folder / "a.exr", {part});
  ReadOptions options;
  const auto uneven = ::testing::AllOf(HasSubstr("view right is denoised without albedo, which view left has"),
                                       HasSubstr("--view and --map albedo=LAYER"));
  EXPECT_THAT(read_frame_header(path).notes, ::testing::Contains(uneven));
  options.picture = LayerView{{}, "right"};
  EXPECT_THAT(read_frame_header(path, options).notes, ::testing::IsEmpty());
}

/// "right.Z" belongs to no layer of four channels.
TEST(InputViews, ADepthNextToTheColorOfEachEye) {
  const TemporaryFolder folder;
  for (const std::string left : {"", "left"}) {
    TestPart part = part_of({{left, left_beauty}, {"right", right_beauty}});
    add(part.channels, left, "Z", left_albedo);
    add(part.channels, "right", "Z", right_albedo);
    set_views(part);
    const std::string path = write_exr(folder / "a.exr", {part});
    for (const auto& [view, beauty, depth] :
         {std::tuple("left", left_beauty, left_albedo), std::tuple("right", right_beauty, right_albedo)}) {
      ReadOptions options;
      options.picture = LayerView{{}, view};
      const Frame frame = read_frame(path, options).frame;
      EXPECT_TRUE(holds_colors(frame.beauty.mean, beauty)) << left << view;
      ASSERT_EQ(frame.features.size(), 1U) << left << view;
      EXPECT_EQ(frame.features[0].role, Role::Depth);
      EXPECT_EQ(static_cast<double>(frame.features[0].pass.mean.at(1, 2, 0)), testing::pattern(depth)(1, 2));
    }
  }
}

}  // namespace
}  // namespace polyrecon
