// What people expect of every command: folders that are made, endings that are kept, nothing overwritten, names that
// are suggested, advice, limits that cannot be met.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

class Everyday : public ProgramTest {
 protected:
  void SetUp() override { write_render(path("in.exr")); }

  static std::ptrdiff_t lines_of(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }
};

/// A call of each command that writes a file, and what it writes.
std::vector<std::pair<Words, std::string>> writing_calls(const std::string& folder) {
  return {{{"denoise", "-i", "in.exr", "-o", folder + "clean.exr", "--quality", "draft"}, folder + "clean.exr"},
          {{"denoise", "-i", "in.exr", "-o", folder + "c.exr", "--error-map", folder + "maps/error.exr", "--quality",
            "draft", "--report", folder + "r/report.json"},
           folder + "r/report.json"},
          {{"merge", "in.exr", "two.exr", "-o", folder + "merged.exr"}, folder + "merged.exr"},
          {{"samplemap", "-e", "error.exr", "--budget", "4", "-o", folder + "samples.exr"}, folder + "samples.exr"},
          {{"preview", "in.exr", "-o", folder + "look.png"}, folder + "look.png"},
          {{"compare", "in.exr", "two.exr", "--picture", folder + "compared.jpg"}, folder + "compared.jpg"},
          {{"compare", "in.exr", "two.exr", "--html", folder + "page.html"}, folder + "page.html"},
          {{"sweep", "-i", "in.exr", "--reference", "two.exr", "-o", folder + "sweep.html", "--vary", "quality",
            "--csv", folder + "t/figures.csv"},
           folder + "t/figures.csv"}};
}

TEST_F(Everyday, FoldersAreMadeAndNothingIsOverwritten) {
  write_render(path("two.exr"), 40, 24, 2);
  ASSERT_EQ(run({"denoise", "-i", "in.exr", "-o", "x.exr", "--error-map", "error.exr"}).code, 0);
  for (const auto& [call, written] : writing_calls("new/folders/")) {
    const Outcome made = run(call);
    ASSERT_EQ(made.code, 0) << call[0] << made.err;
    ASSERT_TRUE(exists(written)) << written;
    const std::string bytes = read_text(path(written));
    const Outcome again = run(call);
    EXPECT_EQ(again.code, 2) << call[0];
    EXPECT_TRUE(is_one_error_line(again.err));
    EXPECT_THAT(again.err, HasSubstr("add --overwrite to replace"));
    EXPECT_EQ(read_text(path(written)), bytes);
    Words replacing = call;
    replacing.emplace_back("--overwrite");
    EXPECT_EQ(run(replacing).code, 0) << call[0];
  }
}

TEST_F(Everyday, AFolderThatCannotBeMadeIsNamedBeforeAnyWork) {
  std::ofstream(path("file")) << "no folder";
  const Outcome o = run({"denoise", "-i", "in.exr", "-o", "file/clean.exr"});
  EXPECT_EQ(o.code, 5);
  EXPECT_TRUE(is_one_error_line(o.err));
  EXPECT_TRUE(o.out.empty()) << "it was read before: " << o.out;
  EXPECT_THAT(run({"view", "in.exr", "-o", "/proc/new/page.html"}).err,
              HasSubstr("/proc/new/page.html: its folder cannot be made in /proc"));
}

TEST_F(Everyday, ADryRunMakesNoFolder) {
  ASSERT_EQ(run({"denoise", "-i", "in.exr", "-o", "later/clean.exr", "--dry-run"}).code, 0);
  EXPECT_FALSE(exists("later"));
}

TEST_F(Everyday, AFailedRunLeavesNoFolder) {
  EXPECT_EQ(run({"denoise", "-i", "gone.exr", "-o", "later/clean.exr"}).code, 4);
  EXPECT_FALSE(exists("later"));
}

