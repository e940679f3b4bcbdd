#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

class Denoise : public ProgramTest {
 protected:
  Outcome denoise(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"denoise", "-i", "in.exr", "-o", "out.exr", "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
};

std::vector<std::string> channels_of(const std::string& path) { return load(path).spec().channelnames; }

TEST_F(Denoise, RefusesContradictionsBeforeAnyWork) {
  write_render(path("in.exr"));
  const std::vector<std::vector<std::string>> wrong{
      {"--budget", "4"},
      {"--target", "0.1", "--quality", "draft"},
      {"--time-budget", "2", "--stages", "1"},
      {"--time-budget", "0"},
      {"--steps", "normal,magic"},
      {"--export", "vray"},
      {"--max-samples", "4"},
      {"--sample-map", "s.exr"},
      {"--sample-map", "s.exr", "--budget", "4", "--target", "0.1"},
      {"--sample-map", "s.exr", "--budget", "-4"},
      {"--sample-map", "s.exr", "--budget", "0"},
      {"--sample-map", "s.exr", "--target", "0"},
      {"--sample-map", "s.exr", "--budget", "4", "--max-samples", "3"},
      {"--sample-map", "s.exr", "--budget", "4", "--export", "arnold"},
      {"--sample-map", "s.exr", "--budget", "many"},
      {"--sample-map", "out.exr", "--budget", "4"},
      {"--error-map", "out.exr"},
      {"--error-map", "./out.exr"},
      {"--error-map", "in.exr"},
      {"--error-map", "e.exr", "--order-map", "e.exr"},
      {"--report", "out.exr"},
      {"--quality", "perfect"},
      {"--stages", "0"},
      {"--stages", "5"},
      {"--order", "5"},
      {"--order", "-1"},
      {"--variance-kind", "median"},
      {"--samples", "0"},
      {"--threads", "-1"},
      {"--max-memory", "lots"},
      {"--progress", "loud"},
      {"--map", "albedo"},
      {"--map", "colour=ViewLayer.Combined"},
      {"-i", "in.exr"},
  };
  for (const auto& more : wrong) {
    const Outcome o = denoise(more);
    EXPECT_EQ(o.code, 2) << more[0] << " " << more[1] << ": " << o.err;
    EXPECT_TRUE(is_one_error_line(o.err));
  }
  EXPECT_THAT(files(), ElementsAre("in.exr"));
}

TEST_F(Denoise, RefusesToWriteOverItsInput) {
  write_render(path("in.exr"));
  std::filesystem::create_symlink("in.exr", path("link.exr"));
  std::filesystem::create_hard_link(path("in.exr"), path("hard.exr"));
  const std::string before = read_text(path("in.exr"));
  for (const std::string output : {"in.exr", "./in.exr", "link.exr", "hard.exr"}) {
    const Outcome o = run({"denoise", "-i", "in.exr", "-o", output});
    EXPECT_EQ(o.code, 2) << output;
    EXPECT_TRUE(is_one_error_line(o.err));
  }
  EXPECT_EQ(read_text(path("in.exr")), before);
}

TEST_F(Denoise, TriesTheFoldersOfAllOutputsFirst) {
  write_render(path("in.exr"));
  std::ofstream(path("file")) << "no folder";
  for (const auto& [option, output] :
       {std::pair("--error-map", "file/a/map.exr"), std::pair("--order-map", "file/m.exr"),
        std::pair("--report", "file/report.json")}) {
    const Outcome o = denoise({option, output});
    EXPECT_EQ(o.code, 5) << option;
    EXPECT_TRUE(is_one_error_line(o.err));
    EXPECT_FALSE(exists("out.exr"));
  }
  EXPECT_EQ(run({"denoise", "-i", "in.exr", "-o", "."}).code, 2) << "the file of this name in that folder is the input";
}

TEST_F(Denoise, NamesLayersThatAreNotThere) {
  write_render(path("in.exr"));
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--aov", "Glossy Direct"}, {"--map", "albedo=Nothing"}, {"--view-layer", "Other"}}) {
    const Outcome o = denoise(more);
    EXPECT_EQ(o.code, 4) << more[0] << ": " << o.err;
    EXPECT_TRUE(is_one_error_line(o.err));
  }
  EXPECT_FALSE(exists("out.exr"));
}

