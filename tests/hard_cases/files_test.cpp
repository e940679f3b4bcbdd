// Cases 1 to 15: damaged and unusual files are refused or kept, and no failure or kill leaves half a file.

#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "cli/program.h"
#include "io/exr_fixture.h"
#include "io/files/atomic_file.h"
#include "polyrecon/read_frame.h"
#include "polyrecon/write_result.h"
#include "support/instances.h"
#include "support/random.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

using ::testing::AnyOf;
using testing::contents;
using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using testing::is_one_error_line;
using testing::layer;
using testing::Outcome;
using testing::put_contents;
using testing::read_text;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

/// Runs the program in a folder that is made for the test.
class HardFiles : public testing::ProgramTest {
 protected:
  static std::vector<std::string> denoise(const std::string& in, const std::string& out,
                                          const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"denoise", "-i", in, "-o", out, "--overwrite", "--quality", "draft", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// Expects a run to fail with this exit code and one line that names the file, and to leave no file but the input.
  void expect_refused(const std::vector<std::string>& arguments, int code, const std::string& words) {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.code, code) << o.err;
    EXPECT_TRUE(is_one_error_line(o.err));
    EXPECT_THAT(o.err, HasSubstr("in.exr"));
    EXPECT_THAT(o.err, HasSubstr(words));
    EXPECT_THAT(files(), ElementsAre("in.exr"));
  }
};

class Case01File : public HardFiles {};
class Case03File : public HardFiles {};
class Case04File : public HardFiles {};
class Case05File : public HardFiles {};
class Case06File : public HardFiles {};
class Case09File : public HardFiles {};
class Case11File : public HardFiles {};
class Case12File : public HardFiles {};
class Case13File : public HardFiles {};

// ---- 1: files cut off at any byte

/// One part of scanlines and one of tiles, each of several chunks.
std::vector<TestPart> small_parts() {
  TestPart lines, tiles;
  lines.window = lines.display = tiles.window = tiles.display = {0, 0, 10, 40};
  lines.name = "lines";
  lines.channels = layer("V.Combined", "RGB");
  tiles.name = "tiles";
  tiles.channels = layer("V.Denoising Albedo", "RGB", 5, Imf::HALF);
  tiles.tile = 8;
  return {lines, tiles};
}

TEST(Case01, IsNoticedWhereverAFileIsCut) {
  const TemporaryFolder folder;
  for (const bool several : {false, true}) {
    std::vector<TestPart> parts = small_parts();
    if (!several) parts.pop_back();
    const std::string whole = contents(write_exr(folder / "whole.exr", parts)), path = folder / "cut.exr";
    const std::size_t first_chunk = whole.size() - (several ? 1000 : 500);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      put_contents(path, whole.substr(0, size));
      const Error error = error_of([&] { read_frame(path); });
      ASSERT_EQ(error.code(), ExitCode::BadInput) << size;
      ASSERT_THAT(error.what(), HasSubstr(path)) << size;
      if (size > 8) {
        ASSERT_THAT(error.what(), HasSubstr("incomplete")) << size;
      }
      if (size > first_chunk) {
        ASSERT_THAT(error.what(), AnyOf(HasSubstr(", scanlines "), HasSubstr(", tile "))) << size;
      }
    }
  }
}

TEST_F(Case01File, TheLastByteIsMissedAndItsTileNamed) {
  write_exr(path("in.exr"), small_parts());
  fs::resize_file(path("in.exr"), fs::file_size(path("in.exr")) - 1);
  expect_refused(denoise("in.exr", "out.exr"), 3, "part 1 \"tiles\", tile (1, 4) cannot be read");
}

// ---- 3: headers that claim too much

/// Writes a file of less than 500 bytes whose header claims a data window of width x height.
void write_bomb(const std::string& path, int width, int height) {
  TestPart part;
  part.channels = layer("", "RGB");
  std::string bytes = contents(write_exr(path, {part}));
  const std::string key("dataWindow\0box2i\0", 17);
  const std::size_t at = bytes.find(key) + key.size() + 4;
  for (const auto& [offset, value] : {std::pair{8, width - 1}, std::pair{12, height - 1}})
    for (std::size_t i = 0; i < 4; ++i)
      bytes[at + static_cast<std::size_t>(offset) + i] = static_cast<char>(value >> (8 * i));
  put_contents(path, bytes.substr(0, 464));
}