TEST_F(Everyday, EndingsDecideTheFormatOrAreRefused) {
  for (const char* name : {"c.png", "c.tif", "c", "c.EXRX"}) {
    const Outcome o = run({"denoise", "-i", "in.exr", "-o", name});
    EXPECT_EQ(o.code, 2) << name;
    EXPECT_THAT(o.err, HasSubstr("give it the ending .exr"));
  }
  EXPECT_THAT(run({"merge", "in.exr", "in.exr", "-o", "m.png"}).err, HasSubstr("polyrecon preview makes pictures"));
  EXPECT_EQ(run({"denoise", "-i", "in.exr", "-o", "c.exr", "--report", "r.exr"}).code, 2);
  EXPECT_EQ(run({"preview", "in.exr", "-o", "look.exr"}).code, 2);
  EXPECT_EQ(run({"compare", "in.exr", "in.exr", "--html", "page.png"}).code, 2);
  for (const auto& [name, format] : std::vector<std::pair<std::string, std::string>>{
           {"look.png", "png"}, {"look.JPG", "jpeg"}, {"look.jpeg", "jpeg"}, {"look.tif", "tiff"}}) {
    ASSERT_EQ(run({"preview", "in.exr", "-o", name}).code, 0) << name;
    const auto input = OIIO::ImageInput::open(path(name));
    ASSERT_TRUE(input) << name;
    EXPECT_EQ(input->format_name(), format);
    EXPECT_EQ(input->spec().width, 40);
  }
}

