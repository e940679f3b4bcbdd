// Hostile and damaged inputs, and limits of the system: one clear line and the documented code, or a right result.

#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfTileDescriptionAttribute.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.h"
#include "io/exr_fixture.h"

namespace polyrecon::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int width = 40, height = 24;

class Attacks : public ProgramTest {
 protected:
  /// A render, with value(x, y, channel name, value) in place of each value.
  void render(const std::string& name, const std::function<float(int, int, const std::string&, float)>& value) const {
    write_render(path("plain.exr"), width, height);
    const OIIO::ImageBuf plain = load(path("plain.exr"));
    fs::remove(path("plain.exr"));
    const std::vector<std::string>& channels = plain.spec().channelnames;
    write_exr(path(name), width, height, channels, [&](int x, int y, int c) {
      return value(x, y, channels[static_cast<std::size_t>(c)], plain.getchannel(x, y, 0, c));
    });
  }
  void render(const std::string& name) const {
    render(name, [](int, int, const std::string&, float v) { return v; });
  }

  Outcome denoise(const std::string& in, const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"denoise", "-i", in, "-o", out, "--overwrite", "--quality", "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  /// The values of the beauty.
  std::vector<float> beauty(const std::string& name) const {
    const OIIO::ImageBuf image = load(path(name));
    std::vector<float> values;
    for (int c = 0; c < image.nchannels(); ++c) {
      const std::string channel = image.spec().channelnames[static_cast<std::size_t>(c)];
      if (channel.find("Combined.") == std::string::npos) continue;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) values.push_back(image.getchannel(x, y, 0, c));
    }
    return values;
  }

  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(read_text(path(name))); }
};

bool is_half(const std::string& channel) { return channel.find("Combined A") + channel.find("Combined B") < 100; }

double sum_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v);
  return sum;
}

TEST_F(Attacks, HalvesThatContradictTheMeanAreNotUsed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  using Half = std::function<float(int, int, const std::string&, float)>;
  const std::vector<std::pair<std::string, Half>> kinds{
      {"zero", [](int, int, const std::string&, float) { return 0.F; }},
      {"three times", [](int, int, const std::string&, float v) { return 3 * v; }},
      {"nine tenths", [](int, int, const std::string&, float v) { return 0.9F * v; }},
      {"negative", [](int, int, const std::string&, float v) { return -v; }},
      {"one of them NaN", [=](int, int, const std::string& c, float v) { return c.find(" A") < 99 ? nan : v; }},
      {"black bucket", [](int x, int y, const std::string&, float v) { return x < 16 && y < 16 ? 0.F : v; }},
      {"of no file", [](int x, int y, const std::string&, float) { return static_cast<float>((x * 7 + y * 3) % 5); }}};
  for (const auto& [kind, half] : kinds) {
    render("in.exr", [&, &half = half](int x, int y, const std::string& c, float v) {
      return is_half(c) ? half(x, y, c, v) : v;
    });
    const Outcome o = denoise("in.exr", "out.exr", {"--report", "r.json"});
    ASSERT_EQ(o.code, 0) << kind << o.err;
    const char* reason = kind == "one of them NaN" ? "2880 of their samples are not finite where ViewLayer.Combined is"
                                                   : "contradict ViewLayer.Combined";
    EXPECT_THAT(o.out, HasSubstr(reason)) << kind;
    EXPECT_THAT(json("r.json")["notes"].dump(), HasSubstr(reason)) << kind;
    EXPECT_THAT(run({"inspect", "in.exr"}).out, HasSubstr(reason)) << kind;
    const double before = sum_of(beauty("in.exr")), after = sum_of(beauty("out.exr"));
    EXPECT_NEAR(after / before, 1, 1e-3) << kind;
  }
}

TEST_F(Attacks, HalvesOfUnequalLengthAreUsed) {
  render("in.exr", [](int, int, const std::string& c, float v) { return c.find("Variance") < 99 ? v * 5 / 4 : v; });
  const OIIO::ImageBuf in = load(path("in.exr"));
  const std::vector<std::string>& channels = in.spec().channelnames;
  const auto at = [&](int x, int y, const std::string& name) {
    const auto found = std::find(channels.begin(), channels.end(), name);
    return in.getchannel(x, y, 0, static_cast<int>(found - channels.begin()));
  };
  write_exr(path("uneven.exr"), width, height, channels, [&](int x, int y, int c) {
    const std::string& name = channels[static_cast<std::size_t>(c)];
    if (name.find("Combined.") == std::string::npos) return in.getchannel(x, y, 0, c);
    return 0.75F * at(x, y, "ViewLayer.Combined A" + name.substr(name.size() - 2)) +
           0.25F * at(x, y, "ViewLayer.Combined B" + name.substr(name.size() - 2));
  });
  const Outcome o = denoise("uneven.exr", "out.exr");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, Not(HasSubstr("contradict")));
}

