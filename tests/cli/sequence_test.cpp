#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.h"

namespace polyrecon::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

constexpr int width = 24, height = 16;

class Sequence : public ProgramTest {
 protected:
  Sequence() { std::filesystem::create_directory(path("out")); }

  void render(const std::string& name, unsigned seed = 1) const { write_render(path(name), width, height, seed); }

  void render_frames(int first, int last) const {
    for (int n = first; n <= last; ++n) render("shot.000" + std::to_string(n) + ".exr", static_cast<unsigned>(n));
  }

  Outcome denoise(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"denoise",           "-i",          "shot.####.exr", "-o",
                                       "out/shot.####.exr", "--overwrite", "--quality",     "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  std::vector<std::string> results() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
      names.push_back(entry.path().filename().string());
    return names;
  }

  auto time_of(const std::string& name) const { return std::filesystem::last_write_time(folder_ / name); }
};

// Hard cases are found by their number.
using Case02Sequence = Sequence;
using Case10Sequence = Sequence;
using Case14Sequence = Sequence;

/// The frames that a dry run names, in order.
std::vector<std::string> planned(const std::string& out) {
  std::vector<std::string> inputs;
  for (std::size_t at = 0; (at = out.find(": shot.", at)) != std::string::npos; ++at)
    inputs.push_back(out.substr(at + 7, out.find(".exr", at) - at - 7));
  return inputs;
}

void cut_last_byte(const std::string& path) {
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1);
}

TEST_F(Sequence, RangesAndPatternsNameFrames) {
  for (const int n : {1, 2, 3, 4, 5, 10, 12345})
    render(n == 12345 ? "shot.12345.exr" : n == 10 ? "shot.0010.exr" : "shot.000" + std::to_string(n) + ".exr");
  using Names = std::vector<std::string>;
  EXPECT_EQ(planned(denoise({"--dry-run"}).out), (Names{"0001", "0002", "0003", "0004", "0005", "0010", "12345"}));
  EXPECT_EQ(planned(denoise({"--dry-run", "--frames", "1-5x2,4,2-4"}).out),
            (Names{"0001", "0003", "0005", "0004", "0002"}));
  EXPECT_EQ(planned(denoise({"--dry-run", "--frames", "10"}).out), (Names{"0010"}));
  EXPECT_EQ(planned(run({"denoise", "-i", "shot.%04d.exr", "-o", "out/%d.exr", "--dry-run", "--frames", "3"}).out),
            (Names{"0003"}));
  EXPECT_TRUE(results().empty());
}

TEST_F(Sequence, RefusesRangesAndNamesThatMakeNoSense) {
  render_frames(1, 2);
  for (const char* frames : {"", "1-", "a", "3-1", "1-3x0", "1,,2", "1-99999999", "99999999999"})
    EXPECT_EQ(denoise({"--frames", frames}).code, 2) << frames;
  EXPECT_EQ(run({"denoise", "-i", "shot.####.exr", "-o", "out/one.exr"}).code, 2);
  EXPECT_EQ(run({"denoise", "-i", "shot.####.exr", "-o", "shot.####.exr"}).code, 2);
  EXPECT_EQ(run({"denoise", "-i", "shot.####.exr", "-o", "out/####.exr", "--error-map", "out/####.exr"}).code, 2);
  EXPECT_EQ(run({"denoise", "-i", "shot.0001.exr", "-o", "out/a.exr", "--frames", "1"}).code, 2);
  EXPECT_EQ(run({"denoise", "-i", "shot.0001.exr", "shot.0002.exr", "-o", "out/a.exr"}).code, 2);
  EXPECT_EQ(run({"denoise", "-i", "shot.0001.exr", "-o", "out/a.exr", "--frame-radius", "1"}).code, 2);
  EXPECT_EQ(denoise({"--frame-radius", "9"}).code, 2);
  EXPECT_EQ(run({"denoise", "-i", "none.####.exr", "-o", "out/####.exr"}).code, 4);
  EXPECT_TRUE(results().empty());
}

