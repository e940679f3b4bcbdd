#include "io/files/file.h"

#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "polyrecon/error.h"
#include "support/allocations.h"

namespace polyrecon {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::layer;
using testing::pattern;
using testing::put_contents;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

TestPart mixed_part() {
  TestPart part;
  part.channels = {{"C.B", Imf::HALF, pattern(1)},
                   {"C.G", Imf::HALF, pattern(2)},
                   {"C.R", Imf::FLOAT, pattern(3)},
                   {"id.X", Imf::UINT, pattern(4)}};
  part.window = {-5, -3, 70, 60};  // 75 x 63: several chunks of every compression, a last one that is not full
  part.display = {0, 0, 64, 48};
  return part;
}

/// Number of samples that differ from the pattern that channel c was made of.
std::size_t differences(const Image& image, int c, const Rect& window, const testing::Samples& samples) {
  std::size_t count = 0;
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x)
      count += static_cast<double>(image.at(x - window.x0, y - window.y0, c)) != samples(x, y);
  return count;
}

/// (compression, tile side): the lossless ones give back every sample of every type.
class LosslessFile : public ::testing::TestWithParam<std::tuple<Imf::Compression, int>> {};

TEST_P(LosslessFile, GivesBackEverySampleOfEveryType) {
  const TemporaryFolder folder;
  TestPart part = mixed_part();
  part.compression = std::get<0>(GetParam());
  part.tile = std::get<1>(GetParam());
  const FileInfo file = describe_file(write_exr(folder / "a.exr", {part}));
  EXPECT_EQ(file.parts[0].tiled, part.tile > 0);
  EXPECT_EQ(file.parts[0].data_window, part.window);
  EXPECT_EQ(file.parts[0].display_window, part.display);
  const Image image = read_channels(file, 0, {"C.R", "C.G", "C.B", "id.X"});
  EXPECT_EQ(image.width(), 75);
  EXPECT_EQ(image.height(), 63);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(differences(image, c, part.window, pattern(c < 3 ? 3 - c : 4)), 0u) << c;
}

INSTANTIATE_TEST_SUITE_P(Compressions, LosslessFile,
                         ::testing::Combine(::testing::Values(Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION,
                                                              Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
                                                              Imf::PIZ_COMPRESSION),
                                            ::testing::Values(0, 32)));

/// The lossy ones keep uint samples, and a constant image to a hundredth.
class LossyFile : public ::testing::TestWithParam<std::tuple<Imf::Compression, int>> {};

TEST_P(LossyFile, IsReadAsItsCodecGivesIt) {
  const TemporaryFolder folder;
  TestPart part = mixed_part();
  for (auto& channel : part.channels)
    if (channel.type != Imf::UINT) channel.samples = testing::constant(2.5);
  part.compression = std::get<0>(GetParam());
  part.tile = std::get<1>(GetParam());
  const FileInfo file = describe_file(write_exr(folder / "a.exr", {part}));
  const Image image = read_channels(file, 0, {"C.R", "C.G", "id.X"});
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    ASSERT_NEAR(static_cast<double>(image.plane(0)[i]), 2.5, 0.025);
    ASSERT_NEAR(static_cast<double>(image.plane(1)[i]), 2.5, 0.025);
  }
  EXPECT_EQ(differences(image, 2, part.window, pattern(4)), 0u);
}

INSTANTIATE_TEST_SUITE_P(Compressions, LossyFile,
                         ::testing::Combine(::testing::Values(Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION,
                                                              Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION,
                                                              Imf::DWAB_COMPRESSION),
                                            ::testing::Values(0, 32)));

