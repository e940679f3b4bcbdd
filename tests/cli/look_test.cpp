// The commands that look at files: preview, compare, inspect, merge.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

const std::vector<std::string> rgb{"R", "G", "B"};

class Preview : public ProgramTest {
 protected:
  void SetUp() override { write_render(path("in.exr")); }
};

TEST_F(Preview, OneFileIsThePictureItself) {
  const Outcome o = run({"preview", "in.exr", "-o", "out.png"});
  ASSERT_EQ(o.code, 0) << o.err;
  const OIIO::ImageBuf png = load(path("out.png"));
  EXPECT_EQ(png.spec().width, 40);
  EXPECT_EQ(png.spec().height, 24);
  EXPECT_EQ(png.spec().nchannels, 3);
  EXPECT_EQ(read_text(path("out.png")).substr(1, 3), "PNG");
  EXPECT_THAT(files(), UnorderedElementsAre("in.exr", "out.png"));
}

TEST_F(Preview, SeveralFilesStandSideBySide) {
  write_exr(path("map.exr"), 30, 20, {"relmse.Y"}, [](int x, int, int) { return 0.001 * (x + 1); });
  ASSERT_EQ(run({"preview", "in.exr", "in.exr", "map.exr", "-o", "out.png"}).code, 0);
  // Gaps of 8 pixels around and between, 40 + 40 + 30 wide; below the pictures captions and a legend.
  const OIIO::ImageBuf png = load(path("out.png"));
  EXPECT_EQ(png.spec().width, 40 + 40 + 30 + 4 * 8);
  EXPECT_GT(png.spec().height, 24 + 2 * 8);
}

TEST_F(Preview, ARegionIsShownPixelByPixel) {
  write_exr(path("steps.exr"), 6, 4, rgb, [](int x, int y, int) { return 0.01 * (x + 10 * y); });
  ASSERT_EQ(run({"preview", "steps.exr", "-o", "whole.png"}).code, 0);
  ASSERT_EQ(run({"preview", "steps.exr", "-o", "part.png", "--region", "2,1,3,2", "--zoom", "4"}).code, 0);
  const OIIO::ImageBuf whole = load(path("whole.png")), part = load(path("part.png"));
  ASSERT_EQ(part.spec().width, 12);
  ASSERT_EQ(part.spec().height, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 12; ++x)
      EXPECT_EQ(part.getchannel(x, y, 0, 0), whole.getchannel(2 + x / 4, 1 + y / 4, 0, 0)) << x << " " << y;
}

TEST_F(Preview, ARegionOutsideThePictureIsRefused) {
  for (const char* region : {"0,0,41,24", "40,0,1,1", "-1,0,4,4", "0,0,0,4", "39,23,2147483647,1"}) {
    const Outcome o = run({"preview", "in.exr", "-o", "out.png", std::string("--region=") + region});
    EXPECT_EQ(o.code, 2) << region;
    EXPECT_THAT(o.err, HasSubstr(std::string(region) + " is not within the 40 x 24 pixels of in.exr")) << region;
  }
  EXPECT_THAT(files(), UnorderedElementsAre("in.exr"));
}

TEST_F(Preview, FiguresAgainstTheReferenceStandBelowThePictures) {
  const auto height = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"preview", "in.exr", "in.exr", "-o", "out.png", "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(arguments).code, 0);
    return load(path("out.png")).spec().height;
  };
  // A second line of captions is 22 pixels high.
  EXPECT_EQ(height({"--reference", "in.exr"}), height({}));
  write_exr(path("ref.exr"), 40, 24, rgb, [](int x, int y, int) { return 0.01 * (x + y); });
  EXPECT_EQ(height({"--reference", "ref.exr"}), height({}) + 22);
}