TEST_F(Sequence, AFileWhoseNameLooksLikeAPatternIsAFile) {
  render("a#b.exr");
  ASSERT_EQ(run({"denoise", "-i", "a#b.exr", "-o", "out/c#.exr", "--quality", "draft"}).code, 0);
  EXPECT_THAT(results(), UnorderedElementsAre("c#.exr"));
}

TEST_F(Sequence, FramesThatFailAreListedAndTheOthersGoOn) {
  render_frames(1, 5);
  std::filesystem::remove(path("shot.0002.exr"));
  cut_last_byte(path("shot.0004.exr"));
  const Outcome o = denoise({"--frames", "1-5", "--error-map", "out/error.####.exr", "--report", "out/####.json"});
  EXPECT_EQ(o.code, 4) << o.err;
  EXPECT_THAT(results(),
              UnorderedElementsAre("shot.0001.exr", "shot.0003.exr", "shot.0005.exr", "error.0001.exr",
                                   "error.0003.exr", "error.0005.exr", "0001.json", "0003.json", "0005.json"));
  EXPECT_THAT(o.err, HasSubstr("frame 2: shot.0002.exr: no such file\n"));
  EXPECT_THAT(o.err, HasSubstr("frame 4: shot.0004.exr"));
  EXPECT_THAT(o.err, HasSubstr("2 of 5 frames are missing or broken: 2,4\n"));
  EXPECT_THAT(o.out, HasSubstr("3 written, 0 skipped, 2 failed"));
}

TEST_F(Sequence, GapsBetweenFoundFramesAreSaid) {
  render_frames(1, 7);
  for (const char* gap : {"shot.0002.exr", "shot.0005.exr", "shot.0006.exr"}) std::filesystem::remove(path(gap));
  const std::string gaps = "no files of frames 2,5,6\n";
  const Outcome dry = denoise({"--dry-run"});
  EXPECT_EQ(dry.code, 0);
  EXPECT_THAT(dry.out, EndsWith("\n" + gaps));
  const Outcome o = denoise({});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, EndsWith("\n4 written, 0 skipped, 0 failed; " + gaps));
  EXPECT_THAT(denoise({"--frames", "1,3-4,7", "--skip-existing"}).out, EndsWith("0 written, 4 skipped, 0 failed\n"));
  std::filesystem::remove(path("shot.0004.exr"));
  EXPECT_THAT(denoise({"--dry-run", "--skip-existing"}).out, EndsWith("no files of frames 5\n"));  // every second frame
}

TEST_F(Sequence, StrictStopsAtTheFirstFrameThatFails) {
  render_frames(1, 3);
  cut_last_byte(path("shot.0002.exr"));
  const Outcome o = denoise({"--strict"});
  EXPECT_EQ(o.code, 3);
  EXPECT_TRUE(is_one_error_line(o.err)) << o.err;
  EXPECT_THAT(results(), UnorderedElementsAre("shot.0001.exr"));
}

TEST_F(Sequence, AListOfFilesGoesIntoAFolder) {
  render("a.exr");
  render("b7.exr");
  ASSERT_EQ(run({"denoise", "-i", "a.exr", "b7.exr", "-o", "out", "--quality", "draft", "-q"}).code, 0);
  EXPECT_THAT(results(), UnorderedElementsAre("a.exr", "b7.exr"));
  EXPECT_EQ(run({"denoise", "-i", "a.exr", "b7.exr", "-o", "out/####.exr", "--dry-run"}).code, 2);  // a has no number
}

