#include "polyrecon/write_result.h"

#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/exr_fixture.h"
#include "io/files/file.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

namespace fs = std::filesystem;

using ::testing::Contains;
using testing::contents;
using ::testing::Each;
using testing::error_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::join;
using testing::layer;
using testing::pattern;
using testing::stored_bytes;
using testing::stored_floats;
using testing::TemporaryFolder;
using testing::TestChannel;
using testing::TestPart;
using testing::write_exr;

Image filled(const Rect& window, int channels, Real value) {
  return {window.width(), window.height(), channels, value};
}

/// Beauty, an identifier layer, a half and a float pass in one part with an odd window.
TestPart render() {
  TestPart part;
  part.channels =
      join({layer("V.Combined", "RGBA", 0, Imf::HALF), layer("V.Diff", "RGB", 10, Imf::HALF), layer("V.Depth", "Z", 20),
            layer("V.Crypto00", "rgba", 30), layer("V.Index", "X", 40, Imf::UINT)});
  part.window = {-3, -7, 40, 61};
  part.display = {0, 0, 32, 48};
  part.edit = [](Imf::Header& header) {
    header.insert("cryptomatte/1/manifest", Imf::StringAttribute("{\"Cube\":\"a8fce865\"}"));
    Imf::addOwner(header, "studio");
    header.pixelAspectRatio() = 2;
  };
  return part;
}

/// (compression, tile side): everything but the beauty stays as it is, bit for bit.
class Case07EveryCompression : public ::testing::TestWithParam<std::tuple<Imf::Compression, int>> {};

TEST_P(Case07EveryCompression, KeepsAllThatWasNotReplaced) {
  const TemporaryFolder folder;
  TestPart part = render();
  part.compression = std::get<0>(GetParam());
  part.tile = std::get<1>(GetParam());
  if (part.tile == 0) part.order = Imf::DECREASING_Y;
  const std::string in = write_exr(folder / "in.exr", {part}), out = folder / "out.exr";
  const ReadResult read = read_frame(in);
  const auto notes = write_result(read.source, {{"V.Combined", filled(part.window, 3, 7)}}, out);

  const FileInfo before = describe_file(in), after = describe_file(out);
  const bool lossy = part.compression >= Imf::PXR24_COMPRESSION;
  EXPECT_EQ(after.parts[0].compression, lossy ? "zip" : before.parts[0].compression);
  EXPECT_EQ(notes.empty(), !lossy);
  EXPECT_EQ(after.parts[0].tiled, before.parts[0].tiled);
  EXPECT_EQ(after.parts[0].data_window, before.parts[0].data_window);
  EXPECT_EQ(after.parts[0].display_window, before.parts[0].display_window);
  ASSERT_EQ(after.parts[0].channels.size(), before.parts[0].channels.size());
  for (const TestChannel& channel : part.channels) {
    const bool replaced = channel.name.find("Combined") != std::string::npos && channel.name.back() != 'A';
    if (replaced) continue;
    EXPECT_EQ(stored_bytes(out, 0, channel.name), stored_bytes(in, 0, channel.name)) << channel.name;
  }
  const Image beauty = read_channels(after, 0, {"V.Combined.R", "V.Combined.G", "V.Combined.B"});
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < beauty.pixels(); ++i) ASSERT_EQ(beauty.plane(c)[i], 7);
  for (std::size_t c = 0; c < before.parts[0].channels.size(); ++c)
    EXPECT_EQ(after.parts[0].channels[c].type, before.parts[0].channels[c].type);
  for (const AttributeInfo& attribute : before.parts[0].attributes) {
    const AttributeInfo* kept = find_attribute(after.parts[0], attribute.name);
    ASSERT_NE(kept, nullptr) << attribute.name;
    EXPECT_EQ(kept->value, attribute.value) << attribute.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Compressions, Case07EveryCompression,
                         ::testing::Combine(::testing::Values(Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION,
                                                              Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
                                                              Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION,
                                                              Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION,
                                                              Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION),
                                            ::testing::Values(0, 16)));