TEST_F(Preview, ExposureAndViewChangeThePicture) {
  write_exr(path("grey.exr"), 4, 4, rgb, [](int, int, int) { return 0.18; });
  const auto level = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"preview", "grey.exr", "-o", "grey.png", "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(arguments).code, 0);
    return load(path("grey.png")).getchannel(1, 1, 0, 0);
  };
  // sRGB: 1.055 * 0.18^(1/2.4) - 0.055 = 0.461356; 0.36: 0.634350. Eight bits: half a step of 1/255.
  EXPECT_NEAR(level({}), 0.461356, 0.5 / 255 + 1e-4);
  EXPECT_NEAR(level({"--exposure", "1"}), 0.634350, 0.5 / 255 + 1e-4);
  EXPECT_NEAR(level({"--view", "Filmic"}), 0.46, 0.02);
  EXPECT_GT(level({"--exposure", "-1"}), 0.2);
}

TEST_F(Preview, RefusesWhatItCannotShow) {
  EXPECT_EQ(run({"preview", "in.exr", "-o", "out.png", "--view", "Nothing"}).code, 2);
  EXPECT_EQ(run({"preview", "in.exr", "-o", "out.png", "--layer", "Nothing"}).code, 4);
  EXPECT_EQ(run({"preview", "in.exr", "-o", "in.exr"}).code, 2);
  EXPECT_EQ(run({"preview", "in.exr", "-o", "in.exr/out.png"}).code, 5);
  EXPECT_THAT(files(), ElementsAre("in.exr"));
}

TEST_F(Preview, ShowsAnyLayerByName) {
  for (const std::string layer :
       {"ViewLayer.Denoising Albedo", "ViewLayer.Denoising Depth", "ViewLayer.Combined Variance"}) {
    const Outcome o = run({"preview", "in.exr", "-o", "out.png", "--overwrite", "--layer", layer});
    EXPECT_EQ(o.code, 0) << layer << ": " << o.err;
  }
  EXPECT_EQ(run({"preview", "in.exr", "-o", "out.png", "--overwrite", "--false-colour"}).code, 0);
}

class Compare : public ProgramTest {};