TEST_F(Case03File, ABombIsRefusedWithinASecondAnd200MB) {
  for (const auto& [width, height] : {std::pair{32000, 32000}, std::pair{1 << 30, 4}, std::pair{4, 1 << 30}}) {
    write_bomb(path("in.exr"), width, height);
    const pid_t child = start(denoise("in.exr", "out.exr"));
    int status = 0;
    struct ::rusage used {};
    ASSERT_EQ(::wait4(child, &status, 0, &used), child);
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 3) << read_text(path("stderr"));
    EXPECT_LT(used.ru_utime.tv_sec + used.ru_stime.tv_sec, 1);
    EXPECT_LT(used.ru_maxrss, 200 * 1024);  // KiB
    EXPECT_THAT(files(), ElementsAre("in.exr"));
  }
}

TEST_F(Case03File, LimitsCanBeSet) {
  testing::write_render(path("in.exr"), 40, 24);
  expect_refused(denoise("in.exr", "out.exr", {"--max-pixels", "959"}), 3, "--max-pixels");
  expect_refused(denoise("in.exr", "out.exr", {"--max-channels", "15"}), 3, "--max-channels");
  EXPECT_EQ(run(denoise("in.exr", "out.exr", {"--max-pixels", "960", "--max-channels", "16"})).code, 0);
}

// ---- 4: one damaged part among many

TEST_F(Case04File, ADamagedPartThatIsOnlyCopiedIsNamed) {
  std::vector<TestPart> parts(8);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    parts[p].name = p == 0 ? "V.Combined" : "V.Crypto0" + std::to_string(p);
    parts[p].channels = layer(parts[p].name, p == 0 ? "RGB" : "rgba", static_cast<int>(p));
  }
  std::string bytes = contents(write_exr(path("in.exr"), parts));
  // Each part is one chunk of about 300 bytes; the sixth is damaged.
  const std::size_t chunks = bytes.size() - static_cast<std::size_t>(8 * 300);
  for (std::size_t i = 0; i < 8; ++i) bytes[chunks + 300 * 5 + i] = static_cast<char>(0x55);
  put_contents(path("in.exr"), bytes);
  const Outcome o = run(denoise("in.exr", "out.exr"));
  EXPECT_EQ(o.code, 3) << o.err;
  EXPECT_TRUE(is_one_error_line(o.err));
  EXPECT_THAT(o.err, HasSubstr("\"V.Crypto0"));
  EXPECT_THAT(files(), ElementsAre("in.exr"));
}

// ---- 5: data and display windows

TEST_F(Case05File, OverscanAndNegativeOriginAreKept) {
  TestPart part;
  part.window = {-5, -3, 31, 25};
  part.display = {0, 0, 24, 20};
  part.channels = layer("V.Combined", "RGBA");
  write_exr(path("in.exr"), {part});
  ASSERT_EQ(run(denoise("in.exr", "out.exr", {"--error-map", "error.exr"})).code, 0);
  for (const char* name : {"out.exr", "error.exr"}) {
    const FileInfo out = describe_file(path(name));
    EXPECT_EQ(out.parts[0].data_window, part.window) << name;
    EXPECT_EQ(out.parts[0].display_window, part.display) << name;
  }
  EXPECT_EQ(testing::stored_bytes(path("in.exr"), 0, "V.Combined.A"),
            testing::stored_bytes(path("out.exr"), 0, "V.Combined.A"));
}

// ---- 6: unsupported kinds of parts

TEST_F(Case06File, ALuminanceChromaBeautyIsUnsupported) {
  Imf::Header header(8, 8);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  for (const char* chroma : {"BY", "RY"}) header.channels().insert(chroma, Imf::Channel(Imf::HALF, 2, 2));
  header.setType(Imf::SCANLINEIMAGE);
  {
    std::vector<half> y(64, half(1.0F)), by(16);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::HALF, y.data(), {0, 0}, 8, 8, 2, 16));
    for (const char* chroma : {"BY", "RY"})
      buffer.insert(chroma, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(by.data()), 2, 8, 2, 2));
    Imf::MultiPartOutputFile file(path("in.exr").c_str(), &header, 1);
    Imf::OutputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.writePixels(8);
  }
  const Outcome o = run(denoise("in.exr", "out.exr"));
  EXPECT_THAT(o.code, AnyOf(3, 4)) << o.err;
  EXPECT_TRUE(is_one_error_line(o.err));
  EXPECT_THAT(files(), ElementsAre("in.exr"));
}

// ---- 8: channels and attributes that are copied