/// A file whose header holds an attribute `name` of the type of `value`. OpenEXR does not write all of them, so it is
/// written under another name of the same length.
void write_odd(const std::string& path, const std::string& name, const Imf::Attribute& value) {
  TestPart part;
  for (const char* channel : {"R", "G", "B"}) part.channels.push_back({channel, Imf::FLOAT, pattern(3)});
  std::string stand_in = name;
  stand_in.back() = '#';
  part.edit = [&](Imf::Header& header) { header.insert(stand_in, value); };
  write_exr(path, {part});
  std::string bytes = read_text(path);
  bytes.replace(bytes.find(stand_in), name.size(), name);
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST_F(Attacks, AnOddFrameDoesNotEndASequence) {
  const auto plain = [&](const std::string& name, const std::string& layer) {
    TestPart part;
    for (const char* channel : {"R", "G", "B"}) part.channels.push_back({layer + channel, Imf::FLOAT, pattern(3)});
    write_exr(path(name), {part});
  };
  plain("s.0001.exr", "");
  write_odd(path("s.0002.exr"), "tiles", Imf::TileDescriptionAttribute({0, 0, Imf::ONE_LEVEL}));
  write_odd(path("s.0003.exr"), "polyrecon/input", Imf::FloatAttribute(1));
  plain("s.0004.exr",
        "Stra\xdf"
        "e.Combined.");
  plain("s.0005.exr", "");
  fs::resize_file(path("s.0005.exr"), fs::file_size(path("s.0005.exr")) - 1);
  ::mkfifo(path("s.0006.exr").c_str(), 0600);
  plain("s.0007.exr", "");
  const Outcome o = denoise("s.####.exr", "o.####.exr", {"--report", "r.####.json", "--error-map", "e.####.exr"});
  EXPECT_EQ(o.code, 4) << o.err;
  EXPECT_THAT(o.err, HasSubstr("2 of 7 frames are missing or broken: 5,6"));
  for (const int frame : {1, 2, 3, 4, 7}) {
    const std::string number = "000" + std::to_string(frame);
    EXPECT_TRUE(exists("o." + number + ".exr")) << frame;
    EXPECT_EQ(json("r." + number + ".json")["width"], 8) << frame;
  }
  EXPECT_EQ(denoise("s.0005.exr", "x.exr").code, 3);
  const Outcome inspected = run({"inspect", "s.0004.exr", "--json"});
  EXPECT_EQ(inspected.code, 0);
  EXPECT_EQ(nlohmann::json::parse(inspected.out)["layers"][0]["name"],
            "Stra\xef\xbf\xbd"
            "e.Combined");
}

TEST_F(Attacks, ChannelsWithoutALayersNameAreOfALayer) {
  const std::vector<std::string> combined{"L.Combined.R", "L.Combined.G", "L.Combined.B"};
  for (const std::vector<std::string>& odd : std::vector<std::vector<std::string>>{
           {".R"}, {".R", ".G", ".B"}, {".R", ".G", ".B", ".A"}, {"..R"}, {".A"}, {"L..R", "L..G", "L..B"}, {"."}}) {
    for (const bool alone : {false, true}) {
      std::vector<std::string> channels = alone ? std::vector<std::string>{} : combined;
      channels.insert(channels.end(), odd.begin(), odd.end());
      write_exr(path("in.exr"), width, height, channels, [](int x, int y, int) { return 0.1 + 0.01 * (x * y % 7); });
      for (const Outcome& o : {run({"inspect", "in.exr"}), denoise("in.exr", "o.exr", {"--aov", "all", "--alpha"})})
        EXPECT_TRUE(o.code == 0 || ((o.code == 3 || o.code == 4) && alone)) << odd.front() << o.code << o.err;
    }
  }
}

TEST_F(Attacks, PathsNeedNotBeUtf8) {
  render(
      "Stra\xdf"
      "e.exr");
  render("r.exr");
  const Outcome o = denoise(
      "Stra\xdf"
      "e.exr",
      "o\xff.exr", {"--report", "r\xff.json", "--progress", "json"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(json("r\xff.json")["input"],
            "Stra\xef\xbf\xbd"
            "e.exr");
  const Outcome compared = run({"compare", "o\xff.exr", "r.exr", "--json", "--html", "h\xff.html"});
  EXPECT_EQ(compared.code, 0) << compared.err;
  EXPECT_EQ(nlohmann::json::parse(compared.out)["reference"], "r.exr");
  EXPECT_THAT(read_text(path("h\xff.html")), HasSubstr("o&#xfffd;.exr"));
}

TEST_F(Attacks, PipesDevicesAndFoldersAreNoInput) {
  ::mkfifo(path("pipe.exr").c_str(), 0600);
  fs::create_directory(path("folder.exr"));
  fs::create_symlink("/dev/zero", path("device.exr"));
  render("r.exr");
  fs::create_directory(path("out"));
  for (const std::string input : {"pipe.exr", "folder.exr", "device.exr"}) {
    const std::vector<std::vector<std::string>> commands{
        {"denoise", "-i", input, "-o", "o.exr"},
        {"denoise", "-i", "r.exr", "--prior", input, "-o", "o.exr"},
        {"denoise", "-i", "r.exr", "--map", "albedo=" + input, "-o", "o.exr"},
        {"denoise", "-i", "r.exr", input, "--overwrite", "-o", "out"},
        {"denoise", "-i", "r.exr", "-o", "o.exr", "--sample-map", "s.exr", "--budget", "4", "--cost", input},
        {"inspect", input},
        {"merge", "r.exr", input, "-o", "o.exr"},
        {"samplemap", "-e", input, "--budget", "4", "-o", "o.exr"},
        {"preview", input, "-o", "o.png"},
        {"compare", "r.exr", input},
        {"sweep", "-i", input, "--reference", "r.exr", "-o", "o.html"},
        {"sweep", "-i", "r.exr", "--reference", input, "-o", "o.html"},
        {"sweep", "-i", "r.exr", "--reference", "r.exr", "--also", "x=" + input + ":1", "-o", "o.html"}};
    for (const auto& arguments : commands) {
      in_child_ = [] { ::alarm(60); };
      const Outcome o = run(arguments);
      const std::string command = ::testing::PrintToString(arguments);
      // A list goes on with the other files; a folder alone is searched for renders, and this one has none.
      const bool goes_on =
          arguments.back() == "out" || (input == "folder.exr" && arguments.size() == 5 && arguments[0] == "denoise");
      EXPECT_EQ(o.code, goes_on ? 4 : 3) << command;
      EXPECT_THAT(o.err, HasSubstr(input)) << command;
      EXPECT_FALSE(exists("o.exr") || exists("o.png") || exists("o.html")) << command;
    }
  }
}

TEST_F(Attacks, CostsThatCannotBeUsedAreRefusedBeforeTheFrameIsDenoised) {
  render("in.exr");
  std::ofstream(path("empty.exr")).close();
  write_exr(path("small.exr"), 8, 8, {"Y"}, [](int, int, int) { return 1.0F; });
  for (const auto& [cost, code] : {std::pair("empty.exr", 3), std::pair("small.exr", 3), std::pair("in.exr", 4)}) {
    const Outcome o = denoise("in.exr", "out.exr", {"--sample-map", "s.exr", "--budget", "4", "--cost", cost});
    EXPECT_EQ(o.code, code) << cost << o.err;
    EXPECT_TRUE(is_one_error_line(o.err)) << o.err;
    EXPECT_THAT(o.err, HasSubstr(cost));
    EXPECT_FALSE(exists("out.exr")) << cost;
  }
}

TEST_F(Attacks, FilesOfTheSystemWithoutAnEndAreNotRead) {
  render("r.exr");
  fs::create_directory(path("out"));
  for (const std::string name : {"/proc/kmsg", "/proc/self/mem", "/proc/self/pagemap"}) {
    fs::remove(path("x.exr"));
    fs::create_symlink(name, path("x.exr"));
    for (const auto& [arguments, code] : std::vector<std::pair<std::vector<std::string>, int>>{
             {{"denoise", "-i", "r.exr", "x.exr", "--overwrite", "-o", "out"}, 4},
             {{"denoise", "-i", "x.exr", "-o", "o.exr"}, 3},
             {{"view", "--page", "x.exr", "-o", "o.html"}, 3}}) {
      in_child_ = [] { ::alarm(60); };
      const Outcome o = run(arguments);
      EXPECT_EQ(o.code, code) << name << arguments[0] << o.err;
      EXPECT_THAT(o.err, HasSubstr("x.exr")) << name;
    }
  }
}

TEST_F(Attacks, PipesAndDevicesAreNoLibrary) {
  ::mkfifo(path("pipe.so").c_str(), 0600);
  fs::create_symlink("/dev/zero", path("device.so"));
  render("r.exr");
  for (const std::string library : {"pipe.so", "device.so"}) {
    in_child_ = [] { ::alarm(60); };
    const Outcome o = denoise("r.exr", "o.exr", {"--prior", "oidn", "--oidn", path(library)});
    EXPECT_EQ(o.code, 4) << o.err;
    EXPECT_THAT(o.err, HasSubstr(library + " is not a file"));
    in_child_ = [] { ::alarm(60); };
    EXPECT_EQ(run({"inspect", "r.exr", "--oidn", path(library)}).code, 0);
  }
  fs::create_symlink("loop.so", path("loop.so"));
  const Outcome loop = denoise("r.exr", "o.exr", {"--prior", "oidn", "--oidn", path("loop.so")});
  EXPECT_EQ(loop.code, 4) << loop.err;
  EXPECT_THAT(loop.err, HasSubstr("loop.so"));
}

TEST_F(Attacks, FoldersThatLookLikePatternsAreFolders) {
  for (const std::string folder : {"job #3", "####", "%04d", "a %d b"}) {
    fs::create_directory(path(folder));
    render(folder + "/s.0001.exr");
    EXPECT_EQ(denoise(folder + "/s.0001.exr", folder + "/one.exr").code, 0) << folder;
    for (const std::string name : {"s.####.exr", "s.%04d.exr"}) {
      const Outcome o = denoise(folder + "/" + name, folder + "/o." + name, {"--error-map", "e.####.exr"});
      EXPECT_EQ(o.code, 0) << folder << " " << name << o.err;
      EXPECT_TRUE(exists(folder + "/o.s.0001.exr")) << folder << " " << name;
      fs::remove(path(folder + "/o.s.0001.exr"));
    }
  }
}

TEST_F(Attacks, LongNamesAndRangesEndWithOneLine) {
  constexpr std::size_t length = 100000;
  const auto many = [](const std::string& piece) {
    std::string text;
    while (text.size() < length) text += piece;
    return text;
  };
  render("s.0001.exr");
  for (const std::string& name : {many("#"), many("#a"), many("a") + "####.exr", many("1"), many("1a"), many("%d"),
                                  many("a/") + "####.exr", many("-v1")}) {
    EXPECT_TRUE(is_one_error_line(denoise(name, "o.exr").err)) << name.substr(0, 9);
    EXPECT_TRUE(is_one_error_line(denoise("s.####.exr", name).err)) << name.substr(0, 9);
    EXPECT_TRUE(is_one_error_line(run({"inspect", name}).err)) << name.substr(0, 9);
    EXPECT_TRUE(is_one_error_line(run({"denoise", "-i", name, "s.0001.exr", "-o", "."}).err)) << name.substr(0, 9);
  }
  for (const std::string& frames : {many("1"), "1-" + many("1"), many("-"), many("1,"), many("1-"), many("x")}) {
    const Outcome o = denoise("s.####.exr", "o.####.exr", {"--frames", frames + "z"});
    EXPECT_EQ(o.code, 2) << frames.substr(0, 9);
    EXPECT_TRUE(is_one_error_line(o.err)) << frames.substr(0, 9);
  }
}

TEST_F(Attacks, OnlyTheDecoderOfTheNameIsOpened) {
  OIIO::ImageBuf image(OIIO::ImageSpec(16, 16, 3, OIIO::TypeDesc::UINT8));
  OIIO::ImageBufAlgo::fill(image, {0.1F, 0.5F, 0.9F});
  const std::vector<std::string> formats{"tif", "pfm", "hdr", "png", "bmp", "ico", "dpx",  "tga",   "sgi",
                                         "iff", "rla", "ppm", "jpg", "gif", "exr", "fits", "zfile", "null"};
  // What OpenImageIO of Debian 12 does not write.
  std::ofstream(path("x.pfm"), std::ios::binary) << "PF\n16 16\n-1.0\n" << std::string(std::size_t{16 * 16 * 12}, '\0');
  for (const std::string& format : formats) {
    if (!exists("x." + format) &&
        !image.write(path("x." + format),
                     format == "pfm" || format == "hdr" ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UNKNOWN))
      continue;
    for (const std::string name : {"tif", "tiff", "pfm", "hdr"}) {
      if (format == name || (format == "tif" && name == "tiff") || format == "exr") continue;
      fs::copy_file(path("x." + format), path("y." + name));
      for (const Outcome& o : {run({"inspect", "y." + name}), denoise("y." + name, "o.exr")}) {
        EXPECT_EQ(o.code, 3) << format << " as " << name;
        EXPECT_TRUE(is_one_error_line(o.err)) << format << " as " << name;
      }
      fs::remove(path("y." + name));
    }
  }
  for (const std::string format : {"tif", "pfm", "hdr"}) {
    const Outcome o = run({"inspect", "x." + format});
    EXPECT_EQ(o.code, 0) << format << o.err;
    EXPECT_THAT(o.out, HasSubstr("16x16")) << format;
  }
}

TEST_F(Attacks, TiffsOfOddKindsAreRefused) {
  const auto write = [&](int channels, OIIO::TypeDesc type, const std::function<void(OIIO::ImageSpec&)>& edit) {
    OIIO::ImageSpec spec(16, 16, channels, type);
    edit(spec);
    OIIO::ImageBuf image(spec);
    return image.write(path("x.tif"));
  };
  const auto bits = [](int n) { return [n](OIIO::ImageSpec& spec) { spec.attribute("oiio:BitsPerSample", n); }; };
  ASSERT_TRUE(write(3, OIIO::TypeDesc::FLOAT, [](OIIO::ImageSpec&) {}));
  EXPECT_EQ(run({"inspect", "x.tif"}).code, 0);
  ASSERT_TRUE(
      write(4, OIIO::TypeDesc::UINT8, [](OIIO::ImageSpec& spec) { spec.attribute("tiff:ColorSpace", "CMYK"); }));
  EXPECT_EQ(run({"inspect", "x.tif"}).code, 3);
  for (const int n : {1, 2, 4}) {
    ASSERT_TRUE(write(1, OIIO::TypeDesc::UINT8, bits(n)));
    EXPECT_EQ(run({"inspect", "x.tif"}).code, 3) << n;
  }
  ASSERT_TRUE(write(3, OIIO::TypeDesc::UINT16, bits(10)));
  EXPECT_EQ(run({"inspect", "x.tif"}).code, 3);
}

TEST_F(Attacks, DamagedTiffsAreRefused) {
  OIIO::ImageSpec spec(64, 64, 3, OIIO::TypeDesc::FLOAT);
  for (const std::string compression : {"none", "zip", "lzw", "packbits"}) {
    spec.attribute("compression", compression);
    OIIO::ImageBuf image(spec);
    for (int y = 0; y < spec.height; ++y)
      for (int x = 0; x < spec.width; ++x) {
        const float pixel[] = {static_cast<float>(x) / 64, static_cast<float>(y) / 64, 0.5F};
        image.setpixel(x, y, pixel);
      }
    ASSERT_TRUE(image.write(path("x.tif"))) << image.geterror();
    EXPECT_EQ(run({"inspect", "x.tif"}).code, 0) << compression;
    const std::string whole = read_text(path("x.tif"));
    std::ofstream(path("cut.tif"), std::ios::binary) << whole.substr(0, whole.size() / 2);
    std::string zeroed = whole;
    std::fill_n(zeroed.begin() + static_cast<std::ptrdiff_t>(whole.size() / 4), whole.size() / 2, '\0');
    std::ofstream(path("zeroed.tif"), std::ios::binary) << zeroed;
    for (const std::string name : {"cut.tif", "zeroed.tif"}) {
      if (name == "zeroed.tif" && compression == "none") continue;  // zeros are pixels there
      const Outcome o = denoise(name, "o.exr");
      EXPECT_EQ(o.code, 3) << compression << " " << name;
      EXPECT_TRUE(is_one_error_line(o.err)) << compression << " " << name << o.err;
    }
  }
}

/// A damaged JPEG or WebP in a TIFF is what the decoder's memory held before.
TEST_F(Attacks, TiffsOfOddCompressionsAreRefused) {
  OIIO::ImageBuf image(OIIO::ImageSpec(16, 16, 3, OIIO::TypeDesc::UINT8));
  ASSERT_TRUE(image.write(path("x.tif")));
  const std::string whole = read_text(path("x.tif"));
  const std::string tag("\x03\x01\x03\x00\x01\x00\x00\x00", 8);  // compression, of one short
  const std::size_t place = whole.find(tag);
  ASSERT_NE(place, std::string::npos);
  for (const int compression : {2, 3, 4, 6, 7, 32809, 32909, 34661, 34676, 34925, 50001}) {
    std::string odd = whole;
    odd[place + tag.size()] = static_cast<char>(compression & 0xFF);
    odd[place + tag.size() + 1] = static_cast<char>(compression >> 8);
    std::ofstream(path("odd.tif"), std::ios::binary) << odd;
    const Outcome o = run({"inspect", "odd.tif"});
    EXPECT_EQ(o.code, 3) << compression << o.out;
    EXPECT_TRUE(is_one_error_line(o.err)) << compression << o.err;
  }
}

TEST_F(Attacks, AnInputThatChangesWhileItIsDenoisedGivesNoResult) {
  constexpr int large = 300;
  write_render(path("in.exr"), large, large, 1);
  write_render(path("new.exr"), large, large, 2);
  const pid_t child = start({"denoise", "-i", "in.exr", "-o", "out.exr", "--progress", "json"});
  while (read_text(path("stderr")).find("noise variance") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child, SIGSTOP);  // it has been read by now, and not been written
  fs::rename(path("new.exr"), path("in.exr"));
  ::kill(child, SIGCONT);
  const Outcome o = finish(child);
  EXPECT_EQ(o.code, 3) << o.err;
  EXPECT_THAT(o.err, HasSubstr("in.exr: was changed"));
  EXPECT_FALSE(exists("out.exr"));
}

TEST_F(Attacks, ControlCharactersOfFilesAreEscaped) {
  const std::string evil =
      "A\x1b[2J\r\nopenjd_fail: forged\xc2\x9b"
      "7m<b>\xe2\x80\xae";
  for (const std::string name : {"x.exr", "y.exr"}) {
    TestPart part;
    part.name = evil;
    for (const char* channel : {"R", "G", "B"}) {
      part.channels.push_back({channel, Imf::FLOAT, pattern(3)});
      part.channels.push_back({evil + "." + channel, Imf::FLOAT, pattern(5)});
    }
    write_exr(path(name), {part});
  }
  const std::string file = "\x1b]0;title\a\nopenjd_progress: 99.exr";
  fs::copy_file(path("x.exr"), path(file));
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"inspect", file},
           {"denoise", "-i", file, "-o", "o" + file, "--aov", evil},
           {"denoise", "-i", file, "-o", "o" + file, "--progress", "openjd", "--map", "albedo=none" + evil},
           {"denoise", "-i", "x.exr", file, "-o", ".", "--progress", "json"},
           {"merge", file, "y.exr", "-o", "o.exr"},
           {"compare", file, "y.exr", "--html", "o.html"},
           {"preview", file, "-o", "o.png", "--layer", evil},
           {"preview", file, "-o", "o.png", "--layer", "none" + evil}}) {
    const Outcome o = run(arguments);
    for (const std::string& text : {o.out, o.err}) {
      EXPECT_TRUE(std::none_of(text.begin(), text.end(),
                               [](char c) { return c != '\n' && static_cast<unsigned char>(c) < 0x20; }))
          << arguments[0] << text;
      EXPECT_THAT(text, Not(HasSubstr("\xc2\x9b"))) << arguments[0];
      EXPECT_THAT(text, Not(HasSubstr("\xe2\x80\xae"))) << arguments[0];
      EXPECT_THAT("\n" + text, Not(HasSubstr("\nopenjd_fail: forged"))) << arguments[0];
      EXPECT_THAT("\n" + text, Not(HasSubstr("\nopenjd_progress: 99"))) << arguments[0];
    }
  }
  for (const auto& arguments : {std::vector<std::string>{"inspect", "x.exr", "--json"},
                                std::vector<std::string>{"compare", "x.exr", "y.exr", "--json"}}) {
    const std::string text = run(arguments).out;
    for (const char* control : {"\x1b", "\x7f", "\xc2\x9b", "\xe2\x80\xae"}) EXPECT_THAT(text, Not(HasSubstr(control)));
    const nlohmann::json parsed = nlohmann::json::parse(text);
    const nlohmann::json& name =
        arguments[0] == "inspect" ? parsed["files"][0]["parts"][0]["name"] : parsed["reference"];
    EXPECT_EQ(name, arguments[0] == "inspect" ? evil : "y.exr");
  }
  const std::string page = read_text(path("o.html"));
  EXPECT_THAT(page, Not(HasSubstr("\x1b")));
  EXPECT_THAT(page, Not(HasSubstr("<b>\xe2")));
}