TEST(DescribeFile, FindsPartsChannelsAndAttributes) {
  const TemporaryFolder folder;
  TestPart first = mixed_part(), second;
  first.name = "alpha";
  first.edit = [](Imf::Header& header) { header.insert("note", Imf::StringAttribute("hello")); };
  second.name = "beta";
  second.view = "left";
  second.display = first.display;
  second.channels = layer("N", "XYZ");
  second.compression = Imf::DWAB_COMPRESSION;
  second.order = Imf::DECREASING_Y;
  const FileInfo file = describe_file(write_exr(folder / "a.exr", {first, second}));
  ASSERT_EQ(file.parts.size(), 2u);
  EXPECT_EQ(file.format, "openexr");
  EXPECT_EQ(file.parts[0].name, "alpha");
  EXPECT_EQ(file.parts[1].view, "left");
  EXPECT_EQ(file.parts[1].compression, "dwab");
  ASSERT_EQ(file.parts[0].channels.size(), 4u);
  EXPECT_EQ(file.parts[0].channels[3].name, "id.X");
  EXPECT_STREQ(name_of(file.parts[0].channels[3].type), "uint");
  EXPECT_STREQ(name_of(file.parts[0].channels[0].type), "half");
  ASSERT_NE(find_attribute(file.parts[0], "note"), nullptr);
  EXPECT_EQ(find_attribute(file.parts[0], "note")->value, "hello");
  EXPECT_EQ(find_attribute(file.parts[0], "none"), nullptr);
  const Image normal = read_channels(file, 1, {"N.Z"});
  EXPECT_EQ(differences(normal, 0, second.window, pattern(2)), 0u);
}

TEST(DescribeFile, AMissingFileIsMissing) {
  const Error error = error_of([] { describe_file("/nowhere/frame.exr"); });
  EXPECT_EQ(error.code(), ExitCode::Missing);
}

TEST(Case02, EmptyAndZeroedFilesAreNotYetRendered) {
  const TemporaryFolder folder;
  for (const std::size_t size : {0u, 4096u}) {
    put_contents(folder / "a.exr", std::string(size, '\0'));
    const Error error = error_of([&] { describe_file(folder / "a.exr"); });
    EXPECT_EQ(error.code(), ExitCode::BadInput);
    EXPECT_THAT(error.what(), HasSubstr("not yet rendered"));
  }
}

TEST(DescribeFile, OtherFilesAreNoInput) {
  const TemporaryFolder folder;
  put_contents(folder / "a.exr", "once upon a time");
  EXPECT_EQ(error_of([&] { describe_file(folder / "a.exr"); }).code(), ExitCode::BadInput);
  EXPECT_EQ(error_of([&] { describe_file(folder / ""); }).code(), ExitCode::BadInput);
}

/// A file while a renderer writes it: the header is there, the pixels are missing, the offsets are zero.
TEST(Case02, UnwrittenChunksAreToldApart) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("", "RGB");
  part.window = part.display = {0, 0, 32, 64};  // 4 chunks of 16 lines
  const std::string path = folder / "a.exr";
  for (const int lines : {0, 16, 48}) {
    {
      Imf::Header header = testing::header_of(part);
      Imf::MultiPartOutputFile file(path.c_str(), &header, 1);
      Imf::OutputPart output(file, 0);
      std::map<std::string, std::vector<char>> bytes;
      for (const auto& channel : part.channels) bytes[channel.name] = bytes_of(channel, part.window);
      output.setFrameBuffer(buffer_of(part, bytes));
      if (lines > 0) output.writePixels(lines);
    }
    const Error error = error_of([&] { describe_file(path); });
    EXPECT_EQ(error.code(), ExitCode::BadInput);
    EXPECT_THAT(error.what(), HasSubstr(lines == 0 ? "not yet rendered" : "incomplete")) << lines;
    EXPECT_THAT(error.what(), HasSubstr(path));
  }
}

/// Reads everything that the file seems to have.
void read_all(const std::string& path) {
  const FileInfo file = describe_file(path);
  for (std::size_t p = 0; p < file.parts.size(); ++p) {
    std::vector<std::string> names;
    for (const ChannelInfo& channel : file.parts[p].channels) names.push_back(channel.name);
    read_channels(file, static_cast<int>(p), names);
  }
}