/// The copied channels hold every bit pattern of half, and random ones of float and uint: NaN with payloads, denormals,
/// -0.
TEST(Case08, UntouchedChannelsAndAttributesAreTheSameBits) {
  const TemporaryFolder folder;
  test::Random random(8);
  const auto bits = [&](int, int) { return std::floor(random.uniform() * 4294967296.0); };
  TestPart part;
  part.window = part.display = {0, 0, 256, 256};
  part.channels = testing::join({layer("V.Combined", "RGB"), layer("V.Id", "X", 0, Imf::UINT)});
  part.channels.back().samples = bits;
  part.edit = [](Imf::Header& header) {
    header.pixelAspectRatio() = 1.5F;
    header.insert("cryptomatte/542cafa/manifest", Imf::StringAttribute("{\"a \\u00e9\":\"00000001\"}"));
    header.insert("unit", Imf::StringAttribute("mm"));
  };
  const std::string in = folder / "in.exr", out = folder / "out.exr";
  {
    Imf::Header header = testing::header_of(part);
    header.channels().insert("V.Crypto00.r", Imf::Channel(Imf::FLOAT));
    header.channels().insert("V.Z.Z", Imf::Channel(Imf::HALF));
    std::map<std::string, std::vector<char>> bytes;
    for (const auto& channel : part.channels) bytes[channel.name] = testing::bytes_of(channel, part.window);
    Imf::FrameBuffer buffer = testing::buffer_of(part, bytes);
    std::vector<std::uint32_t> hashes(65536);
    std::vector<std::uint16_t> halves(65536);
    for (std::size_t i = 0; i < hashes.size(); ++i) {
      hashes[i] = static_cast<std::uint32_t>(bits(0, 0));
      halves[i] = static_cast<std::uint16_t>(i);
    }
    buffer.insert("V.Crypto00.r", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(hashes.data()), 4, 4 * 256));
    buffer.insert("V.Z.Z", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data()), 2, 2 * 256));
    Imf::MultiPartOutputFile file(in.c_str(), &header, 1);
    Imf::OutputPart lines(file, 0);
    lines.setFrameBuffer(buffer);
    lines.writePixels(256);
  }
  const ReadResult read = read_frame(in);
  write_result(read.source, {{"V.Combined", Image(256, 256, 3, Real(1)), false}}, out);
  for (const char* name : {"V.Id.X", "V.Crypto00.r", "V.Z.Z"})
    EXPECT_TRUE(testing::stored_bytes(in, 0, name) == testing::stored_bytes(out, 0, name)) << name;
  const FileInfo before = describe_file(in), after = describe_file(out);
  for (const AttributeInfo& attribute : before.parts[0].attributes) {
    const AttributeInfo* same = find_attribute(after.parts[0], attribute.name);
    ASSERT_NE(same, nullptr) << attribute.name;
    EXPECT_EQ(same->value, attribute.value) << attribute.name;
  }
}

// ---- 9: stereo