TEST_F(Case14Sequence, SkipsOnlyWhatIsTheSameAndWhole) {
  render_frames(1, 3);
  ASSERT_EQ(denoise({"--frame-radius", "0"}).code, 0);  // a changed neighbour: see below
  const auto first = time_of("out/shot.0001.exr");
  const auto skipped = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--skip-existing", "--frame-radius", "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome o = denoise(arguments);
    EXPECT_EQ(o.code, 0) << o.err;
    const std::size_t at = o.out.rfind(" skipped");
    return at == std::string::npos ? -1 : o.out[at - 1] - '0';
  };
  EXPECT_EQ(skipped({}), 3);
  EXPECT_EQ(time_of("out/shot.0001.exr"), first);
  // A copy of the input under the same name is the same input.
  std::filesystem::copy_file(path("shot.0001.exr"), path("copy.exr"));
  std::filesystem::rename(path("copy.exr"), path("shot.0001.exr"));
  EXPECT_EQ(skipped({}), 3);
  // Another render under the same name, a damaged result, a missing map, other settings.
  write_render(path("shot.0002.exr"), width, height + 1);
  EXPECT_EQ(skipped({}), 2);
  ASSERT_EQ(denoise({"--skip-existing", "--frame-radius", "0", "--frames", "1,3"}).code, 0);
  cut_last_byte(path("out/shot.0003.exr"));
  EXPECT_EQ(skipped({"--frames", "1,3"}), 1);
  EXPECT_EQ(skipped({"--frames", "1,3"}), 2);
  EXPECT_EQ(skipped({"--frames", "1,3", "--error-map", "out/error.####.exr"}), 0);
  EXPECT_EQ(skipped({"--frames", "1,3", "--error-map", "out/error.####.exr"}), 2);
  EXPECT_EQ(skipped({"--frames", "1,3", "--order", "0"}), 0);
}