TEST_F(Everyday, MistakesInSequencesAreToldShortly) {
  for (int k = 1; k <= 3; ++k) write_render(path("shot.000" + std::to_string(k) + ".exr"));
  const Words call{"denoise", "-i", "shot.####.exr", "-o", "new/shot.####.exr", "--dry-run"};
  const auto with = [&](const Words& more) {
    Words words = call;
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  const Outcome mistyped = with({"--aov", "Comb1ned"});
  EXPECT_EQ(mistyped.code, 4);
  EXPECT_THAT(mistyped.err, HasSubstr("frame 1: shot.0001.exr: no layer Comb1ned; did you mean "));
  EXPECT_THAT(mistyped.err, HasSubstr("\npolyrecon: frame 2: shot.0002.exr: as frame 1\n"));
  EXPECT_THAT(mistyped.err, HasSubstr("\npolyrecon: 3 of 3 frames are missing or broken: 1-3\n"));
  const Outcome quiet = with({"-q"});
  EXPECT_EQ(quiet.code, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_THAT(with({"--frame", "2"}).err, HasSubstr("--frame requires --sample-map; did you mean --frames?"));
  for (const auto& [input, output, said] : std::vector<std::array<std::string, 3>>{
           {"shot.####.exr", "new",
            "-o new: for a sequence, put #### or %04d into the file's name, or name a folder: new/"},
           {"shot.###.exr", "new/", "no file like shot.000.exr: there is shot.000"},
           {"shot.%03d.exr", "new/", "so write %04d, or check the folder"},
           {"*.exr", "new/", "*.exr: no such file; name a sequence as shot.####.exr, or the folder"}}) {
    const Outcome o = run({"denoise", "-i", input, "-o", output});
    EXPECT_TRUE(is_one_error_line(o.err)) << o.err;
    EXPECT_THAT(o.err, HasSubstr(said));
  }
}

TEST_F(Everyday, AMistypedOptionIsNamedThoughAnotherOneIsMissing) {
  for (const auto& [words, said] : std::vector<std::pair<Words, std::string>>{
           {{"denoise", "--inptu", "in.exr", "-o", "c.exr"}, "--inptu is no option of denoise; did you mean --input?"},
           {{"merge", "--verson"}, "--verson is no option of merge; did you mean --version?"},
           {{"denoise", "-o", "c.exr"}, "--input is required"},
           {{"hlep"}, "'hlep' is no command; did you mean help?"},
           {{"view", "in.exr", "-o", "v.html", "--layer", "Comb1ned"},
            "has none of the layers 'Comb1ned'; did you mean"},
           {{"--check-options", "denoise", "-i", "a.####.exr", "-o", "c.####.png"}, "give it the ending .exr"}}) {
    const Outcome o = run(words);
    EXPECT_NE(o.code, 0);
    EXPECT_TRUE(is_one_error_line(o.err)) << o.err;
    EXPECT_THAT(o.err, HasSubstr(said));
  }
  EXPECT_EQ(run({"-i", "in.exr", "-o", "c.exr", "--quality", "draft"}).code, 0) << "without the word denoise";
}

TEST_F(Everyday, WhatIsNoRenderIsToldWhatToDo) {
  for (const auto& [name, said] : {std::pair("scene.blend", "; polyrecon-blender renders the scene and denoises it\n"),
                                   std::pair("look.PNG", "; save the render as OpenEXR, which keeps its passes")}) {
    std::ofstream(path(name)) << "BLENDER-v304";
    for (const char* command : {"denoise", "inspect", "preview"}) {
      Words words{command, name};
      if (std::string(command) == "preview") words.insert(words.end(), {"-o", "new.jpg"});
      const Outcome o = run(words);
      EXPECT_EQ(o.code, 3);
      EXPECT_THAT(o.err, HasSubstr(std::string(name) + ": not an OpenEXR file" + said));
    }
  }
}

TEST_F(Everyday, AFileAloneIsDenoisedBesideIt) {
  const Outcome o = run({"in.exr", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_TRUE(exists("in_denoised.exr"));
  EXPECT_EQ(run({"in.exr"}).code, 2) << "never over anything";
  EXPECT_EQ(run({"gone.exr"}).code, 4);
}

TEST_F(Everyday, AFolderAloneIsDenoisedAfterItIsShown) {
  std::filesystem::create_directory(path("renders"));
  for (const char* name : {"shot.0001.exr", "shot.0002.exr", "shot.0004.exr", "still.exr"})
    write_render(path(std::string("renders/") + name));
  ASSERT_EQ(run({"denoise", "-i", "in.exr", "-o", "old.exr", "--error-map", "renders/error.exr"}).code, 0);
  const Outcome o = run({"renders", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("shot.####.exr, 3 frames 1,2,4 -> renders/shot_denoised.0001.exr"));
  EXPECT_THAT(o.out, HasSubstr("left out: error.exr, an error map"));
  for (const char* name : {"shot_denoised.0001.exr", "shot_denoised.0004.exr", "still_denoised.exr"})
    EXPECT_TRUE(exists(std::string("renders/") + name)) << name;
  EXPECT_FALSE(exists("renders/error_denoised.exr"));
  EXPECT_EQ(run({"renders"}).code, 2) << "its results exist, and are no renders themselves";
  const Outcome elsewhere = run({"denoise", "-i", "renders", "-o", "clean", "--quality", "draft"});
  ASSERT_EQ(elsewhere.code, 0) << elsewhere.err;
  EXPECT_TRUE(exists("clean/shot.0004.exr"));
  EXPECT_TRUE(exists("clean/still.exr"));
  EXPECT_FALSE(exists("clean/still_denoised.exr"));
  std::filesystem::create_directory(path("empty"));
  EXPECT_EQ(run({"empty"}).code, 4);
}

TEST_F(Everyday, AFrameEndsInThreeLines) {
  const Outcome o = run({"denoise", "-i", "in.exr", "-o", "out.exr", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(lines_of(o.out), 3) << o.out;
  EXPECT_THAT(o.out, HasSubstr("in.exr: 40 x 24, ViewLayer.Combined with albedo, depth, variance, halves"));
  EXPECT_THAT(o.out, HasSubstr("out.exr: estimated relMSE "));
  EXPECT_THAT(o.out, HasSubstr("no normal"));
  const Outcome all = run({"denoise", "-i", "in.exr", "-o", "all.exr", "-v"});
  EXPECT_GT(lines_of(all.out), 20);
  EXPECT_THAT(all.out, HasSubstr("peak memory"));
  const Outcome quiet = run({"denoise", "-i", "in.exr", "-o", "quiet.exr", "-q"});
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_EQ(run({"denoise", "-i", "in.exr", "-o", "both.exr", "-q", "-v"}).code, 2);
}

TEST_F(Everyday, AdviceIsWordedForTheRenderer) {
  const auto grey = [](int, int, int) { return 0.5; };
  write_exr(path("blender.exr"), 24, 16,
            {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B", "ViewLayer.Vector.X",
             "ViewLayer.Vector.Y", "ViewLayer.Vector.Z", "ViewLayer.Vector.W"},
            grey);
  const Outcome text = run({"inspect", "blender.exr"});
  EXPECT_THAT(text.out,
              HasSubstr("\nbetter: no albedo, normal, depth: textures blur, edges soften, outlines run together "
                        "(Blender: View Layer > Passes > Data > Denoising Data)\n"));
  EXPECT_THAT(text.out, HasSubstr("\nbetter: no variance: the noise is estimated from the picture (Blender: "));
  const auto json = nlohmann::json::parse(run({"inspect", "blender.exr", "--json"}).out)["advice"];
  ASSERT_EQ(json.size(), 4U) << json;
  EXPECT_EQ(json[0]["pass"], "albedo");
  EXPECT_EQ(json[0]["how"], "Blender: View Layer > Passes > Data > Denoising Data");
  EXPECT_EQ(json[3]["pass"], "variance");
  const Outcome done = run({"denoise", "-i", "blender.exr", "-o", "out.exr", "--report", "r.json"});
  ASSERT_EQ(done.code, 0) << done.err;
  std::istringstream lines(done.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 150U) << line;
  EXPECT_EQ(nlohmann::json::parse(read_text(path("r.json")))["advice"], json);

  // Blender's OpenEXR that is no MultiLayer: one layer, and attributes that name the view layer.
  OIIO::ImageSpec spec(24, 16, 4, OIIO::TypeDesc::HALF);
  spec.attribute("cycles.1 RenderLayer.samples", "24");
  const std::vector<float> values(24 * 16 * 4, 0.5F);
  const auto file = OIIO::ImageOutput::create(path("one.exr"));
  ASSERT_TRUE(file->open(path("one.exr"), spec) && file->write_image(OIIO::TypeDesc::FLOAT, values.data()) &&
              file->close());
  const std::string one = run({"inspect", "one.exr"}).out;
  EXPECT_THAT(one, HasSubstr("samples per pixel: 24\n"));
  EXPECT_THAT(one, HasSubstr("(Blender: OpenEXR MultiLayer, View Layer > Passes > Data > Denoising Data)"));

  write_exr(path("plain.exr"), 24, 16, {"R", "G", "B"}, grey);
  EXPECT_THAT(
      run({"inspect", "plain.exr"}).out,
      HasSubstr("no albedo, normal, depth: textures blur, edges soften, outlines run together (render such passes)"));
}

TEST_F(Everyday, LayersThatDoNotAddUpAreSaid) {
  std::vector<std::string> channels;
  for (const char* layer : {"Combined", "Diffuse Direct", "Glossy Color", "Combined_lamp"})
    for (const char* letter : {"R", "G", "B"}) channels.push_back(std::string("ViewLayer.") + layer + "." + letter);
  write_exr(path("light.exr"), 24, 16, channels, [](int x, int y, int c) { return 0.1 * ((x * 7 + y * 3 + c) % 5); });
  EXPECT_THAT(run({"inspect", "light.exr"}).out, HasSubstr("2 light AOVs stay noisy (--aov all)"));
  const Outcome all = run({"denoise", "light.exr", "-o", "all.exr", "--aov", "all", "--report", "r.json"});
  ASSERT_EQ(all.code, 0) << all.err;
  const std::string note = "ViewLayer.Diffuse Direct is light without the colour of the surfaces";
  EXPECT_THAT(all.out, HasSubstr(note));
  const auto report = nlohmann::json::parse(read_text(path("r.json")));
  EXPECT_THAT(report["notes"].dump(), HasSubstr(note));
  EXPECT_THAT(report["roles"].dump(), Not(HasSubstr("Glossy Color")));
  const Outcome lamp = run({"denoise", "light.exr", "-o", "lamp.exr", "--aov", "Combined_lamp"});
  EXPECT_THAT(lamp.out, Not(HasSubstr("without the colour")));
}

TEST_F(Everyday, FewSamplesAreAdvisedToTakeAPrior) {
  std::ofstream(path("libOpenImageDenoise.so.2")) << "it is not loaded";
  ::setenv("POLYRECON_OIDN", path("").c_str(), 1);
  const Words call{"denoise", "in.exr", "--overwrite", "--quality", "draft", "--samples"};  // -i may be left out
  for (const auto& [samples, few] : {std::pair("16", true), std::pair("64", true), std::pair("65", false)}) {
    Words words = call;
    words.emplace_back(samples);
    const Outcome o = run(words);
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(o.out.find(std::string(samples) + " samples per pixel are few (--prior oidn)") != std::string::npos, few);
  }
  std::filesystem::remove(path("libOpenImageDenoise.so.2"));
  EXPECT_THAT(run({"denoise", "in.exr", "--overwrite", "--quality", "draft", "--samples", "16"}).out,
              HasSubstr("16 samples per pixel are few (--prior oidn, after pip install pyoidn)"));
  ::unsetenv("POLYRECON_OIDN");
}

TEST_F(Everyday, ANoteStandsOnceInASequence) {
  const auto pixels = [](int x, int y, int) { return 0.1 * ((x * 7 + y * 3) % 5); };
  for (int k = 1; k <= 3; ++k)
    write_exr(path("shot." + std::to_string(k) + ".exr"), 24 + k, 16, {"R", "G", "B"}, pixels);
  const Outcome o = run({"denoise", "-i", "shot.#.exr", "-o", "out.#.exr", "--quality", "draft"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("26 x 16 pixels, frame 1 has 25 x 16"));
  EXPECT_THAT(o.out, Not(HasSubstr("27 x 16 pixels, frame 1")));
  const Outcome all = run({"denoise", "-i", "shot.#.exr", "-o", "all.#.exr", "--quality", "draft", "-v"});
  EXPECT_THAT(all.out, HasSubstr("27 x 16 pixels, frame 1 has 25 x 16"));
  const Outcome again = run({"denoise", "-i", "shot.#.exr", "-o", "out.#.exr"});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("--overwrite to replace them, or --skip-existing to do what is still missing"));
}

TEST_F(Everyday, ContentsAndCompressionOfTheResult) {
  const auto layers = [&](const Words& more) {
    Words words{"denoise", "-i", "in.exr", "-o", "out.exr", "--overwrite", "--quality", "draft"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome o = run(words);
    EXPECT_EQ(o.code, 0) << o.err;
    return run({"inspect", "out.exr"}).out;
  };
  const std::string whole = layers({}), lean = layers({"--outputs", "layers"});
  EXPECT_THAT(whole, HasSubstr("Combined Variance"));
  EXPECT_THAT(lean, Not(HasSubstr("Combined Variance")));
  EXPECT_THAT(lean, HasSubstr("Denoising Albedo"));
  const std::string least = layers({"--outputs", "beauty,error,order", "--compression", "dwaa", "--dwa-level", "60"});
  EXPECT_THAT(least, Not(HasSubstr("Denoising Albedo")));
  EXPECT_THAT(least, HasSubstr("Combined Error"));
  EXPECT_THAT(least, HasSubstr("Combined Order"));
  EXPECT_THAT(least, HasSubstr("scanline dwaa"));
  for (const auto& [words, said] : std::vector<std::pair<Words, std::string>>{
           {{"--outputs", "beuty"}, "did you mean beauty?"},
           {{"--outputs", "error"}, "--outputs input,error"},
           {{"--compression", "dwab,"}, "did you mean dwab?"},
           {{"--dwa-level", "60"}, "--dwa-level needs --compression dwaa or dwab"}}) {
    Words call{"denoise", "-i", "in.exr", "-o", "new.exr"};
    call.insert(call.end(), words.begin(), words.end());
    const Outcome o = run(call);
    EXPECT_EQ(o.code, 2);
    EXPECT_THAT(o.err, HasSubstr(said));
  }
  EXPECT_FALSE(exists("new.exr"));
}

TEST_F(Everyday, AMissedTargetIsSaidAndHasACodeOnRequest) {
  const Words call{"denoise", "-i", "in.exr", "--target", "1e-9", "-q"};
  Words keep = call, fail = call;
  keep.insert(keep.end(), {"-o", "keep.exr", "--report", "keep.json"});
  fail.insert(fail.end(), {"-o", "fail.exr", "--on-miss", "fail"});
  const Outcome kept = run(keep), failed = run(fail);
  EXPECT_EQ(kept.code, 0);
  EXPECT_EQ(failed.code, 8);
  EXPECT_TRUE(exists("keep.exr"));
  EXPECT_TRUE(exists("fail.exr"));
  for (const Outcome& o : {kept, failed}) {
    EXPECT_TRUE(is_one_error_line(o.err));
    EXPECT_THAT(o.err, HasSubstr("so --target 1e-09 was missed"));
  }
  EXPECT_EQ(nlohmann::json::parse(read_text(path("keep.json")))["missed"].size(), 1U);
  const Outcome slow =
      run({"denoise", "-i", "in.exr", "-o", "slow.exr", "--time-budget", "0.0001", "--on-miss", "fail"});
  EXPECT_EQ(slow.code, 8);
  EXPECT_THAT(slow.err, HasSubstr("so --time-budget 0.0001 was missed"));
  EXPECT_EQ(run({"denoise", "-i", "in.exr", "-o", "met.exr", "--target", "10", "--on-miss", "fail"}).code, 0);
}

TEST_F(Everyday, NearestNamesAreSuggested) {
  EXPECT_THAT(run({"denoize", "-i", "in.exr"}).err, HasSubstr("did you mean denoise?"));
  EXPECT_THAT(run({"denoise", "-i", "in.exr", "--qualty", "best"}).err, HasSubstr("did you mean --quality?"));
  EXPECT_THAT(run({"denoise", "-i", "in.exr", "--quality", "bset"}).err, HasSubstr("did you mean best?"));
  EXPECT_THAT(run({"denoise", "-i", "in.exr", "--steps", "albdo"}).err, HasSubstr("did you mean albedo?"));
  EXPECT_THAT(run({"denoise", "-i", "in.exr", "--aov", "Combned"}).err, HasSubstr("did you mean Combined?"));
  EXPECT_THAT(run({"denoise", "-i", "in.exr", "--zzzz"}).err, Not(HasSubstr("did you mean")));
}

TEST_F(Everyday, HelpIsACommandToo) {
  EXPECT_EQ(run({"help", "merge"}).out, run({"merge", "--help"}).out);
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  EXPECT_EQ(run({"help", "mrge"}).code, 2);
  EXPECT_EQ(run({"-v"}).out, run({"--version"}).out);
  EXPECT_EQ(run({"denoise", "--version"}).out, run({"--version"}).out);
  EXPECT_THAT(run({"help", "denoise"}).out, HasSubstr("draft|standard|best"));
}

TEST_F(Everyday, OptionsAreCheckedWithoutFiles) {
  const Words good{"--check-options", "denoise", "-i", "no/such.exr", "-o", "no/where.exr", "--quality", "best"};
  const Outcome o = run(good);
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.out + o.err, "");
  for (const Words& wrong : {Words{"--quality", "bset"},
                             {"--nope"},
                             {"--steps", "nothing"},
                             {"--frames", "9-1"},
                             {"--target", "0.1"},
                             {"--map", "x=y"}}) {
    Words call = good;
    call.insert(call.end(), wrong.begin(), wrong.end());
    const Outcome bad = run(call);
    EXPECT_EQ(bad.code, 2) << wrong[0];
    EXPECT_TRUE(is_one_error_line(bad.err));
  }
  EXPECT_EQ(run({"--check-options", "merge", "one.exr", "-o", "m.exr"}).code, 2);
  EXPECT_EQ(run({"--check-options", "merge", "one.exr", "two.exr", "-o", "m.exr"}).code, 0);
}

TEST_F(Everyday, LightAovsAreNamedByListsPatternsAndAll) {
  Words channels;
  for (const char* pass : {"Combined", "Diffuse Direct", "Glossy Direct", "Glossy Indirect"})
    for (const char* c : {"R", "G", "B"}) channels.push_back(std::string("ViewLayer.") + pass + "." + c);
  write_exr(path("aovs.exr"), 40, 24, channels, [](int x, int y, int c) {
    const double noise = ((x * 7 + y * 13 + c * 5) % 11) / 50.0;
    return c < 3 ? 0.6 + 3 * noise : 0.2 + noise;
  });
  const auto denoised = [&](const std::string& aov) {
    Words call{"denoise", "-i", "aovs.exr", "-o", "o.exr", "--overwrite", "--report", "r.json"};
    if (!aov.empty()) call.insert(call.end(), {"--aov", aov});
    const Outcome o = run(call);
    EXPECT_EQ(o.code, 0) << o.err;
    const auto report = nlohmann::json::parse(read_text(path("r.json")));
    int colors = 0;
    for (const auto& role : report["roles"]) colors += role["role"] == "color" ? 1 : 0;
    EXPECT_EQ(o.out.find("light AOVs stay noisy") != std::string::npos, aov.empty()) << o.out;
    return colors;
  };
  EXPECT_EQ(denoised(""), 0);
  EXPECT_EQ(denoised("all"), 3);
  EXPECT_EQ(denoised("Glossy*"), 2);
  EXPECT_EQ(denoised("Diffuse Direct,ViewLayer.Glossy Direct"), 2);
  EXPECT_EQ(run({"denoise", "-i", "aovs.exr", "-o", "no.exr", "--aov", "Volume*"}).code, 4);
  ASSERT_EQ(run({"preview", "aovs.exr", "--layer", "Glossy*", "-o", "look.png"}).code, 0);
  EXPECT_GT(load(path("look.png")).spec().width, 80) << "two pictures side by side";
  EXPECT_EQ(run({"preview", "aovs.exr", "--layer", "Diffuse Direct", "-o", "one.png"}).code, 0);
}

TEST_F(Everyday, UnrelatedPicturesAreNoted) {
  const auto picture = [&](const std::string& name, int dx, int dy) {
    // Without a sample count the variance of a sample cannot be used, which is noted too.
    write_exr(path(name), 160, 96, {"Ci.R", "Ci.G", "Ci.B", "Ci_var.R", "Ci_var.G", "Ci_var.B"},
              [=](int x, int y, int) { return 0.1 + ((dx * (x / 32) + dy * (y / 32)) % 2 == 0 ? 0.8 : 0.0); });
  };
  picture("columns.exr", 1, 0);
  picture("rows.exr", 0, 1);
  EXPECT_THAT(run({"compare", "columns.exr", "rows.exr"}).out,
              AllOf(HasSubstr("have little in common"), HasSubstr("the noise of Ci counts as error")));
  EXPECT_THAT(run({"compare", "columns.exr", "columns.exr"}).out, Not(HasSubstr("have little in common")));
}

}  // namespace
}  // namespace polyrecon::testing