/// What a requested compression makes of a picture next to data; the first channel that it would change, if any.
struct RequestCase {
  Compression compression;
  std::string written, changed;
};

/// Half colours, and next to them ids and vectors as floats, as Cryptomatte and Blender name them.
TestPart picture_and_data(const std::string& ids, const std::string& vector) {
  TestPart part;
  part.channels = join({layer("V.Combined", "RGBA", 0, Imf::HALF), layer("V.Diff", "RGB", 10, Imf::HALF),
                        layer("V.CryptoObject00", ids, 30), layer("V.Denoising Normal", vector, 40)});
  part.window = {-3, -7, 40, 61};
  return part;
}

std::vector<std::string> write_encoded(const std::string& in, const std::string& out, Compression compression) {
  WriteOptions options;
  options.encoding.compression = compression;
  const ReadResult read = read_frame(in);
  return write_result(read.source, {{"V.Combined", filled(read.frame.data_window, 3, Real(0.3))}}, out, options);
}

TEST(RequestedCompression, KeepsTheBitsOfWhatIsNoColour) {
  const std::vector<RequestCase> cases{{Compression::None, "none", ""},
                                       {Compression::Rle, "rle", ""},
                                       {Compression::Zips, "zips", ""},
                                       {Compression::Zip, "zip", ""},
                                       {Compression::Piz, "piz", ""},
                                       {Compression::Pxr24, "zip", "V.CryptoObject00.a"},
                                       {Compression::B44, "b44", ""},
                                       {Compression::B44a, "b44a", ""},
                                       {Compression::Dwaa, "zip", "V.Denoising Normal.Y"},
                                       {Compression::Dwab, "zip", "V.Denoising Normal.Y"}};
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  for (const int tile : {0, 16}) {
    TestPart part = picture_and_data("rgba", "XYZ");
    part.tile = tile;
    const std::string in = write_exr(folder / "in.exr", {part});
    for (const RequestCase& c : cases) {
      const std::vector<std::string> notes = write_encoded(in, out, c.compression);
      EXPECT_EQ(describe_file(out).parts[0].compression, c.written);
      EXPECT_EQ(notes.empty(), c.changed.empty()) << c.written;
      if (!c.changed.empty()) {
        EXPECT_THAT(notes.front(), HasSubstr("would change " + c.changed + ", which is no colour"));
      }
      for (const TestChannel& channel : part.channels)
        if (channel.type == Imf::FLOAT) {
          EXPECT_EQ(stored_bytes(out, 0, channel.name), stored_bytes(in, 0, channel.name)) << channel.name;
        }
      EXPECT_NEAR(static_cast<double>(read_channels(describe_file(out), 0, {"V.Combined.G"}).at(7, 5, 0)), 0.3, 0.003);
    }
  }
}

TEST(RequestedCompression, DwaTakesIdsForColoursByTheirLetters) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  const std::string small = write_exr(folder / "small.exr", {picture_and_data("rgba", "xyz")});
  EXPECT_THAT(write_encoded(small, out, Compression::Dwaa), IsEmpty());
  EXPECT_EQ(describe_file(out).parts[0].compression, "dwaa");
  EXPECT_EQ(stored_bytes(out, 0, "V.CryptoObject00.r"), stored_bytes(small, 0, "V.CryptoObject00.r"));
  EXPECT_NE(stored_bytes(out, 0, "V.Diff.R"), stored_bytes(small, 0, "V.Diff.R"));  // it is lossy

  const std::string capital = write_exr(folder / "capital.exr", {picture_and_data("RGBA", "xyz")});
  EXPECT_THAT(write_encoded(capital, out, Compression::Dwaa), Contains(HasSubstr("V.CryptoObject00.B")));
  EXPECT_EQ(describe_file(out).parts[0].compression, "zip");
  for (const char* letter : {"R", "G", "B", "A"})
    EXPECT_EQ(stored_bytes(out, 0, std::string("V.CryptoObject00.") + letter),
              stored_bytes(capital, 0, std::string("V.CryptoObject00.") + letter));
}