TEST_F(Attacks, MaxMemoryHoldsForEveryCommand) {
  constexpr int side = 2048;  // 134 MB as floats, in a file of less than 1 MB
  TestPart part;
  part.window = part.display = {0, 0, side, side};
  for (const char* channel : {"R", "G", "B", "a.R", "a.G", "a.B", "Z", "A"})
    part.channels.push_back({channel, Imf::HALF, constant(1)});
  write_exr(path("in.exr"), {part});
  fs::copy_file(path("in.exr"), path("other.exr"));
  ASSERT_LT(fs::file_size(path("in.exr")), std::size_t{1} << 20);
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"inspect", "in.exr"},
                                             {"denoise", "-i", "in.exr", "-o", "o.exr"},
                                             {"merge", "in.exr", "other.exr", "-o", "o.exr"},
                                             {"compare", "in.exr", "in.exr"},
                                             {"preview", "in.exr", "in.exr", "in.exr", "-o", "o.png"},
                                             {"sweep", "-i", "in.exr", "--reference", "in.exr", "-o", "o.html"}}) {
    std::vector<std::string> limited = arguments;
    limited.insert(limited.end(), {"--max-memory", "100M"});
    const Outcome o = run(limited);
    EXPECT_TRUE(o.code == 33 || (o.code == 0 && arguments[0] == "merge")) << arguments[0] << " " << o.code << o.err;
    EXPECT_TRUE(o.code == 0 || is_one_error_line(o.err)) << arguments[0] << o.err;
    EXPECT_THAT(o.code == 0 ? "--max-memory" : o.err, HasSubstr("--max-memory")) << arguments[0];
    EXPECT_FALSE(exists("o.png") || exists("o.html")) << arguments[0];
  }
}

