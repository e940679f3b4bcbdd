// Files of several pictures: view layers, stereo views, and layers that are no part of the beauty. Each picture is that
// of a file that holds it alone, to the bit.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <tuple>

#include "cli/program.h"

namespace polyrecon {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;

constexpr int width = 40, height = 24;

/// Uniform noise in [0, 2) from a place and a number.
double noise(int x, int y, int number) {
  std::uint64_t h = static_cast<std::uint64_t>(x + 1) * 0x9E3779B97F4A7C15U +
                    static_cast<std::uint64_t>(y + 1) * 0xC2B2AE3D27D4EB4FU +
                    static_cast<std::uint64_t>(number + 1) * 0x165667B19E3779F9U;
  h = (h ^ h >> 29) * 0xBF58476D1CE4E5B9U;
  h = (h ^ h >> 32) * 0x94D049BB133111EBU;
  return static_cast<double>((h ^ h >> 29) >> 11) / 4503599627370496.0;
}

double albedo(int x, int number) { return (x + number) / 8 % 2 == 0 ? 0.2 : 0.8; }

/// The layers of a render with the name of its eye or view layer.
struct Render {
  std::string beauty, albedo;
  int number;
};

class Pictures : public testing::ProgramTest {
 protected:
  void write(const std::string& name, const std::vector<Render>& renders) const {
    std::vector<std::string> channels;
    for (const Render& render : renders)
      for (const std::string& layer : {render.beauty, render.albedo})
        for (const char* letter : {"R", "G", "B"}) channels.push_back(layer.empty() ? letter : layer + "." + letter);
    testing::write_exr(path(name), width, height, channels, [&](int x, int y, int c) {
      const int number = renders[static_cast<std::size_t>(c / 6)].number;
      const double color = albedo(x, number);
      return c % 6 < 3 ? color * noise(x, y, 10 * number + c % 3) : color;
    });
  }

  Outcome denoise(const std::string& in, const std::string& out, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"denoise", "-i", in, "-o", out, "--overwrite", "--quality", "draft"});
    return run(more);
  }

  std::vector<float> plane(const std::string& name, const std::string& channel) const {
    const OIIO::ImageBuf image = testing::load(path(name));
    const int c = image.spec().channelindex(channel);
    std::vector<float> values;
    for (int y = 0; y < image.spec().height; ++y)
      for (int x = 0; x < image.spec().width; ++x) values.push_back(image.getchannel(x, y, 0, c));
    return values;
  }

  nlohmann::json report(const std::string& name) const { return nlohmann::json::parse(testing::read_text(path(name))); }
};

const Render bare{"", "albedo", 1};
const Render eye{"right", "right.albedo", 2};
const Render eye_moved{"", "albedo", 2};  // the same picture in a file of its own

TEST_F(Pictures, BothEyesAreWhatEachIsAlone) {
  write("both.exr", {bare, eye});
  write("left.exr", {bare});
  write("right.exr", {eye_moved});
  const Outcome o = denoise("both.exr", "both_out.exr", {"--report", "r.json", "--error-map", "e.exr"});
  ASSERT_EQ(o.code, 0) << o.err;
  ASSERT_EQ(denoise("left.exr", "left_out.exr", {"--error-map", "le.exr"}).code, 0);
  ASSERT_EQ(denoise("right.exr", "right_out.exr", {"--error-map", "re.exr"}).code, 0);
  for (const std::string c : {"R", "G", "B"}) {
    EXPECT_EQ(plane("both_out.exr", c), plane("left_out.exr", c));
    EXPECT_NE(plane("both_out.exr", c), plane("both.exr", c));
    EXPECT_EQ(plane("both_out.exr", "right." + c), plane("right_out.exr", c));
    EXPECT_EQ(plane("both_out.exr", "right.albedo." + c), plane("both.exr", "right.albedo." + c));
  }
  EXPECT_EQ(plane("e.exr", "relmse.Y"), plane("le.exr", "relmse.Y"));
  EXPECT_EQ(plane("e.right.exr", "relmse.Y"), plane("re.exr", "relmse.Y"));
  const nlohmann::json r = report("r.json");
  EXPECT_EQ(r["view"], "left");
  ASSERT_EQ(r["others"].size(), 1U);
  EXPECT_EQ(r["others"][0]["view"], "right");
  EXPECT_EQ(r["others"][0]["roles"][1]["layer"], "right.albedo");
  EXPECT_THAT(o.out, HasSubstr("view left; view right; --view-layer and --view choose"));
  EXPECT_THAT(o.out, HasSubstr("map of view right: e.right.exr"));
  EXPECT_THAT(run({"inspect", "both.exr"}).out, HasSubstr("view left; view right; --view-layer and --view choose"));
}