TEST(RequestedCompression, IsChosenForEachPart) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  std::vector<TestPart> parts(3);
  parts[0].name = "V.Combined";
  parts[0].channels = layer("V.Combined", "RGB", 0, Imf::HALF);
  parts[1].name = "V.CryptoObject00";
  parts[1].channels = layer("V.CryptoObject00", "RGBA", 5);
  parts[2].name = "V.Diff";
  parts[2].channels = layer("V.Diff", "RGB", 20, Imf::HALF);
  const std::string in = write_exr(folder / "in.exr", parts);
  EXPECT_THAT(write_encoded(in, out, Compression::Dwab), ::testing::ElementsAre(HasSubstr("V.CryptoObject00")));
  const FileInfo after = describe_file(out);
  EXPECT_EQ(after.parts[0].compression, "dwab");
  EXPECT_EQ(after.parts[1].compression, "zip");
  EXPECT_EQ(after.parts[2].compression, "dwab");
  EXPECT_EQ(stored_bytes(out, 1, "V.CryptoObject00.R"), stored_bytes(in, 1, "V.CryptoObject00.R"));
}

TEST(RequestedCompression, NoSampleBecomesInfinite) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  TestPart part;
  part.channels = join({layer("V.Combined", "RGB", 0, Imf::HALF), layer("V.Diff", "RGB", 0, Imf::HALF)});
  for (TestChannel& channel : part.channels)
    channel.samples = [](int x, int y) { return (x + y) % 2 == 0 ? 65504.0 : 0.0; };
  const std::string in = write_exr(folder / "in.exr", {part});
  EXPECT_THAT(write_encoded(in, out, Compression::Dwaa), Contains(HasSubstr("samples beyond 32752")));
  const Image diffuse = read_channels(describe_file(out), 0, {"V.Diff.R"});
  for (std::size_t i = 0; i < diffuse.pixels(); ++i) EXPECT_TRUE(std::isfinite(diffuse.plane(0)[i]));
}

/// A level of 0 loses least.
TEST(RequestedCompression, TheLevelChoosesTheLoss) {
  const TemporaryFolder folder;
  TestPart part;
  part.window = part.display = {0, 0, 96, 54};
  part.channels = layer("V.Combined", "RGB", 0, Imf::HALF);
  const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}));
  Image image(96, 54, 3);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 54; ++y)
      for (int x = 0; x < 96; ++x) image.at(x, y, c) = static_cast<Real>(testing::grain(x, y, c));
  std::vector<std::uintmax_t> sizes;
  for (const double level : {0.0, 45.0, 400.0}) {
    WriteOptions options;
    options.encoding = {Compression::Dwaa, level};
    write_result(read.source, {{"V.Combined", image}}, folder / "out.exr", options);
    sizes.push_back(fs::file_size(folder / "out.exr"));
  }
  EXPECT_GT(sizes[0], sizes[1]);
  EXPECT_GT(sizes[1], sizes[2]);
}

/// A merged render with data, in one part or in a part for each layer.
std::vector<TestPart> merged_render(bool in_parts) {
  TestPart one;
  one.channels = join({layer("V.Combined", "RGBA", 0, Imf::HALF), layer("V.Combined Variance", "RGB", 5),
                       layer("V.Combined A", "RGB", 6), layer("V.Combined B", "RGB", 7),
                       layer("V.Denoising Albedo", "RGB", 8), layer("V.Denoising Albedo Variance", "RGB", 9),
                       layer("V.CryptoObject00", "rgba", 30), layer("V.Sample Count", "X", 1)});
  if (!in_parts) return {one};
  std::vector<TestPart> parts;
  for (const TestChannel& channel : one.channels) {
    const std::string name = channel.name.substr(0, channel.name.rfind('.'));
    if (parts.empty() || parts.back().name != name) {
      parts.emplace_back();
      parts.back().name = name;
    }
    parts.back().channels.push_back(channel);
  }
  return parts;
}