TEST_F(Attacks, ALimitOfTheFileSizeIsAFullDisk) {
  render("in.exr");
  for (const rlim_t bytes : {0, 1, 1000, 10000}) {
    in_child_ = [=] {
      const rlimit limit{bytes, bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    };
    // What the program prints is limited too, so it prints to a pipe that nobody reads.
    const pid_t child = start({"denoise", "-i", "in.exr", "-o", "out.exr", "-q", "--quality", "draft"});
    EXPECT_EQ(finish(child).code, 5) << bytes;
    EXPECT_EQ(files(), std::vector<std::string>{"in.exr"}) << bytes;
  }
}

TEST_F(Attacks, FewOpenFilesAreToldAtOnce) {
  render("in.exr");
  for (const rlim_t files : {4, 8, 31}) {
    in_child_ = [=] {
      const rlimit limit{files, files};
      ::setrlimit(RLIMIT_NOFILE, &limit);
    };
    const Outcome o = denoise("in.exr", "out.exr");
    EXPECT_TRUE(o.code == 33 || o.code == 127) << files;  // 127: the program itself cannot be loaded
    EXPECT_TRUE(o.code == 127 || o.err.find("ulimit -n") != std::string::npos) << files << o.err;
  }
  in_child_ = [] {
    const rlimit limit{32, 32};
    ::setrlimit(RLIMIT_NOFILE, &limit);
  };
  EXPECT_EQ(denoise("in.exr", "out.exr").code, 0);
}

TEST_F(Attacks, NoThreadToBeHadIsTooLittleMemory) {
  constexpr unsigned nobody = 64999;  // a user without processes, whom the limit binds
  render("in.exr");
  fs::copy_file(path("in.exr"), path("other.exr"));
  fs::permissions(folder_, fs::perms::all);
  in_child_ = [] {
    if (::getuid() == 0 && (::setgid(nobody) != 0 || ::setuid(nobody) != 0)) ::_exit(126);
    const rlimit limit{0, 0};
    ::setrlimit(RLIMIT_NPROC, &limit);
  };
  const std::vector<std::vector<std::string>> commands{{"denoise", "-i", "in.exr", "-o", "o.exr", "-t", "4"},
                                                       {"preview", "in.exr", "-o", "o.png"},
                                                       {"compare", "in.exr", "in.exr", "--html", "o.html"},
                                                       {"merge", "in.exr", "other.exr", "-o", "m.exr"},
                                                       {"inspect", "in.exr"}};
  for (const auto& arguments : commands) {
    const Outcome o = run(arguments);
    EXPECT_TRUE(o.code == 33 || o.code == 0) << arguments[0] << " " << o.code << o.err;
    EXPECT_TRUE(o.code == 0 || is_one_error_line(o.err)) << arguments[0];
  }
}

TEST_F(Attacks, SampleCountsThatAreNoneReachNoMap) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float wrong : {nan, inf, -4.F, 1e30F}) {
    for (const bool everywhere : {false, true}) {
      write_render(path("plain.exr"), width, height);
      const OIIO::ImageBuf plain = load(path("plain.exr"));
      std::vector<std::string> channels = plain.spec().channelnames;
      channels.emplace_back("ViewLayer.Debug Sample Count.X");
      write_exr(path("in.exr"), width, height, channels, [&](int x, int y, int c) {
        if (c < plain.nchannels()) return plain.getchannel(x, y, 0, c);
        return everywhere || (x + y) % 7 == 0 ? wrong : 8.F;
      });
      const Outcome o =
          denoise("in.exr", "out.exr", {"--error-map", "e.exr", "--sample-map", "s.exr", "--budget", "4"});
      ASSERT_EQ(o.code, 0) << wrong << o.err;
      EXPECT_THAT(o.out, HasSubstr("sample count")) << wrong;
      for (const std::string map : {"e.exr", "s.exr"}) {
        const OIIO::ImageBuf found = load(path(map));
        for (int c = 0; c < found.nchannels(); ++c)
          for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
              const float v = found.getchannel(x, y, 0, c);
              ASSERT_TRUE(std::isfinite(v) && v >= 0) << map << " " << v;
              const bool is_count =
                  map == "e.exr" && found.spec().channelnames[static_cast<std::size_t>(c)] == "samples.Y";
              ASSERT_TRUE(!is_count || v == 8) << wrong << " " << v;
            }
      }
    }
  }
}