TEST_F(Case09File, InspectShowsTheViewsAndTheirRoles) {
  TestPart part;
  part.channels = testing::join({layer("", "RGB"), layer("right", "RGB", 4)});
  part.edit = [](Imf::Header& header) { Imf::addMultiView(header, {"left", "right"}); };
  write_exr(path("in.exr"), {part});
  const Outcome o = run({"inspect", "in.exr"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("left"));
  EXPECT_THAT(o.out, HasSubstr("right"));
}

// ---- 11: system calls that fail

/// While it lives, started programs load failing_calls.cpp and let one system call fail.
class Failing {
 public:
  Failing(const char* call, int at, const std::string& mark) {
    ::setenv("LD_PRELOAD", testing::failing_calls_path(), 1);
    ::setenv("FAIL_CALL", call, 1);
    ::setenv("FAIL_AT", std::to_string(at).c_str(), 1);
    ::setenv("FAIL_MARK", mark.c_str(), 1);
  }
  Failing(const Failing&) = delete;
  Failing& operator=(const Failing&) = delete;
  ~Failing() {
    for (const char* name : {"LD_PRELOAD", "FAIL_CALL", "FAIL_AT", "FAIL_MARK"}) ::unsetenv(name);
  }
};

/// Lets the first call of a kind fail, then the second, and so on, until a run has fewer calls of this kind.
TEST_F(Case11File, ACallThatFailsIsExitCode5AndTheOldFileStaysWhole) {
  testing::write_render(path("in.exr"), 16, 12);
  ASSERT_EQ(run(denoise("in.exr", "new.exr")).code, 0);
  const std::string fresh = contents(path("new.exr")), old = "an older result";
  fs::remove(path("new.exr"));
  for (const char* call : {"write", "fsync", "close", "rename"}) {
    int failures = 0;
    for (int at = 1;; ++at) {
      put_contents(path("out.exr"), old);
      fs::remove(path("mark"));
      Outcome o;
      {
        const Failing failing(call, at, path("mark"));
        o = run(denoise("in.exr", "out.exr"));
      }
      if (!exists("mark")) {
        EXPECT_EQ(o.code, 0) << o.err;
        break;
      }
      SCOPED_TRACE(std::string(call) + " " + std::to_string(at));
      // A call may be repeated with success (a buffer is flushed again); then the run succeeds and the file is whole.
      const bool whole = contents(path("out.exr")) == fresh;
      EXPECT_TRUE(whole || contents(path("out.exr")) == old);
      if (o.code != 0) {
        ++failures;
        EXPECT_EQ(o.code, 5) << o.err;
        EXPECT_TRUE(is_one_error_line(o.err));
        EXPECT_THAT(o.err, HasSubstr("out.exr"));
      } else {
        EXPECT_TRUE(whole);
      }
      fs::remove(path("mark"));
      EXPECT_THAT(files(), ::testing::UnorderedElementsAre("in.exr", "out.exr"));
    }
    EXPECT_GE(failures, 1) << call;
  }
}

// ---- 12: kills at any moment

TEST_F(Case12File, KilledAtAnyMomentTheOldOrTheNewFileIsThere) {
  const std::uint64_t seed = 12;
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  testing::write_render(path("in.exr"), 24, 16);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run(denoise("in.exr", "out.exr")).code, 0);
  const std::chrono::duration<double> whole_run = std::chrono::steady_clock::now() - begin;
  const std::string fresh = contents(path("out.exr")), old = "an older result";
  int killed = 0, replaced = 0;
  for (int kill = 0; kill < test::instances(30, 200); ++kill) {
    put_contents(path("out.exr"), old);
    const pid_t child = start(denoise("in.exr", "out.exr"));
    // Files are written at the end of the run, so most kills are aimed there.
    std::this_thread::sleep_for(whole_run * random.uniform(0.3, 1.1));
    ::kill(child, SIGKILL);
    killed += finish(child).code == 128 + SIGKILL;
    const std::string now = contents(path("out.exr"));
    EXPECT_THAT(now, AnyOf(old, fresh)) << "kill " << kill;
    replaced += now == fresh;
  }
  RecordProperty("killed", killed);
  RecordProperty("replaced", replaced);
  EXPECT_GT(killed, 0);
  // The next run removes temporary files of killed runs, but only if they are older than a minute.
  for (const std::string& name : files())
    if (name != "in.exr" && name != "out.exr")
      fs::last_write_time(path(name), fs::file_time_type::clock::now() - std::chrono::minutes(2));
  EXPECT_EQ(run(denoise("in.exr", "out.exr")).code, 0);
  EXPECT_THAT(files(), ::testing::UnorderedElementsAre("in.exr", "out.exr"));
}

// ---- 13: several writers of one file

TEST(Case13, SixteenWritersOfOneFileLeaveOneWholeFile) {
  const TemporaryFolder folder;
  const std::string target = folder / "out.exr";
  constexpr std::size_t writers = 16, size = 100000;
  for (int round = 0; round < test::instances(8, 100); ++round) {
    std::vector<pid_t> children;
    for (std::size_t w = 0; w < writers; ++w) {
      const pid_t child = ::fork();
      if (child == 0) {
        try {
          const std::string text(size, static_cast<char>('a' + w));
          write_atomically(
              target, [&](const std::string& path) { put_contents(path, text); }, [](const std::string&) {});
          ::_exit(0);
        } catch (...) {
          ::_exit(1);
        }
      }
      children.push_back(child);
    }
    for (const pid_t child : children) {
      int status = 0;
      ::waitpid(child, &status, 0);
      EXPECT_EQ(status, 0);
    }
    const std::string text = contents(target);
    EXPECT_EQ(text, std::string(size, text.empty() ? '?' : text.front())) << "round " << round;
    EXPECT_EQ(folder.entries(), 1u) << "round " << round;
  }
}

TEST_F(Case13File, AHardLinkToTheInputIsReplacedAndTheInputSurvives) {
  testing::write_render(path("in.exr"), 16, 12);
  const std::string input = contents(path("in.exr"));
  fs::create_hard_link(path("in.exr"), path("out.exr"));
  const Outcome o = run(denoise("in.exr", "out.exr"));
  EXPECT_EQ(contents(path("in.exr")), input);
  EXPECT_THAT(o.code, AnyOf(0, 2)) << o.err;
  EXPECT_EQ(o.code == 0, contents(path("out.exr")) != input);
}

}  // namespace
}  // namespace polyrecon