std::vector<std::string> layers_in(const std::string& path) {
  std::vector<std::string> names;
  for (const PartInfo& part : describe_file(path).parts)
    for (const ChannelInfo& channel : part.channels) {
      const std::string name = channel.name.substr(2, channel.name.rfind('.') - 2);
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  return names;
}

TEST(Contents, AreWhatTheOptionsKeep) {
  using ::testing::UnorderedElementsAre;
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  for (const bool in_parts : {false, true}) {
    const std::string in = write_exr(folder / "in.exr", merged_render(in_parts));
    const ReadResult read = read_frame(in);
    const std::vector<Replacement> picture{{"V.Combined", filled(read.frame.data_window, 3, 7)}};
    WriteOptions options;
    options.keep_working = false;
    EXPECT_THAT(write_result(read.source, picture, out, options), IsEmpty());
    EXPECT_THAT(layers_in(out), UnorderedElementsAre("Combined", "Denoising Albedo", "CryptoObject00"));
    const int part = in_parts ? 2 : 0, before = in_parts ? 6 : 0;
    EXPECT_EQ(stored_bytes(out, part, "V.CryptoObject00.g"), stored_bytes(in, before, "V.CryptoObject00.g"));
    EXPECT_EQ(stored_bytes(out, 0, "V.Combined.A"), stored_bytes(in, 0, "V.Combined.A"));

    options.keep_layers = false;
    options.keep_noisy = true;
    Image error = filled(read.frame.data_window, 1, Real(0.25));
    options.additions = {{"V.Combined", " Error", error}};
    write_result(read.source, picture, out, options);
    EXPECT_THAT(layers_in(out), UnorderedElementsAre("Combined", "Combined Noisy", "Combined Error"));
    EXPECT_THAT(stored_floats(out, 0, "V.Combined Error.X"), Each(0.25F));
    EXPECT_EQ(stored_bytes(out, 0, "V.Combined Noisy.R"), stored_bytes(in, 0, "V.Combined.R"));
    EXPECT_NE(find_attribute(describe_file(out).parts[0], "polyrecon/version"), nullptr);
    EXPECT_EQ(read_frame(out).frame.beauty.name, "V.Combined Noisy");
  }
}

TEST(Contents, AnAdditionIsZeroOutsideOfItsWindow) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.exr";
  TestPart part;
  part.channels = layer("", "RGB");
  const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}));
  WriteOptions options;
  options.additions = {{"RGBA", " Error", filled({0, 0, 2, 6}, 1, 3), {0, 0, 2, 6}}};
  write_result(read.source, {{"RGBA", filled(part.window, 3, 7)}}, out, options);
  const std::vector<float> error = stored_floats(out, 0, "RGBA Error.X");
  EXPECT_EQ(error[1], 3);
  EXPECT_EQ(error[2], 0);
}