TEST_F(Denoise, SaysWhenMemoryIsShort) {
  write_render(path("in.exr"));
  const Outcome o = denoise({"--max-memory", "2K"});
  EXPECT_EQ(o.code, 33) << o.err;
  EXPECT_TRUE(is_one_error_line(o.err));
}

TEST_F(Denoise, WritesTheImageAndAllMaps) {
  write_render(path("in.exr"));
  const Outcome o = denoise({"--error-map", "error.exr", "--order-map", "order.exr", "--sample-map", "samples.exr",
                             "--budget", "16", "--samples", "8", "--frame", "7", "--seed", "3"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_TRUE(o.err.empty()) << o.err;  // no terminal: no bar
  EXPECT_THAT(files(), UnorderedElementsAre("in.exr", "out.exr", "error.exr", "order.exr", "samples.exr"));
  EXPECT_EQ(channels_of(path("out.exr")), channels_of(path("in.exr")));
  EXPECT_THAT(channels_of(path("order.exr")), ElementsAre("order.Y"));
  EXPECT_THAT(channels_of(path("samples.exr")), UnorderedElementsAre("samples.Y", "importance.Y"));
  EXPECT_THAT(channels_of(path("error.exr")),
              ::testing::IsSupersetOf({"mse.R", "mse.G", "mse.B", "relmse.Y", "relvariance.Y"}));
  const OIIO::ImageBuf samples = load(path("samples.exr"));
  EXPECT_EQ(samples.spec().get_float_attribute("budget"), 16);
  EXPECT_EQ(samples.spec().get_float_attribute("frame"), 7);
  EXPECT_EQ(samples.spec().get_float_attribute("seed"), 3);
  for (const char* key : {"min", "max", "total"}) EXPECT_NE(samples.spec().find_attribute(key), nullptr) << key;
}

/// As Blender 5 writes a render with its own denoiser switched on: a part for each pass, the number of samples in the
/// metadata.
void write_blender_parts(const std::string& path, int width, int height) {
  const std::vector<std::string> passes{"ViewLayer.Combined", "ViewLayer.Noisy Image"};
  std::vector<OIIO::ImageSpec> specs;
  for (const std::string& pass : passes) {
    OIIO::ImageSpec spec(width, height, 4, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {pass + ".R", pass + ".G", pass + ".B", pass + ".A"};
    spec.attribute("oiio:subimagename", pass);
    spec.attribute("cycles.ViewLayer.samples", "16");
    specs.push_back(spec);
  }
  std::mt19937 random(2);
  std::uniform_real_distribution<float> noise(-0.2f, 0.2f);
  const auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out->open(path, static_cast<int>(specs.size()), specs.data())) << out->geterror();
  for (std::size_t part = 0; part < specs.size(); ++part) {
    if (part > 0) {
      ASSERT_TRUE(out->open(path, specs[part], OIIO::ImageOutput::AppendSubimage));
    }
    std::vector<float> pixels(static_cast<std::size_t>(width * height * 4), 1.0f);
    for (std::size_t i = 0; i < pixels.size(); ++i)
      pixels[i] = (i % 4 == 3 ? 0.9f : 0.5f) + (part == 1 ? noise(random) : 0.0f);
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
  }
  ASSERT_TRUE(out->close());
}

/// All samples of the first part that has the channel.
std::vector<float> samples_of(const std::string& path, const std::string& channel) {
  const auto in = OIIO::ImageInput::open(path);
  if (!in) throw std::runtime_error(path + ": " + OIIO::geterror());
  for (int part = 0; in->seek_subimage(part, 0); ++part) {
    const int c = in->spec().channelindex(channel);
    if (c < 0) continue;
    std::vector<float> samples(static_cast<std::size_t>(in->spec().width) *
                               static_cast<std::size_t>(in->spec().height));
    if (!in->read_image(part, 0, c, c + 1, OIIO::TypeDesc::FLOAT, samples.data()))
      throw std::runtime_error(in->geterror());
    return samples;
  }
  throw std::runtime_error(path + ": no channel " + channel);
}

TEST_F(Denoise, ReplacesThePictureAndKeepsTheNoisyImageBesideIt) {
  write_blender_parts(path("in.exr"), 32, 20);
  const Outcome o = denoise({"--error-map", "error.exr", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(samples_of(path("out.exr"), "ViewLayer.Noisy Image.G"),
            samples_of(path("in.exr"), "ViewLayer.Noisy Image.G"));
  EXPECT_NE(samples_of(path("out.exr"), "ViewLayer.Combined.G"), samples_of(path("in.exr"), "ViewLayer.Combined.G"));
  EXPECT_EQ(samples_of(path("out.exr"), "ViewLayer.Combined.A"), samples_of(path("in.exr"), "ViewLayer.Combined.A"));
  // The metadata's 16 samples per pixel are known to the map.
  EXPECT_EQ(samples_of(path("error.exr"), "samples.Y"), std::vector<float>(32 * 20, 16.0f));
}

TEST_F(Denoise, AlphaGoesIntoTheLayerThatGetsThePictureAndStaysWithinItsRange) {
  write_blender_parts(path("in.exr"), 32, 20);
  const Outcome o = denoise({"--alpha", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(samples_of(path("out.exr"), "ViewLayer.Noisy Image.A"),
            samples_of(path("in.exr"), "ViewLayer.Noisy Image.A"));
  const std::vector<float> alpha = samples_of(path("out.exr"), "ViewLayer.Combined.A"),
                           noisy = samples_of(path("in.exr"), "ViewLayer.Noisy Image.A");
  EXPECT_GT(*std::max_element(noisy.begin(), noisy.end()), 1);
  EXPECT_LE(*std::max_element(alpha.begin(), alpha.end()), 1);
  double error = 0, noise = 0;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    error += std::pow(alpha[i] - 0.9f, 2);
    noise += std::pow(noisy[i] - 0.9f, 2);
  }
  EXPECT_LT(error, 0.5 * noise);
}

TEST_F(Denoise, SaysWhenAlphaCannotBeDenoised) {
  write_render(path("in.exr"));
  const Outcome o = denoise({"--alpha", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, ::testing::HasSubstr("--alpha has no effect"));
}

TEST_F(Denoise, KeepsTheNoisyLayerOnRequest) {
  write_render(path("in.exr"));
  ASSERT_EQ(denoise({"--outputs", "input,noisy", "--quality", "draft"}).code, 0);
  EXPECT_EQ(samples_of(path("out.exr"), "ViewLayer.Combined Noisy.R"),
            samples_of(path("in.exr"), "ViewLayer.Combined.R"));
}

TEST_F(Denoise, FurtherLayersAreDenoisedByName) {
  const std::vector<std::string> channels{"ViewLayer.Combined.R",       "ViewLayer.Combined.G",
                                          "ViewLayer.Combined.B",       "ViewLayer.Diffuse Direct.R",
                                          "ViewLayer.Diffuse Direct.G", "ViewLayer.Diffuse Direct.B"};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(0, 1);
  write_exr(path("in.exr"), 32, 24, channels, [&](int, int, int) { return noise(random); });
  const std::string aov = "ViewLayer.Diffuse Direct.R";
  ASSERT_EQ(denoise({"--quality", "draft"}).code, 0);
  EXPECT_EQ(samples_of(path("out.exr"), aov), samples_of(path("in.exr"), aov));
  for (const std::string option : {"--aov", "-l"}) {
    const Outcome o = denoise({option, "Diffuse Direct", "--quality", "draft"});
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_NE(samples_of(path("out.exr"), aov), samples_of(path("in.exr"), aov));
  }
}

TEST_F(Denoise, TellsRolesThenTheTable) {
  write_render(path("in.exr"));
  const Outcome o = denoise({"-v"});
  ASSERT_EQ(o.code, 0) << o.err;
  const std::size_t beauty = o.out.find("ViewLayer.Combined"), albedo = o.out.find("ViewLayer.Denoising Albedo");
  const std::size_t table = o.out.find("estimated relMSE");
  ASSERT_NE(beauty, std::string::npos);
  ASSERT_NE(table, std::string::npos);
  EXPECT_LT(beauty, albedo);
  EXPECT_LT(albedo, table);
  for (const char* row : {"pixels/s", "peak memory", "windows", "fireflies", "corrections", "energy", "variance"})
    EXPECT_NE(o.out.find(row), std::string::npos) << row;
}

TEST_F(Denoise, QuietPrintsNothing) {
  write_render(path("in.exr"));
  const Outcome o = denoise({"--quiet", "--progress", "json"});
  EXPECT_EQ(o.code, 0);
  EXPECT_TRUE(o.out.empty()) << o.out;
  EXPECT_TRUE(o.err.empty()) << o.err;
}

TEST_F(Denoise, TheReportHasItsDocumentedKeys) {
  write_render(path("in.exr"));
  ASSERT_EQ(denoise({"--report", "report.json", "--quality", "draft"}).code, 0);
  const auto report = nlohmann::json::parse(read_text(path("report.json")));
  for (const char* key : {"polyrecon",
                          "input",
                          "output",
                          "settings",
                          "width",
                          "height",
                          "roles",
                          "variance_source",
                          "decisions",
                          "phases",
                          "seconds",
                          "pixels_per_second",
                          "peak_memory_bytes",
                          "windows",
                          "corrections",
                          "repaired_pixels",
                          "negative_pixels",
                          "fireflies",
                          "energy",
                          "estimated_relmse",
                          "notes"})
    EXPECT_TRUE(report.contains(key)) << key;
  EXPECT_EQ(report["width"], 40);
  EXPECT_EQ(report["height"], 24);
  EXPECT_EQ(report["roles"][0]["role"], "beauty");
  EXPECT_EQ(report["roles"][0]["layer"], "ViewLayer.Combined");
  EXPECT_NE(report["settings"].get<std::string>().find("--quality draft"), std::string::npos);
  for (const char* key : {"read", "reconstruct", "write", "total"}) EXPECT_GE(report["seconds"][key], 0.0) << key;
  for (const char* key : {"constant", "0", "1", "2", "3", "4"})
    EXPECT_TRUE(report["windows"]["per_order"].contains(key)) << key;
  EXPECT_GT(report["peak_memory_bytes"], 1000000);
  EXPECT_EQ(report["energy"]["before"].size(), 3u);
}

TEST_F(Denoise, JsonProgressIsOneObjectPerLine) {
  write_render(path("in.exr"));
  const Outcome o = denoise({"--progress", "json"});
  ASSERT_EQ(o.code, 0);
  std::istringstream lines(o.err);
  std::string line, open_phase;
  int begun = 0;
  while (std::getline(lines, line)) {
    const auto event = nlohmann::json::parse(line);
    for (const char* key : {"event", "phase", "done", "total", "seconds"}) ASSERT_TRUE(event.contains(key)) << line;
    EXPECT_LE(event["done"], event["total"]) << line;
    if (event["event"] == "begin") ++begun, open_phase = event["phase"];
    if (event["event"] == "end") {
      EXPECT_EQ(event["phase"], open_phase);
    }
  }
  EXPECT_GT(begun, 0);
}

TEST_F(Denoise, StopsOnASignalAndLeavesNothing) {
  write_render(path("in.exr"), 480, 360);
  for (const auto& [signal, code] : {std::pair{SIGTERM, 143}, std::pair{SIGINT, 130}}) {
    const pid_t child = start({"denoise", "-i", "in.exr", "-o", "out.exr", "--quality", "best", "--progress", "json"});
    // The first line of progress says that the work has begun.
    for (int wait = 0; wait < 3000 && read_text(path("stderr")).empty(); ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const auto sent = std::chrono::steady_clock::now();
    ::kill(child, signal);
    EXPECT_EQ(finish(child).code, code);
    EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(5));
    EXPECT_THAT(files(), ElementsAre("in.exr"));
    std::filesystem::remove(path("stderr"));
  }
}

}  // namespace
}  // namespace polyrecon::testing
