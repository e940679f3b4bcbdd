// What is easily mistaken: roles given twice or to the wrong layer, pictures in XYZ, results that are merged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using ::testing::HasSubstr;

class Mistakes : public ProgramTest {
 protected:
  void SetUp() override { write_render(path("in.exr")); }

  Outcome denoise(const std::string& in, const std::string& out, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"denoise", "-i", in, "-o", out, "--overwrite", "--quality", "draft"});
    return run(more);
  }
};

TEST_F(Mistakes, ResultsOfAListOfOtherFormatsAreNamedAsExr) {
  const auto grey = [](int, int, int) { return 0.5; };
  write_exr(path("a.tif"), 24, 16, {"R", "G", "B"}, grey);
  write_exr(path("b.tif"), 24, 16, {"R", "G", "B"}, grey);
  std::filesystem::create_directory(path("out"));
  const Outcome o = run({"denoise", "-i", "a.tif", "b.tif", "-o", "out", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_NEAR(load(path("out/a.exr")).getchannel(3, 3, 0, 0), 0.5, 1e-4);
  EXPECT_TRUE(exists("out/b.exr"));
}

TEST_F(Mistakes, OneRoleTakesOneLayer) {
  const std::string albedo = "albedo=ViewLayer.Denoising Albedo";
  const Outcome two = denoise("in.exr", "out.exr", {"--map", albedo, "--map", "albedo=ViewLayer.Combined"});
  EXPECT_EQ(two.code, 2);
  EXPECT_THAT(two.err, HasSubstr("name two layers for one role"));
  EXPECT_EQ(denoise("in.exr", "out.exr", {"--map", albedo, "--map", albedo}).code, 0);
  const Outcome beauty = denoise("in.exr", "no.exr", {"--prior", "ViewLayer.Combined"});
  EXPECT_EQ(beauty.code, 4);
  EXPECT_THAT(beauty.err, HasSubstr("layer ViewLayer.Combined is the beauty and cannot be the prior too"));
  EXPECT_FALSE(exists("no.exr"));
}

TEST_F(Mistakes, AResultThatIsMergedIsNoted) {
  ASSERT_EQ(denoise("in.exr", "clean.exr").code, 0);
  EXPECT_THAT(run({"merge", "in.exr", "clean.exr", "-o", "merged.exr"}).out,
              HasSubstr("clean.exr is a result of denoise"));
}

/// A picture of red, green and grey, as RGB or as CIE XYZ (ITU-R BT.709).
void write_colors(const std::string& path, bool in_xyz) {
  const std::vector<std::string> letters =
      in_xyz ? std::vector<std::string>{"X", "Y", "Z"} : std::vector<std::string>{"R", "G", "B"};
  write_exr(path, 30, 20, letters, [&](int x, int y, int c) {
    const double light = 0.4 + 0.02 * y;
    const double rgb[]{light * (x < 10 ? 0.8 : 0.2), light * (x < 20 ? 0.3 : 0.9), light * 0.25};
    const double to_xyz[3][3]{
        {0.412453, 0.357580, 0.180423}, {0.212671, 0.715160, 0.072169}, {0.019334, 0.119193, 0.950227}};
    return in_xyz ? to_xyz[c][0] * rgb[0] + to_xyz[c][1] * rgb[1] + to_xyz[c][2] * rgb[2] : rgb[c];
  });
}

TEST_F(Mistakes, APictureInXyzIsComparedAndShownAsRgb) {
  write_colors(path("rgb.exr"), false);
  write_colors(path("xyz.exr"), true);
  for (const auto& pair : {std::pair("xyz.exr", "rgb.exr"), std::pair("rgb.exr", "xyz.exr")}) {
    const Outcome o = run({"compare", pair.first, pair.second, "--json"});
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_LT(nlohmann::json::parse(o.out)["results"][0]["relMSE"].get<double>(), 1e-9) << o.out;
  }
  ASSERT_EQ(run({"preview", "rgb.exr", "-o", "rgb.png"}).code, 0);
  ASSERT_EQ(run({"preview", "xyz.exr", "-o", "xyz.png"}).code, 0);
  const OIIO::ImageBuf rgb = load(path("rgb.png")), xyz = load(path("xyz.png"));
  for (int x = 0; x < 30; ++x)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(xyz.getchannel(x, 7, 0, c), rgb.getchannel(x, 7, 0, c), 1.01 / 255) << x << ' ' << c;
}

}  // namespace
}  // namespace polyrecon::testing