TEST(WriteResult, PartsWithoutAReplacementAreCopiedInTheirOwnLossyCompression) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts(3);
  parts[0].channels = layer("V.Crypto00", "rgba");
  parts[1].channels = layer("V.Combined", "RGBA", 5, Imf::HALF);
  parts[2].channels = layer("V.Diff", "RGB", 9, Imf::HALF);
  for (TestPart& part : parts) {
    part.name = part.channels[0].name.substr(0, part.channels[0].name.rfind('.'));
    part.compression = Imf::DWAA_COMPRESSION;
    part.window = {0, 0, 50, 40};
  }
  parts[2].tile = 16;
  const std::string in = write_exr(folder / "in.exr", parts), out = folder / "out.exr";
  const ReadResult read = read_frame(in);
  WriteOptions options;
  options.provenance = {"quality=best", "in.exr", 0.25};
  const auto notes = write_result(read.source, {{"V.Combined", filled(parts[1].window, 3, 1)}}, out, options);
  const FileInfo after = describe_file(out);
  ASSERT_EQ(after.parts.size(), 3u);
  EXPECT_EQ(after.parts[0].compression, "dwaa");
  EXPECT_EQ(after.parts[1].compression, "zip");
  EXPECT_EQ(after.parts[2].compression, "dwaa");
  EXPECT_EQ(after.parts[2].name, "V.Diff");
  EXPECT_THAT(notes, Contains(HasSubstr("V.Combined")));
  for (const int p : {0, 2})
    for (const TestChannel& channel : parts[static_cast<std::size_t>(p)].channels)
      EXPECT_EQ(stored_bytes(out, p, channel.name), stored_bytes(in, p, channel.name)) << channel.name;
  EXPECT_EQ(stored_bytes(out, 1, "V.Combined.A"), stored_bytes(in, 1, "V.Combined.A"));
  EXPECT_EQ(find_attribute(after.parts[0], "polyrecon/settings")->value, "quality=best");
  EXPECT_EQ(find_attribute(after.parts[0], "polyrecon/input")->value, "in.exr");
  EXPECT_EQ(find_attribute(after.parts[0], "polyrecon/estimatedRelMSE")->value, "0.25");
  EXPECT_NE(find_attribute(after.parts[0], "polyrecon/version"), nullptr);
}

TEST(WriteResult, AlphaIsReplacedOnRequest) {
  const TemporaryFolder folder;
  const TestPart part = render();
  const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}));
  const std::string out = folder / "out.exr";
  write_result(read.source, {{read.source.alpha_layer, filled(part.window, 1, Real(0.5)), true}}, out);
  const Image alpha = read_channels(describe_file(out), 0, {"V.Combined.A", "V.Combined.R"});
  EXPECT_EQ(alpha.at(0, 0, 0), Real(0.5));
  EXPECT_EQ(static_cast<double>(alpha.at(0, 0, 1)), pattern(0)(part.window.x0, part.window.y0));
}

TEST(WriteResult, TheNoisyLayerIsKeptOnRequest) {
  const TemporaryFolder folder;
  const TestPart part = render();
  const std::string in = write_exr(folder / "in.exr", {part}), out = folder / "out.exr";
  WriteOptions options;
  options.keep_noisy = true;
  write_result(read_frame(in).source, {{"V.Combined", filled(part.window, 3, 7)}}, out, options);
  for (const char* channel : {"R", "G", "B"})
    EXPECT_EQ(stored_bytes(out, 0, std::string("V.Combined Noisy.") + channel),
              stored_bytes(in, 0, std::string("V.Combined.") + channel));
  const ReadResult again = read_frame(out);
  EXPECT_EQ(again.frame.beauty.name, "V.Combined Noisy");
  EXPECT_EQ(again.frame.prior.name, "V.Combined");
}

TEST(WriteResult, TheNoisyChannelsOfALayerWithoutNameFindAName) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("", "RGB");
  const std::string in = write_exr(folder / "in.exr", {part}), out = folder / "out.exr";
  WriteOptions options;
  options.keep_noisy = true;
  write_result(read_frame(in).source, {{"RGBA", filled(part.window, 3, 7)}}, out, options);
  EXPECT_EQ(stored_bytes(out, 0, "RGBA Noisy.G"), stored_bytes(in, 0, "G"));
  EXPECT_THAT(stored_floats(out, 0, "G"), Each(7.f));
}