TEST_F(Pictures, OneEyeLeavesTheOtherAsItIs) {
  write("both.exr", {bare, eye});
  write("right.exr", {eye_moved});
  ASSERT_EQ(denoise("both.exr", "out.exr", {"--view", "right", "--error-map", "e.exr"}).code, 0);
  ASSERT_EQ(denoise("right.exr", "right_out.exr").code, 0);
  EXPECT_EQ(plane("out.exr", "R"), plane("both.exr", "R"));
  EXPECT_EQ(plane("out.exr", "right.R"), plane("right_out.exr", "R"));
  EXPECT_TRUE(exists("e.exr"));
  const Outcome o = denoise("both.exr", "no.exr", {"--view", "middle"});
  EXPECT_EQ(o.code, 4);
  EXPECT_TRUE(testing::is_one_error_line(o.err));
  EXPECT_THAT(o.err, HasSubstr("no view middle; there are: left, right"));
}

TEST_F(Pictures, EveryViewLayerOfASequenceWithItsNeighbours) {
  const auto frame = [](int number, const std::string& layer, int offset) {
    return Render{layer + ".Combined", layer + ".Denoising Albedo", number + offset};
  };
  for (const int n : {1, 2, 3}) {
    const std::string number = std::to_string(n);
    write("all." + number + ".exr", {frame(n, "A", 0), frame(n, "B", 4)});
    write("a." + number + ".exr", {frame(n, "A", 0)});
    write("b." + number + ".exr", {frame(n, "B", 4)});
  }
  for (const std::string name : {"all", "a", "b"}) {
    const Outcome o = denoise(name + ".#.exr", name + "_out.#.exr");
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_THAT(o.out, HasSubstr("3 written, 0 skipped, 0 failed"));
  }
  for (const std::string n : {"1", "2", "3"})
    for (const std::string c : {"R", "G", "B"}) {
      EXPECT_EQ(plane("all_out." + n + ".exr", "A.Combined." + c), plane("a_out." + n + ".exr", "A.Combined." + c));
      EXPECT_EQ(plane("all_out." + n + ".exr", "B.Combined." + c), plane("b_out." + n + ".exr", "B.Combined." + c));
    }
  EXPECT_THAT(denoise("all.#.exr", "all_out.#.exr", {"--skip-existing"}).out, HasSubstr("0 written, 3 skipped"));
}

TEST_F(Pictures, AFrameWithoutAViewLayerOfTheFirstIsNoted) {
  write("s.1.exr", {{"A.Combined", "A.Denoising Albedo", 1}, {"B.Combined", "B.Denoising Albedo", 2}});
  write("s.2.exr", {{"A.Combined", "A.Denoising Albedo", 1}});
  const Outcome o = denoise("s.#.exr", "o.#.exr", {"--frame-radius", "0"});
  EXPECT_EQ(o.code, 0);
  EXPECT_THAT(o.out, HasSubstr("no view layer B, which frame 1 has"));
}

/// A floor on which only `shadow` has samples, two lights that add up to the beauty, and normals and albedo.
class OwnWindows : public Pictures {
 protected:
  static bool is_floor(int y) { return y >= height / 2; }

  /// shadow: the name of that layer.
  void write_scene(const std::string& name, const std::string& shadow = "shadow") const {
    std::vector<std::string> channels;
    for (const std::string& layer : std::vector<std::string>{"", "key.", "fill.", shadow + ".", "albedo."})
      for (const char* letter : {"R", "G", "B"}) channels.push_back(layer + letter);
    testing::write_exr(path(name), width, height, channels, [](int x, int y, int c) {
      const double color = albedo(x, 0);
      const double lit = is_floor(y) ? 0 : color;
      const double key = lit * static_cast<double>(static_cast<float>(noise(x, y, 1)));
      const double fill = lit * static_cast<double>(static_cast<float>(noise(x, y, 2)));
      const double values[]{key + fill, key, fill, is_floor(y) ? 0.5 * noise(x, y, 3) : 0, color};
      return values[c / 3];
    });
  }

  static double error(const std::vector<float>& plane, bool floor, double truth) {
    double sum = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (is_floor(y) == floor) {
          const double e = static_cast<double>(plane[static_cast<std::size_t>(y * width + x)]) - truth;
          sum += e * e;
        }
    return sum / (width * height / 2.0);
  }
};