/// (several parts, tile side)
class Case01CutFile : public ::testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(Case01CutFile, IsNoticedWhereverItIsCut) {
  const TemporaryFolder folder;
  TestPart part = mixed_part();
  part.name = "first";
  part.tile = std::get<1>(GetParam());
  std::vector<TestPart> parts{part};
  if (std::get<0>(GetParam())) {
    part.name = "second";
    parts.push_back(part);
  }
  const std::string whole = testing::contents(write_exr(folder / "whole.exr", parts));
  ASSERT_NO_THROW(read_all(folder / "whole.exr"));
  const std::string path = folder / "cut.exr";
  for (std::size_t size = whole.size() - 1; size > 8; size -= size > whole.size() - 40 ? 1 : 211 < size ? 211 : 1) {
    put_contents(path, whole.substr(0, size));
    const Error error = error_of([&] { read_all(path); });
    ASSERT_EQ(error.code(), ExitCode::BadInput) << size;
    ASSERT_THAT(error.what(), HasSubstr("incomplete")) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, Case01CutFile, ::testing::Combine(::testing::Bool(), ::testing::Values(0, 16)));

TEST(Case01, ADamagedChunkIsNamedByPartAndScanline) {
  const TemporaryFolder folder;
  TestPart part = mixed_part();  // lines -3 .. 59 in chunks of 16: the last one begins at line 45
  part.name = "noisy";
  const std::string path = write_exr(folder / "a.exr", {part});
  std::string bytes = testing::contents(path);
  for (std::size_t i = bytes.size() - 400; i < bytes.size(); ++i) bytes[i] = static_cast<char>(0x55);
  put_contents(path, bytes);
  const Error error = error_of([&] { read_all(path); });
  EXPECT_EQ(error.code(), ExitCode::BadInput);
  EXPECT_THAT(error.what(), HasSubstr("noisy"));
  EXPECT_THAT(error.what(), HasSubstr("scanline 45"));
}

/// Replaces the 4 bytes after `key` + skip by a number.
void patch(std::string& bytes, const std::string& key, std::size_t skip, std::uint32_t value) {
  const std::size_t at = bytes.find(key);
  ASSERT_NE(at, std::string::npos);
  for (std::size_t i = 0; i < 4; ++i) bytes[at + key.size() + skip + i] = static_cast<char>(value >> (8 * i));
}

/// Files of a few hundred bytes that claim much more are refused before anything of that size is allocated.
class Case03HeaderBomb : public ::testing::TestWithParam<std::function<void(std::string&)>> {};

TEST_P(Case03HeaderBomb, IsRefusedBeforeMemoryIsTaken) {
  const TemporaryFolder folder;
  TestPart part;
  part.channels = layer("", "RGB");
  part.tile = 8;
  std::string bytes = testing::contents(write_exr(folder / "a.exr", {part}));
  GetParam()(bytes);
  put_contents(folder / "a.exr", bytes);
  const test::PeakAllocation peak;
  EXPECT_EQ(error_of([&] { read_all(folder / "a.exr"); }).code(), ExitCode::BadInput);
  if (test::counts_allocations()) {
    EXPECT_LT(peak.bytes(), std::size_t{1} << 20);
  }
}

// dataWindow\0 box2i\0 size(4) xmin ymin xmax ymax
const std::string window_attribute("dataWindow\0box2i\0", 17);
// tiles\0 tiledesc\0 size(4) xsize ysize mode
const std::string tiles_attribute("tiles\0tiledesc\0", 15);

INSTANTIATE_TEST_SUITE_P(
    Claims, Case03HeaderBomb,
    ::testing::Values(
        [](std::string& b) { patch(b, window_attribute, 12, 60000), patch(b, window_attribute, 16, 60000); },
        [](std::string& b) { patch(b, window_attribute, 12, 0x7ffffffe); },
        [](std::string& b) { patch(b, window_attribute, 16, 0x7ffffffe); },
        [](std::string& b) { patch(b, window_attribute, 4, 0x80000000), patch(b, window_attribute, 12, 0x7fffffff); },
        [](std::string& b) { patch(b, window_attribute, 12, 0xfffffff0); },  // xMax < xMin
        [](std::string& b) { patch(b, tiles_attribute, 4, 0x7fffffff), patch(b, tiles_attribute, 8, 0x7fffffff); },
        [](std::string& b) {
          patch(b, tiles_attribute, 4, 1), patch(b, tiles_attribute, 8, 1), patch(b, window_attribute, 12, 16000),
              patch(b, window_attribute, 16, 16000);
        },
        [](std::string& b) { patch(b, tiles_attribute, 4, 0); },
        [](std::string& b) { patch(b, window_attribute, 0, 0x7fffffff); },  // the size of the attribute itself
        [](std::string& b) { patch(b, std::string("channels\0chlist\0", 16), 0, 0xffffffff); },
        // a size that is not the type's: OpenEXR reads on from another place
        [](std::string& b) { patch(b, std::string("pixelAspectRatio\0float\0", 23), 0, 40); }));

/// The smallest files for their size are accepted: images of one value in every compression.
TEST(Case03, ConstantImagesAreAccepted) {
  const TemporaryFolder folder;
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    TestPart part;
    part.window = part.display = {0, 0, 2048, 256};  // 256 lines: the largest chunk
    part.compression = static_cast<Imf::Compression>(compression);
    part.channels = testing::flat_layer("", "RGB", 0);
    for (auto& channel : part.channels) channel.type = Imf::HALF;
    EXPECT_NO_THROW(describe_file(write_exr(folder / "a.exr", {part}))) << compression;
  }
}