TEST(Case28, HalfSamplesSaturate) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("", "RGB", 0, Imf::HALF);
  const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}));
  Image image = filled(part.window, 3, 1);
  image.at(0, 0, 0) = Real(1e6);
  image.at(1, 0, 1) = Real(-1e6);
  image.at(2, 0, 2) = std::numeric_limits<Real>::infinity();
  image.at(3, 0, 0) = Real(65519);  // rounds to 65504 even without help
  const std::string out = folder / "out.exr";
  const auto notes = write_result(read.source, {{"RGBA", image}}, out);
  EXPECT_THAT(notes, Contains(HasSubstr("65504")));
  const Image back = read_channels(describe_file(out), 0, {"R", "G", "B"});
  EXPECT_EQ(back.at(0, 0, 0), 65504);
  EXPECT_EQ(back.at(1, 0, 1), -65504);
  EXPECT_EQ(back.at(2, 0, 2), 65504);
  EXPECT_EQ(back.at(3, 0, 0), 65504);
  EXPECT_EQ(back.at(4, 0, 0), 1);
}

TEST(WriteResult, AGrayLayerTakesTheMeanOfThree) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("beauty", "Y");
  const ReadResult read = read_frame(write_exr(folder / "in.exr", {part}));
  Image image = filled(part.window, 3, 1);
  for (std::size_t i = 0; i < image.pixels(); ++i) image.plane(2)[i] = 4;
  write_result(read.source, {{"beauty", image}}, folder / "out.exr");
  EXPECT_THAT(stored_floats(folder / "out.exr", 0, "beauty.Y"), Each(2.f));
}

/// Lines of 0, 1, 2, ... samples a pixel in one deep channel.
std::vector<Imf::Header> deep_headers(const TestPart& flat) {
  Imf::Header deep(8, 6);
  deep.setName("deep");
  deep.setType(Imf::DEEPSCANLINE);
  deep.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  deep.compression() = Imf::ZIPS_COMPRESSION;
  return {testing::header_of(flat), deep};
}

struct DeepSamples {
  std::vector<unsigned> counts = std::vector<unsigned>(48);
  std::vector<float> values = std::vector<float>(48 * 6, -1);
  std::vector<char*> pointers = std::vector<char*>(48);

  Imf::DeepFrameBuffer buffer() {
    for (std::size_t i = 0; i < 48; ++i) pointers[i] = reinterpret_cast<char*>(&values[6 * i]);
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 32));
    frame.insert(
        "Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(char*), 8 * sizeof(char*), 4));
    return frame;
  }
};

TEST(Case06, DeepPartsAreCopied) {
  const TemporaryFolder folder;
  const std::string in = folder / "in.exr", out = folder / "out.exr";
  TestPart flat;
  flat.name = "beauty";
  flat.channels = layer("", "RGB");
  {
    const auto headers = deep_headers(flat);
    Imf::MultiPartOutputFile file(in.c_str(), headers.data(), 2);
    testing::write_part(file, 0, flat);
    DeepSamples samples;
    for (std::size_t i = 0; i < 48; ++i) {
      samples.counts[i] = static_cast<unsigned>(i / 8);
      for (std::size_t s = 0; s < 6; ++s) samples.values[6 * i + s] = static_cast<float>(10 * i + s);
    }
    Imf::DeepScanLineOutputPart deep(file, 1);
    deep.setFrameBuffer(samples.buffer());
    deep.writePixels(6);
  }
  write_result(read_frame(in).source, {{"beauty", filled(flat.window, 3, 7)}}, out);
  Imf::MultiPartInputFile file(out.c_str());
  Imf::DeepScanLineInputPart deep(file, 1);
  DeepSamples samples;
  deep.setFrameBuffer(samples.buffer());
  deep.readPixelSampleCounts(0, 5);
  deep.readPixels(0, 5);
  EXPECT_EQ(samples.counts[47], 5u);
  EXPECT_EQ(samples.values[6 * 47 + 4], 474);
  EXPECT_EQ(samples.values[6 * 47 + 5], -1);
}