TEST_F(Attacks, AnyExposureIsDenoised) {
  const auto rest_of_noise = [&](double scale, bool with_variance) {
    render("in.exr", [=](int, int, const std::string& c, float v) {
      const double factor = c.find("Variance") < 99 ? scale * scale : c.find("Combined") < 99 ? scale : 1;
      return static_cast<float>(!with_variance && c.find("Variance") < 99 ? std::numeric_limits<double>::quiet_NaN()
                                                                          : factor * static_cast<double>(v));
    });
    const Outcome o = denoise("in.exr", "out.exr");
    EXPECT_EQ(o.code, 0) << scale << o.err;
    const std::vector<float> in = beauty("in.exr"), out = beauty("out.exr");
    double before = 0, after = 0;  // differences of neighbours
    for (std::size_t i = 0; i + 1 < in.size(); ++i) {
      before += std::pow((static_cast<double>(in[i + 1]) - static_cast<double>(in[i])) / scale, 2);
      after += std::pow((static_cast<double>(out[i + 1]) - static_cast<double>(out[i])) / scale, 2);
    }
    return after / before;
  };
  const double usual = rest_of_noise(1, true);
  EXPECT_LT(usual, 0.6);
  for (const double scale : {1e4, 1e7, 1e10, 1e13}) EXPECT_NEAR(rest_of_noise(scale, true), usual, 0.1) << scale;
}