TEST_F(Compare, PrintsTheFiguresWorkedOutByHand) {
  // Reference 1 with variance 0.01 of its mean; the image is 1.2 in the left half of a 2000 x 1 line and 1 elsewhere.
  // Left: (0.04 - 0.01) / 1.01 = 0.0297030; right: -0.01 / 1.01 = -0.0099010; mean 0.0099010.
  // Trimmed leaves out the 2 worst of 2000: (998 * 0.0297030 - 1000 * 0.0099010) / 1998 = 0.0098812.
  // Energy: 1.1 / 1 - 1 = 0.1.
  write_exr(path("a.exr"), 2000, 1, rgb, [](int x, int, int) { return x < 1000 ? 1.2 : 1.0; });
  write_exr(
      path("ref.exr"), 2000, 1,
      {"Combined.R", "Combined.G", "Combined.B", "Combined Variance.R", "Combined Variance.G", "Combined Variance.B"},
      [](int, int, int c) { return c < 3 ? 1.0 : 0.01; });
  const Outcome o = run({"compare", "a.exr", "ref.exr", "--json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto result = nlohmann::json::parse(o.out);
  EXPECT_EQ(result["reference"], "ref.exr");
  ASSERT_EQ(result["results"].size(), 1u);
  const auto& row = result["results"][0];
  EXPECT_EQ(row["image"], "a.exr");
  EXPECT_NEAR(row["relMSE"], 0.0099010, 1e-6);
  EXPECT_NEAR(row["trimmed"], 0.0098812, 1e-6);
  EXPECT_NEAR(row["energy"], 0.1, 1e-6);
  EXPECT_EQ(row["bad"], 0);
  EXPECT_GT(row["FLIP"], 0.01);
  EXPECT_LT(row["FLIP"], 0.5);
  const Outcome text = run({"compare", "a.exr", "a.exr", "ref.exr"});
  ASSERT_EQ(text.code, 0);
  EXPECT_NE(text.out.find("relMSE 0.00990  trimmed 0.00988  energy +0.10000  FLIP 0."), std::string::npos) << text.out;
}

TEST_F(Compare, TheReferencesNoiseIsTakenOffWhateverItsVarianceLayerHolds) {
  // Reference 1 of 4 samples, with variance 0.01 of its mean: 0.04 of one sample, mean square 1 + 3 * 0.01.
  const auto reference = [&](const std::string& beauty, const std::string& companion, double value, bool counted) {
    std::vector<std::string> channels;
    for (const std::string& name : {beauty, companion})
      for (const char* letter : {".R", ".G", ".B"}) channels.push_back(name + letter);
    if (counted) channels.emplace_back("sampleCount.Y");
    write_exr(path("ref.exr"), 2, 1, channels, [&](int, int, int c) { return c < 3 ? 1.0 : c < 6 ? value : 4.0; });
    return run({"compare", "a.exr", "ref.exr", "--json"});
  };
  write_exr(path("a.exr"), 2, 1, rgb, [](int x, int, int) { return x < 1 ? 1.2 : 1.0; });
  const auto figures = [](const Outcome& o) { return nlohmann::json::parse(o.out); };
  const auto of_mean = figures(reference("Ci", "Ci_mse", 0.01, true));
  EXPECT_NEAR(of_mean["results"][0]["relMSE"], 0.0099010, 1e-6);
  EXPECT_TRUE(of_mean["notes"].empty());
  EXPECT_NEAR(figures(reference("Ci", "Ci_var", 0.04, true))["results"][0]["relMSE"], 0.0099010, 1e-6);
  EXPECT_NEAR(figures(reference("RGB", "m2_RGB", 1.03, true))["results"][0]["relMSE"], 0.0099010, 1e-6);
  const auto unknown = figures(reference("Ci", "Ci_var", 0.04, false));
  EXPECT_NEAR(unknown["results"][0]["relMSE"], 0.02 / 1.01, 1e-6);  // with the reference's noise
  ASSERT_EQ(unknown["notes"].size(), 1u);
  EXPECT_EQ(
      unknown["notes"][0],
      "ref.exr: Ci_var is not used: it is the variance of one sample and the file does not say how many samples a "
      "pixel has; the noise of Ci counts as error");
}

TEST_F(Compare, CountsBadPixels) {
  write_exr(path("a.exr"), 4, 4, rgb,
            [](int x, int y, int) { return x == 1 && y == 2 ? std::numeric_limits<double>::quiet_NaN() : 1.0; });
  write_exr(path("ref.exr"), 4, 4, rgb, [](int, int, int) { return 1.0; });
  const auto result = nlohmann::json::parse(run({"compare", "a.exr", "ref.exr", "--json"}).out);
  EXPECT_EQ(result["results"][0]["bad"], 1);
}

TEST_F(Compare, AddsTheOtherColourLayersOfBothFiles) {
  const std::vector<std::string> channels{"ViewLayer.Combined.R",       "ViewLayer.Combined.G",
                                          "ViewLayer.Combined.B",       "ViewLayer.Diffuse Direct.R",
                                          "ViewLayer.Diffuse Direct.G", "ViewLayer.Diffuse Direct.B"};
  write_exr(path("a.exr"), 4, 4, channels, [](int, int, int c) { return c < 3 ? 1.0 : 1.5; });
  write_exr(path("ref.exr"), 4, 4, channels, [](int, int, int) { return 1.0; });
  const auto result = nlohmann::json::parse(run({"compare", "a.exr", "ref.exr", "--json"}).out);
  ASSERT_EQ(result["results"].size(), 2u);
  EXPECT_EQ(result["results"][0]["layer"], "ViewLayer.Combined");
  EXPECT_EQ(result["results"][0]["relMSE"], 0);
  EXPECT_EQ(result["results"][1]["layer"], "ViewLayer.Diffuse Direct");
  EXPECT_NEAR(result["results"][1]["relMSE"], 0.25 / 1.01, 1e-6);
}

TEST_F(Compare, GreyIsTakenForThreeEqualColours) {
  write_exr(path("grey.exr"), 4, 4, {"Y"}, [](int, int, int) { return 1.5; });
  write_exr(path("color.exr"), 4, 4, rgb, [](int, int, int) { return 1.5; });
  write_exr(path("ref.exr"), 4, 4, {"Y"}, [](int, int, int) { return 1.0; });
  const Outcome o = run({"compare", "grey.exr", "color.exr", "ref.exr", "--json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto result = nlohmann::json::parse(o.out);
  EXPECT_NEAR(result["results"][0]["relMSE"], 0.25 / 1.01, 1e-6);
  EXPECT_EQ(result["results"][0]["relMSE"], result["results"][1]["relMSE"]);
  EXPECT_EQ(result["results"][0]["FLIP"], result["results"][1]["FLIP"]);
}

TEST_F(Compare, RefusesWhatCannotBeCompared) {
  write_exr(path("a.exr"), 4, 4, rgb, [](int, int, int) { return 1.0; });
  write_exr(path("b.exr"), 5, 4, rgb, [](int, int, int) { return 1.0; });
  write_exr(path("depth.exr"), 4, 4, {"Depth.Z"}, [](int, int, int) { return 1.0; });
  EXPECT_EQ(run({"compare", "a.exr"}).code, 2);
  EXPECT_EQ(run({"compare", "a.exr", "b.exr"}).code, 3);
  EXPECT_EQ(run({"compare", "depth.exr", "a.exr"}).code, 4);
  EXPECT_EQ(run({"compare", "a.exr", "a.exr", "--html", "a.exr"}).code, 2);
  EXPECT_EQ(run({"compare", "a.exr", "a.exr", "--html", "page", "--picture", "page"}).code, 2);
  EXPECT_EQ(run({"compare", "a.exr", "a.exr", "--html", "a.exr/page.html"}).code, 5);
  EXPECT_EQ(run({"compare", "a.exr", "a.exr", "--html", "page.html", "--view", "Nothing"}).code, 2);
  EXPECT_FALSE(exists("page.html"));
}

class Inspect : public ProgramTest {};

TEST_F(Inspect, TellsTheRoleOfEachLayer) {
  write_render(path("in.exr"));
  const Outcome text = run({"inspect", "in.exr"});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("ViewLayer.Denoising Albedo"), std::string::npos);
  const Outcome o = run({"inspect", "in.exr", "--json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto found = nlohmann::json::parse(o.out);
  for (const char* key :
       {"files", "layers", "view_layer", "roles", "missing", "samples", "noise_level", "steps", "notes"})
    EXPECT_TRUE(found.contains(key)) << key;
  EXPECT_EQ(found["files"][0]["parts"][0]["channels"].size(), 16u);
  EXPECT_EQ(found["view_layer"], "ViewLayer");
  EXPECT_EQ(found["roles"][0]["role"], "beauty");
  // Written with variance 0.01 everywhere, radiance 0.1 to 1.2: 0.01 / (mean^2 + 0.01) lies between 0.007 and 0.5.
  EXPECT_GT(found["noise_level"], 0.005);
  EXPECT_LT(found["noise_level"], 0.5);
}

class Merge : public ProgramTest {};

TEST_F(Merge, JoinsRenders) {
  for (int k = 0; k < 4; ++k)
    write_exr(path("part" + std::to_string(k) + ".exr"), 6, 4, rgb, [&](int x, int, int) { return x + 0.1 * k; });
  const Outcome o = run({"merge", "part0.exr", "part1.exr", "part2.exr", "part3.exr", "-o", "merged.exr"});
  ASSERT_EQ(o.code, 0) << o.err;
  const OIIO::ImageBuf merged = load(path("merged.exr"));
  const int r = merged.spec().channelindex("R");
  ASSERT_GE(r, 0);
  EXPECT_NEAR(merged.getchannel(2, 1, 0, r), 2.15, 1e-6);
  EXPECT_NE(o.out.find("4 renders"), std::string::npos) << o.out;
  EXPECT_EQ(run({"merge", "part0.exr", "-o", "one.exr"}).code, 2);
  EXPECT_EQ(run({"merge", "part0.exr", "part1.exr", "-o", "part1.exr"}).code, 2);
}

}  // namespace
}  // namespace polyrecon::testing