TEST(Case03, LimitsAreObeyed) {
  const TemporaryFolder folder;
  const std::string path = write_exr(folder / "a.exr", {mixed_part()});
  ReadLimits limits;
  limits.max_pixels = 75 * 63 - 1;
  EXPECT_EQ(error_of([&] { describe_file(path, limits); }).code(), ExitCode::BadInput);
  limits = {};
  limits.max_channels = 3;
  EXPECT_EQ(error_of([&] { describe_file(path, limits); }).code(), ExitCode::BadInput);
  limits = {};
  limits.max_bytes = 75 * 63 * 2 * sizeof(Real) - 1;
  const FileInfo file = describe_file(path, limits);
  EXPECT_EQ(error_of([&] { read_channels(file, 0, {"C.R", "C.G"}, limits); }).code(), ExitCode::OutOfMemory);
  EXPECT_NO_THROW(read_channels(file, 0, {"C.R"}, limits));
}

TEST(Case06, SubsampledPartsAreUnsupported) {
  const TemporaryFolder folder;
  const std::string path = folder / "yc.exr";
  Imf::Header header(8, 8);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.channels().insert("BY", Imf::Channel(Imf::HALF, 2, 2));
  header.setType(Imf::SCANLINEIMAGE);
  {
    std::vector<half> y(64), by(16);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::HALF, y.data(), {0, 0}, 8, 8, 2, 16));
    buffer.insert("BY", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(by.data()), 2, 8, 2, 2));
    Imf::MultiPartOutputFile file(path.c_str(), &header, 1);
    Imf::OutputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.writePixels(8);
  }
  const FileInfo file = describe_file(path);
  EXPECT_FALSE(file.parts[0].readable());
  EXPECT_THAT(error_of([&] { read_channels(file, 0, {"Y"}); }).what(), HasSubstr("unsupported"));
}

/// A portable float map of 2 x 2 pixels: "PF", size, scale < 0 for little endian, rows from the lowest to the
/// uppermost.
TEST(PlainImage, RowsOfAPfmAreTurned) {
  const TemporaryFolder folder;
  std::string bytes = "PF\n2 2\n-1.0\n";
  for (const float value : {1.f, 2.f, 3.f, 4.f, 5.f, 6.f, 7.f, 8.f, 9.f, 10.f, 11.f, 12.f})
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  put_contents(folder / "a.pfm", bytes);
  const FileInfo file = describe_file(folder / "a.pfm");
  ASSERT_EQ(file.parts[0].channels.size(), 3u);
  const Image image = read_channels(file, 0, {"R", "G", "B"});
  EXPECT_EQ(image.at(0, 0, 0), 7);  // the upper row is the last in the file
  EXPECT_EQ(image.at(1, 0, 2), 12);
  EXPECT_EQ(image.at(0, 1, 1), 2);
  put_contents(folder / "a.pfm", bytes.substr(0, bytes.size() - 4));
  EXPECT_THAT(error_of([&] { read_all(folder / "a.pfm"); }).what(), HasSubstr("incomplete"));
  put_contents(folder / "a.pfm", "PF\n2000000 2000000\n-1.0\n");
  EXPECT_EQ(error_of([&] { describe_file(folder / "a.pfm"); }).code(), ExitCode::BadInput);
}

}  // namespace
}  // namespace polyrecon