TEST_F(OwnWindows, ALayerThatIsNoPartOfTheBeautyIsDenoisedByItself) {
  write_scene("in.exr");
  const Outcome o =
      denoise("in.exr", "out.exr", {"--aov", "key", "--aov", "shadow", "--aov", "fill", "--report", "r.json"});
  ASSERT_EQ(o.code, 0) << o.err;
  ASSERT_EQ(denoise("in.exr", "alone.exr", {"--map", "beauty=shadow"}).code, 0);
  EXPECT_EQ(plane("out.exr", "shadow.R"), plane("alone.exr", "shadow.R"));
  EXPECT_LT(error(plane("out.exr", "shadow.R"), true, 0.5), 0.1 * error(plane("in.exr", "shadow.R"), true, 0.5));

  const std::vector<float> beauty = plane("out.exr", "R"), key = plane("out.exr", "key.R"),
                           fill = plane("out.exr", "fill.R");
  for (std::size_t i = 0; i < beauty.size(); ++i) ASSERT_NEAR(key[i] + fill[i], beauty[i], 1e-5) << i;
  EXPECT_NE(key, plane("in.exr", "key.R"));

  const nlohmann::json r = report("r.json");
  EXPECT_THAT(r["notes"], Contains(HasSubstr("shadow gets windows of its own")));
  EXPECT_THAT(r["notes"], Not(Contains(HasSubstr("key gets"))));
  ASSERT_EQ(r["others"].size(), 1U);
  EXPECT_EQ(r["others"][0]["layer"], "shadow");
  EXPECT_THAT(o.out, HasSubstr("note: shadow gets windows of its own"));

  // inspect says it beforehand: of the named layers, else of all lights. A layer `shadow` is a feature unless it is
  // named.
  write_scene("catcher.exr", "catcher");
  for (const auto& [file, layer, named] :
       {std::tuple{"in.exr", "shadow", std::vector<std::string>{"--aov", "key", "--aov", "shadow"}},
        std::tuple{"catcher.exr", "catcher", std::vector<std::string>{}}}) {
    std::vector<std::string> words{"inspect", file};
    words.insert(words.end(), named.begin(), named.end());
    const Outcome before = run(words);
    EXPECT_THAT(before.out, HasSubstr(std::string(layer) + " gets windows of its own"));
    EXPECT_THAT(before.out, Not(HasSubstr("key gets")));
  }
}

/// A beauty that is a crop of the frame, next to an albedo and a light of the whole frame.
class Cropped : public OwnWindows {
 protected:
  static constexpr int left = 6, right = 34;

  void write_cropped(const std::string& name) const {
    std::vector<OIIO::ImageSpec> specs;
    for (const char* part : {"beauty", "albedo", "light"}) {
      OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
      const bool is_beauty = specs.empty();
      spec.x = is_beauty ? left : 0;
      spec.width = is_beauty ? right - left : width;
      spec.full_width = width;
      spec.full_height = height;
      spec.channelnames = {"R", "G", "B"};
      spec.attribute("oiio:subimagename", part);
      specs.push_back(spec);
    }
    const auto out = OIIO::ImageOutput::create(path(name));
    out->open(path(name), static_cast<int>(specs.size()), specs.data());
    for (std::size_t s = 0; s < specs.size(); ++s) {
      if (s > 0) out->open(path(name), specs[s], OIIO::ImageOutput::AppendSubimage);
      std::vector<float> samples;
      for (int y = 0; y < height; ++y)
        for (int x = specs[s].x; x < specs[s].x + specs[s].width; ++x)
          for (int c = 0; c < 3; ++c) {
            const double color = albedo(x, 0);
            samples.push_back(static_cast<float>(s == 1 ? color : color * noise(x, y, c) / (s == 2 ? 2 : 1)));
          }
      out->write_image(OIIO::TypeDesc::FLOAT, samples.data());
    }
    out->close();
  }

  std::vector<float> part(const std::string& name, int subimage) const {
    const auto input = OIIO::ImageInput::open(path(name));
    const OIIO::ImageSpec spec = input->spec(subimage);
    std::vector<float> samples(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) * 3);
    input->read_image(subimage, 0, 0, 3, OIIO::TypeDesc::FLOAT, samples.data());
    return samples;
  }
};

TEST_F(Cropped, ALayerThatReachesBeyondTheBeautyLeavesItAsItIs) {
  write_cropped("in.exr");
  const Outcome o = denoise("in.exr", "with.exr", {"--aov", "light", "--report", "r.json"});
  ASSERT_EQ(o.code, 0) << o.err;
  ASSERT_EQ(denoise("in.exr", "without.exr").code, 0);
  ASSERT_EQ(denoise("in.exr", "alone.exr", {"--map", "beauty=light"}).code, 0);
  EXPECT_EQ(part("with.exr", 0), part("without.exr", 0));
  EXPECT_EQ(part("with.exr", 2), part("alone.exr", 2));
  EXPECT_NE(part("with.exr", 0), part("in.exr", 0));
  EXPECT_NE(part("with.exr", 2), part("in.exr", 2));
  EXPECT_THAT(report("r.json")["notes"], Contains(HasSubstr("light gets windows of its own")));
  EXPECT_THAT(run({"inspect", "in.exr", "--aov", "light"}).out, HasSubstr("light gets windows of its own"));
}

TEST_F(OwnWindows, LayersThatAddUpAreTheSameWithAndWithoutIt) {
  write_scene("in.exr");
  ASSERT_EQ(denoise("in.exr", "with.exr", {"--aov", "key", "--aov", "shadow"}).code, 0);
  ASSERT_EQ(denoise("in.exr", "without.exr", {"--aov", "key"}).code, 0);
  EXPECT_EQ(plane("with.exr", "R"), plane("without.exr", "R"));
  EXPECT_EQ(plane("with.exr", "key.R"), plane("without.exr", "key.R"));
}

}  // namespace
}  // namespace polyrecon