TEST_F(Case02Sequence, WaitsForARenderThatIsStillBeingWritten) {
  render("whole.exr");
  const std::string bytes = read_text(path("whole.exr"));
  std::ofstream(path("shot.0001.exr"), std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  const pid_t child = start({"denoise", "-i", "shot.####.exr", "-o", "out/shot.####.exr", "--frames", "1-2",
                             "--quality", "draft", "--wait", "30"});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  std::ofstream(path("shot.0001.exr"), std::ios::binary) << bytes;
  std::ofstream(path("new.exr"), std::ios::binary) << bytes;
  std::filesystem::rename(path("new.exr"), path("shot.0002.exr"));
  EXPECT_EQ(finish(child).code, 0) << read_text(path("stderr"));
  EXPECT_THAT(results(), UnorderedElementsAre("shot.0001.exr", "shot.0002.exr"));
}

TEST_F(Sequence, GivesUpWaitingAndStopsOnASignal) {
  EXPECT_EQ(run({"denoise", "-i", "shot.0001.exr", "-o", "out/a.exr", "--wait", "0.2"}).code, 4);
  const pid_t child = start({"denoise", "-i", "shot.0001.exr", "-o", "out/a.exr", "--wait", "60"});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  ::kill(child, SIGTERM);
  EXPECT_EQ(finish(child).code, 143);
}

TEST_F(Case10Sequence, AFrameWithoutAPassIsWorkedAndCounted) {
  render_frames(1, 2);
  write_exr(path("shot.0003.exr"), width + 2, height,
            {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"},
            [](int x, int y, int c) { return 0.5 + 0.01 * ((7 * x + 3 * y + c) % 5); });
  const Outcome o = denoise({"--report", "out/####.json"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("1 without all layers of the first frame: 3"));
  const auto report = nlohmann::json::parse(read_text(path("out/0003.json")));
  EXPECT_THAT(report["notes"].dump(), HasSubstr("no albedo, which frame 1 has"));
  EXPECT_THAT(report["notes"].dump(), HasSubstr("26 x 16 pixels, frame 1 has 24 x 16"));
}

TEST_F(Sequence, NeighboursInTimeJoinWhateverElseIsAskedFor) {
  render_frames(1, 4);
  ASSERT_EQ(denoise({"--frame-radius", "0"}).code, 0);
  const std::string alone = read_text(path("out/shot.0002.exr"));
  const Outcome all = denoise({"--frame-radius", "1", "--report", "out/####.json"});
  ASSERT_EQ(all.code, 0) << all.err;
  const std::string joined = read_text(path("out/shot.0002.exr"));
  EXPECT_NE(joined, alone);
  const auto neighbours = [&](const char* name) {
    return nlohmann::json::parse(read_text(path(name)))["neighbours"]["frames"].get<int>();
  };
  EXPECT_EQ(neighbours("out/0001.json"), 1);
  EXPECT_EQ(neighbours("out/0002.json"), 2);
  EXPECT_EQ(neighbours("out/0004.json"), 1);
  // One frame of them, as a farm would work it, comes to the same file.
  std::filesystem::remove(path("out/shot.0002.exr"));
  ASSERT_EQ(denoise({"--frame-radius", "1", "--frames", "2"}).code, 0);
  EXPECT_EQ(read_text(path("out/shot.0002.exr")), joined);
}

TEST_F(Sequence, TwoNeighboursOnEachSideJoinUnlessAFileIsOnItsOwn) {
  render_frames(1, 4);
  ASSERT_EQ(denoise({}).code, 0);
  const std::string joined = read_text(path("out/shot.0002.exr"));
  ASSERT_EQ(denoise({"--frame-radius", "2", "--frames", "2"}).code, 0);
  EXPECT_EQ(read_text(path("out/shot.0002.exr")), joined);
  ASSERT_EQ(denoise({"--frame-radius", "0", "--frames", "2"}).code, 0);
  const std::string alone = read_text(path("out/shot.0002.exr"));
  EXPECT_NE(alone, joined);
  ASSERT_EQ(
      run({"denoise", "-i", "shot.0002.exr", "-o", "out/shot.0002.exr", "--overwrite", "--quality", "draft"}).code, 0);
  EXPECT_EQ(read_text(path("out/shot.0002.exr")), alone);
}

TEST_F(Sequence, FramesOfOneSeedBringNothingAndANoteSaysSo) {
  for (const char* name : {"shot.0001.exr", "shot.0002.exr", "shot.0003.exr"}) render(name);
  ASSERT_EQ(denoise({"--frame-radius", "0", "--frames", "2"}).code, 0);
  const OIIO::ImageBuf alone = load(path("out/shot.0002.exr"));
  const Outcome o = denoise({"--report", "out/####.json"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("animate the seed"));
  const auto report = nlohmann::json::parse(read_text(path("out/0002.json")));
  EXPECT_THAT(report["notes"].dump(), HasSubstr("in 100 % of the noisy pixels the frames before and after repeat"));
  EXPECT_EQ(report["neighbours"]["shared_noise"], 1);
  EXPECT_EQ(report["neighbours"]["mean_weight"], 0);
  const OIIO::ImageBuf joined = load(path("out/shot.0002.exr"));
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) ASSERT_EQ(joined.getchannel(x, y, 0, c), alone.getchannel(x, y, 0, c));
}

TEST_F(Sequence, FramesOfOtherSeedsGetNoNote) {
  for (const unsigned seed : {1U, 2U, 3U}) write_render(path("shot.000" + std::to_string(seed) + ".exr"), 96, 64, seed);
  ASSERT_EQ(denoise({"--report", "out/####.json"}).code, 0);
  const auto report = nlohmann::json::parse(read_text(path("out/0002.json")));
  EXPECT_THAT(report["notes"].dump(), ::testing::Not(HasSubstr("seed")));
  EXPECT_GT(report["neighbours"]["mean_weight"], 1);
}

TEST_F(Sequence, ABrokenNeighbourIsLeftOutAndAChangedOneIsNoticed) {
  render_frames(1, 3);
  const std::vector<std::string> temporal{"--frame-radius", "1", "--skip-existing", "--report", "out/####.json"};
  ASSERT_EQ(denoise(temporal).code, 0);
  EXPECT_THAT(denoise(temporal).out, HasSubstr("0 written, 3 skipped"));
  cut_last_byte(path("shot.0003.exr"));
  const Outcome o = denoise(temporal);
  EXPECT_EQ(o.code, 4);
  EXPECT_THAT(o.out, HasSubstr("1 written, 1 skipped, 1 failed"));  // frame 2 anew, without frame 3
  const auto report = nlohmann::json::parse(read_text(path("out/0002.json")));
  EXPECT_EQ(report["neighbours"]["frames"], 1);
  EXPECT_THAT(report["notes"].dump(), HasSubstr("denoised without this neighbour: shot.0003.exr"));
}

TEST_F(Sequence, TheFrameNumberGoesIntoTheSampleMap) {
  render("shot.0007.exr");
  ASSERT_EQ(denoise({"--sample-map", "out/samples.####.exr", "--budget", "4"}).code, 0);
  EXPECT_EQ(load(path("out/samples.0007.exr")).spec().get_float_attribute("frame"), 7);
}

/// Frames that have a file for each pass; the albedo of each frame is another one.
class SequenceOfFiles : public Sequence {
 protected:
  static std::vector<std::string> rgb() { return {"R", "G", "B"}; }

  void write_frame(int frame, const std::string& albedo) const {
    write_exr(path(name("shot", frame)), width, height, rgb(),
              [](int x, int y, int c) { return 0.5 + 0.01 * ((7 * x + 3 * y + c) % 5); });
    write_exr(path(name(albedo, frame)), width, height, rgb(),
              [&](int x, int, int) { return x < width / 2 ? 0.1 * frame : 0.8; });
  }

  static std::string name(const std::string& stem, int frame) { return stem + ".000" + std::to_string(frame) + ".exr"; }

  /// The layer that a frame's report names for a role; empty without one.
  std::string layer_of(const std::string& role, int frame) const {
    const auto report = nlohmann::json::parse(read_text(path("out/000" + std::to_string(frame) + ".json")));
    for (const auto& choice : report["roles"])
      if (choice["role"] == role) return choice["layer"];
    return "";
  }

  std::string notes_of(int frame) const {
    return nlohmann::json::parse(read_text(path("out/000" + std::to_string(frame) + ".json")))["notes"].dump();
  }
};

TEST_F(SequenceOfFiles, AMappedFileTakesTheNumberOfTheFrame) {
  for (int frame = 1; frame <= 3; ++frame) write_frame(frame, "colours");
  for (const char* pattern : {"colours.####.exr", "colours.%04d.exr"}) {
    const std::string map = std::string("albedo=") + pattern;
    ASSERT_EQ(denoise({"--map", map, "--report", "out/####.json"}).code, 0);
    for (int frame = 1; frame <= 3; ++frame) {
      EXPECT_EQ(layer_of("albedo", frame), name("colours", frame));
      EXPECT_THAT(notes_of(frame), ::testing::Not(HasSubstr("every frame")));
    }
  }
  // A list of files, and one file, take the number in each input's name.
  ASSERT_EQ(run({"denoise", "-i", "shot.0003.exr", "shot.0002.exr", "-o", "out", "--map", "albedo=colours.####.exr",
                 "--overwrite", "--report", "out/####.json", "--quality", "draft"})
                .code,
            0);
  EXPECT_EQ(layer_of("albedo", 3), name("colours", 3));
  ASSERT_EQ(run({"denoise", "-i", "shot.0002.exr", "-o", "out/one.exr", "--prior", "colours.####.exr", "--report",
                 "out/0009.json", "--quality", "draft"})
                .code,
            0);
  EXPECT_EQ(layer_of("prior", 9), name("colours", 2));
  // A frame without its file is a broken frame, and the message names the file.
  std::filesystem::remove(path("colours.0002.exr"));
  const Outcome o = denoise({"--map", "albedo=colours.####.exr", "--frame-radius", "0"});
  EXPECT_EQ(o.code, 4);
  EXPECT_THAT(o.err, HasSubstr("no layer colours.0002.exr"));
  EXPECT_THAT(o.out, HasSubstr("2 written, 0 skipped, 1 failed"));
}

TEST_F(SequenceOfFiles, AFileForAllFramesIsNoted) {
  for (int frame = 1; frame <= 2; ++frame) write_frame(frame, "colours");
  ASSERT_EQ(denoise({"--map", "albedo=colours.0001.exr", "--report", "out/####.json"}).code, 0);
  EXPECT_THAT(notes_of(2), HasSubstr("colours.0001.exr is used for every frame"));
  ASSERT_EQ(run({"denoise", "-i", "shot.0002.exr", "-o", "out/a.exr", "--map", "albedo=colours.0001.exr", "--report",
                 "out/0002.json", "--overwrite", "--quality", "draft"})
                .code,
            0);
  EXPECT_THAT(notes_of(2), ::testing::Not(HasSubstr("every frame")));
}

TEST_F(SequenceOfFiles, PassesNextToEachFrameAreFound) {
  for (int frame = 1; frame <= 2; ++frame) write_frame(frame, "shot_albedo");
  ASSERT_EQ(denoise({"--report", "out/####.json"}).code, 0);
  for (int frame = 1; frame <= 2; ++frame) {
    EXPECT_EQ(layer_of("albedo", frame), "albedo");
    EXPECT_THAT(notes_of(frame), HasSubstr(name("shot_albedo", frame)));
  }
}

TEST_F(SequenceOfFiles, CostsTakeTheNumberOfTheFrame) {
  for (int frame = 1; frame <= 2; ++frame) {
    write_frame(frame, "colours");
    // The left half is dearer in frame 1, the right half in frame 2.
    write_exr(path(name("cost", frame)), width, height, {"Y"},
              [&](int x, int, int) { return (x < width / 2) == (frame == 1) ? 16.0 : 1.0; });
  }
  ASSERT_EQ(denoise({"--sample-map", "out/map.####.exr", "--budget", "4", "--cost", "cost.####.exr", "--frame-radius",
                     "0", "--map", "albedo=colours.0001.exr"})
                .code,
            0);
  const auto samples = [&](const char* file, int begin, int end) {
    const OIIO::ImageBuf map = load(path(file));
    const auto& names = map.spec().channelnames;
    const auto channel = std::find(names.begin(), names.end(), "samples.Y") - names.begin();
    double sum = 0;
    for (int y = 0; y < height; ++y)
      for (int x = begin; x < end; ++x) sum += map.getchannel(x, y, 0, static_cast<int>(channel));
    return sum;
  };
  EXPECT_LT(samples("out/map.0001.exr", 0, width / 2), samples("out/map.0002.exr", 0, width / 2));
  EXPECT_GT(samples("out/map.0001.exr", width / 2, width), samples("out/map.0002.exr", width / 2, width));
  std::filesystem::remove(path("cost.0002.exr"));
  const Outcome o = denoise({"--sample-map", "out/map.####.exr", "--budget", "4", "--cost", "cost.####.exr"});
  EXPECT_EQ(o.code, 4);
  EXPECT_THAT(o.err, HasSubstr("cost.0002.exr: no such file"));
}

TEST_F(Sequence, OpenJdProgressRisesTo100AndTellsFailure) {
  render_frames(1, 3);
  const Outcome o = denoise({"--progress", "openjd"});
  ASSERT_EQ(o.code, 0);
  EXPECT_THAT(o.err, HasSubstr("openjd_status: frame 2 (2 of 3)\n"));
  double last = -1;
  std::istringstream lines(o.err);
  const std::string key = "openjd_progress: ";
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const double percent = std::stod(line.substr(key.size()));
    EXPECT_GT(percent, last) << line;
    last = percent;
  }
  EXPECT_EQ(last, 100);
  const Outcome failed = denoise({"--progress", "openjd", "--frames", "8-9"});
  EXPECT_EQ(failed.code, 4);
  EXPECT_THAT(failed.err, HasSubstr("openjd_fail: 2 of 2 frames are missing or broken: 8,9\n"));
}

TEST_F(Sequence, JsonProgressNamesTheFrame) {
  render_frames(1, 2);
  const Outcome o = denoise({"--progress", "json"});
  ASSERT_EQ(o.code, 0);
  EXPECT_THAT(o.err, HasSubstr(R"({"event":"frame","frame":"frame 2","done":1,"total":2})"));
}

}  // namespace
}  // namespace polyrecon::testing