TEST_F(Attacks, ValuesBeyondTheLimitAreTold) {
  render("in.exr",
         [](int x, int, const std::string& c, float v) { return c.find("Combined.") < 99 && x == 5 ? 1e16F : v; });
  const Outcome some = denoise("in.exr", "out.exr");
  EXPECT_EQ(some.code, 0) << some.err;
  EXPECT_THAT(some.out, HasSubstr("72 samples beyond 1e+15"));
  render("in.exr", [](int, int, const std::string& c, float v) { return c.find("Combined.") < 99 ? 1e16F : v; });
  const Outcome all = denoise("in.exr", "out.exr");
  EXPECT_EQ(all.code, 6);
  EXPECT_THAT(all.err, HasSubstr("1e15"));
}

TEST_F(Attacks, HolesTakeNoEnergyFromTheOtherPixels) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto hole = [](int x, int y) { return (7 * x + 13 * y) % 29 == 0; };  // 3.4 % of the pixels
  render("in.exr",
         [=](int x, int y, const std::string& c, float v) { return c.find("Combined.") < 99 && hole(x, y) ? nan : v; });
  const Outcome o = denoise("in.exr", "out.exr", {"--report", "r.json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const std::vector<float> in = beauty("in.exr"), out = beauty("out.exr");
  double before = 0, after = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (std::isnan(in[i])) continue;
    before += static_cast<double>(in[i]);
    after += static_cast<double>(out[i]);
  }
  EXPECT_NEAR(after / before, 1, 1e-3);
  const nlohmann::json energy = json("r.json")["energy"];
  for (const double change : energy["channel_change"]) EXPECT_NEAR(change, 0, 1e-3);
  EXPECT_NEAR(energy["relative_change"].get<double>(), 0, 0.01);
}