TEST(Case06, MipMappedPartsAreCopiedWithAllLevels) {
  const TemporaryFolder folder;
  const std::string in = folder / "in.exr", out = folder / "out.exr";
  TestPart flat;
  flat.name = "beauty";
  flat.channels = layer("", "RGB");
  for (const auto mode : {Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    Imf::Header mip({{0, 0}, {7, 5}}, {{0, 0}, {32, 16}});  // levels 33x17, 16x8, 8x4, ... rounded down
    mip.setName("texture");
    mip.setType(Imf::TILEDIMAGE);
    mip.setTileDescription({8, 8, mode});
    mip.channels().insert("Y", Imf::Channel(Imf::HALF));
    mip.compression() = Imf::B44_COMPRESSION;
    {
      const std::vector<Imf::Header> headers{testing::header_of(flat), mip};
      Imf::MultiPartOutputFile file(in.c_str(), headers.data(), 2);
      testing::write_part(file, 0, flat);
      Imf::TiledOutputPart tiles(file, 1);
      std::vector<half> samples(33 * 17);
      for (int ly = 0; ly < tiles.numYLevels(); ++ly)
        for (int lx = 0; lx < tiles.numXLevels(); ++lx) {
          if (!tiles.isValidLevel(lx, ly)) continue;
          for (std::size_t i = 0; i < samples.size(); ++i)
            samples[i] = static_cast<float>(lx + 10 * ly) + static_cast<float>(i % 7);
          Imf::FrameBuffer buffer;
          buffer.insert("Y", Imf::Slice::Make(Imf::HALF, samples.data(), {0, 0}, 33, 17, 2, 66));
          tiles.setFrameBuffer(buffer);
          tiles.writeTiles(0, tiles.numXTiles(lx) - 1, 0, tiles.numYTiles(ly) - 1, lx, ly);
        }
    }
    write_result(read_frame(in).source, {{"beauty", filled(flat.window, 3, 7)}}, out);
    const auto level = [](const std::string& path, int lx, int ly) {
      Imf::MultiPartInputFile file(path.c_str());
      Imf::TiledInputPart tiles(file, 1);
      std::vector<std::uint16_t> samples(33 * 17);
      Imf::FrameBuffer buffer;
      buffer.insert("Y", Imf::Slice::Make(Imf::HALF, samples.data(), {0, 0}, 33, 17, 2, 66));
      tiles.setFrameBuffer(buffer);
      tiles.readTiles(0, tiles.numXTiles(lx) - 1, 0, tiles.numYTiles(ly) - 1, lx, ly);
      return samples;
    };
    EXPECT_EQ(level(out, 2, 2), level(in, 2, 2));
    EXPECT_NE(level(out, 2, 2), level(in, 1, 1));
    EXPECT_TRUE(describe_file(out).parts[1].mipmapped);
  }
}

TEST(Case04, ADamagedPartIsNotCopiedInSilence) {
  const TemporaryFolder folder;
  std::vector<TestPart> parts(2);
  parts[0].channels = layer("beauty", "RGB");
  parts[0].name = "beauty";
  parts[1].channels = layer("mask", "RGB");
  parts[1].name = "mask";
  parts[1].window = {0, 0, 64, 64};
  const std::string in = write_exr(folder / "in.exr", parts);
  std::string bytes = contents(in);
  for (std::size_t i = bytes.size() - 200; i < bytes.size(); ++i) bytes[i] = static_cast<char>(0x55);
  testing::put_contents(in, bytes);
  const ReadResult read = read_frame(in);
  const Error error = error_of([&] {
    write_result(read.source, {{"beauty", filled(parts[0].window, 3, 7)}}, folder / "out.exr");
  });
  EXPECT_EQ(error.code(), ExitCode::BadInput);
  EXPECT_THAT(error.what(), HasSubstr("mask"));
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteResult, AnInputThatChangedMeanwhileIsNoticed) {
  const TemporaryFolder folder;
  TestPart part = render();
  const std::string path = write_exr(folder / "in.exr", {part});
  const ReadResult read = read_frame(path);
  part.channels.erase(part.channels.begin());
  write_exr(path, {part});
  const Error error = error_of([&] {
    write_result(read.source, {{"V.Combined", filled(part.window, 3, 7)}}, folder / "out.exr");
  });
  EXPECT_EQ(error.code(), ExitCode::BadInput);
  EXPECT_THAT(error.what(), HasSubstr("changed"));
}

TEST(Case13, OutputMayBeTheInput) {
  const TemporaryFolder folder;
  const TestPart part = render();
  const std::string path = write_exr(folder / "in.exr", {part});
  fs::create_hard_link(path, folder / "hard.exr");
  const std::string before = contents(path);
  write_result(read_frame(path).source, {{"V.Combined", filled(part.window, 3, 7)}}, path);
  EXPECT_EQ(read_channels(describe_file(path), 0, {"V.Combined.R"}).at(0, 0, 0), 7);
  EXPECT_EQ(contents(folder / "hard.exr"), before);
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(Case13, ALinkToTheInputIsReplacedAndTheInputSurvives) {
  const TemporaryFolder folder;
  const TestPart part = render();
  const std::string path = write_exr(folder / "in.exr", {part}), link = folder / "link.exr";
  fs::create_symlink(path, link);
  const std::string before = contents(path);
  write_result(read_frame(path).source, {{"V.Combined", filled(part.window, 3, 7)}}, link);
  EXPECT_EQ(contents(path), before);
  EXPECT_FALSE(fs::is_symlink(link));
  EXPECT_EQ(read_channels(describe_file(link), 0, {"V.Combined.R"}).at(0, 0, 0), 7);
}

TEST(Case07, ThreeHundredChannels) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("V.Combined", "RGB");
  for (int i = 0; i < 99; ++i)
    for (const TestChannel& channel : layer("V.Pass" + std::to_string(i), "RGB", i, i % 2 ? Imf::HALF : Imf::FLOAT))
      part.channels.push_back(channel);
  const std::string in = write_exr(folder / "in.exr", {part}), out = folder / "out.exr";
  EXPECT_THAT(write_result(read_frame(in).source, {{"V.Combined", filled(part.window, 3, 7)}}, out), IsEmpty());
  for (std::size_t c = 3; c < part.channels.size(); ++c)
    ASSERT_EQ(stored_bytes(out, 0, part.channels[c].name), stored_bytes(in, 0, part.channels[c].name));
}

TEST(WriteResult, PlainImagesBecomeExr) {
  const TemporaryFolder folder;
  std::string bytes = "PF\n2 1\n-1.0\n";
  bytes.append(std::string(24, '\0'));
  testing::put_contents(folder / "in.pfm", bytes);
  const ReadResult read = read_frame(folder / "in.pfm");
  const auto notes = write_result(read.source, {{read.frame.beauty.name, Image(2, 1, 3, 5)}}, folder / "out.exr");
  EXPECT_THAT(notes, Contains(HasSubstr("OpenEXR")));
  EXPECT_THAT(stored_floats(folder / "out.exr", 0, "B"), Each(5.f));
}

TEST(Case05, MapsKeepWindowsNamesAndAttributes) {
  const TemporaryFolder folder;
  const Rect window{-2, 1, 30, 50}, display{0, 0, 16, 16};
  Image samples(window.width(), window.height(), 1, 3);
  samples.at(31, 48, 0) = 12;
  write_maps(folder / "map.exr", {{"samples.Y", samples}, {"importance.Y", filled(window, 1, 1)}}, window, display,
             {{{"polyrecon/frame", "in.exr"}}, {{"polyrecon/budget", 32}}});
  const FileInfo file = describe_file(folder / "map.exr");
  EXPECT_EQ(file.parts[0].data_window, window);
  EXPECT_EQ(file.parts[0].display_window, display);
  EXPECT_EQ(find_attribute(file.parts[0], "polyrecon/budget")->value, "32");
  EXPECT_EQ(find_attribute(file.parts[0], "polyrecon/frame")->value, "in.exr");
  const auto back = stored_floats(folder / "map.exr", 0, "samples.Y");
  EXPECT_EQ(back.back(), 12);
  EXPECT_EQ(back.front(), 3);
}

}  // namespace
}  // namespace polyrecon