TEST_F(Attacks, AChangeOfTheEnergyIsTold) {
  // Halves that contradict the mean of a few pixels by less than their noise: they are used.
  render("in.exr", [](int x, int y, const std::string& c, float v) {
    if (!is_half(c) || x < 16 || x >= 26 || y < 8 || y >= 18) return v;
    return c.find(" A") < 99 ? 4 * v : 0.F;
  });
  const Outcome o = denoise("in.exr", "out.exr", {"--report", "r.json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const std::string note = "the energy of the picture changed: ";
  EXPECT_THAT(o.out, HasSubstr(note));
  EXPECT_THAT(json("r.json")["notes"].dump(), HasSubstr(note));
  const nlohmann::json changes = json("r.json")["energy"]["channel_change"];
  EXPECT_GT(std::max({changes[0].get<double>(), changes[1].get<double>(), changes[2].get<double>()}), 0.05);
}

TEST_F(Attacks, AVarianceThatThePictureContradictsIsTold) {
  for (const float factor : {1.F, 100.F, 1e4F}) {
    render("in.exr", [=](int, int, const std::string& c, float v) { return c.find("Variance") < 99 ? factor * v : v; });
    const Outcome o = denoise("in.exr", "out.exr");
    EXPECT_EQ(o.code, 0) << factor;
    EXPECT_EQ(o.out.find("--variance-kind sample") != std::string::npos, factor > 1) << factor;
    EXPECT_EQ(run({"inspect", "in.exr"}).out.find("--variance-kind sample") != std::string::npos, factor > 1) << factor;
  }
}

TEST_F(Attacks, NegativeVariancesHideNoOther) {
  render("in.exr", [](int x, int, const std::string& c, float v) {
    if (c.find("Variance") > 99) return v;
    return x == 3 ? -1000.F : 1e4F * v;
  });
  EXPECT_THAT(denoise("in.exr", "out.exr").out, HasSubstr("--variance-kind sample"));
}

TEST_F(Attacks, AVarianceWithHolesIsTold) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  render("whole.exr");
  ASSERT_EQ(denoise("whole.exr", "whole_out.exr").code, 0);
  const auto change = [&](const std::string& name) {
    const std::vector<float> before = beauty("whole.exr"), after = beauty(name);
    double sum = 0;
    for (std::size_t i = 0; i < before.size(); ++i) sum += std::abs(static_cast<double>(after[i] - before[i]));
    return sum;
  };
  render("red.exr", [=](int, int, const std::string& c, float v) { return c.find("Variance.R") < 99 ? nan : v; });
  const Outcome red = denoise("red.exr", "red_out.exr");
  EXPECT_THAT(red.out, HasSubstr("Combined Variance is not used: 960 of its samples are not finite"));
  EXPECT_GT(change("red_out.exr"), 0.5 * change("whole_out.exr"));  // denoised by the noise of the halves
  render("block.exr", [=](int x, int y, const std::string& c, float v) {
    return c.find("Variance.") < 99 && x < 20 && y < 20 ? nan : v;
  });
  EXPECT_THAT(denoise("block.exr", "block_out.exr").out,
              HasSubstr("Combined Variance: 1200 samples are not finite where ViewLayer.Combined is"));
  EXPECT_THAT(run({"inspect", "block.exr"}).out, HasSubstr("1200 samples are not finite"));
}

}  // namespace
}  // namespace polyrecon::testing
