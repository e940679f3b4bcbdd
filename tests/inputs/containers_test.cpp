// Files whose pixels this build cannot read: each is refused with what it is and what to do.
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr_fixture.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"

namespace polyrecon {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::layer;
using testing::TemporaryFolder;
using testing::TestPart;
using testing::write_exr;

/// A file that claims a compression of this number.
std::string compressed_by(const TemporaryFolder& folder, char number) {
  TestPart part;
  part.channels = layer("", "RGB");
  std::string bytes = testing::contents(write_exr(folder / "zip.exr", {part}));
  const std::string attribute("compression\0compression\0\1\0\0\0", 28);
  const std::size_t at = bytes.find(attribute);
  if (at == std::string::npos) throw std::runtime_error("no compression");
  bytes[at + attribute.size()] = number;
  const std::string path = folder / "new.exr";
  testing::put_contents(path, bytes);
  return path;
}

TEST(Containers, CompressionsOfLaterReleasesAreNamed) {
  const TemporaryFolder folder;
  struct Case {
    char number;
    const char* name;
  };
  for (const Case& c : {Case{10, "HTJ2K"}, Case{11, "HTJ2K"}, Case{13, "ZSTD"}}) {
    if (c.number < Imf::NUM_COMPRESSION_METHODS) continue;  // this OpenEXR can read it
    const std::string path = compressed_by(folder, c.number);
    const Error error = error_of([&] { describe_file(path); });
    EXPECT_EQ(error.code(), ExitCode::BadInput);
    EXPECT_EQ(error.what(), path + ": compressed by " + c.name + ", which OpenEXR " +
                                std::to_string(OPENEXR_VERSION_MAJOR) + "." + std::to_string(OPENEXR_VERSION_MINOR) +
                                " of this build cannot read; save as ZIP");
  }
}

TEST(Containers, AnUnknownCompressionIsDamage) {
  const TemporaryFolder folder;
  const std::string path = compressed_by(folder, 99);
  EXPECT_THAT(error_of([&] { describe_file(path); }).what(), HasSubstr("damaged"));
}

void expect_refused(const std::string& path, const std::string& kind, const std::string& advice) {
  const auto read = error_of([&] { read_frame(path); });
  EXPECT_EQ(read.code(), ExitCode::BadInput);
  EXPECT_THAT(read.what(), HasSubstr(path + ": the beauty is " + kind));
  EXPECT_THAT(read.what(), HasSubstr(advice));
  const std::string copy = path + ".copy";
  std::filesystem::copy_file(path, copy);
  const auto merged = error_of([&] { merge({path, copy}, path + ".merged"); });
  EXPECT_EQ(merged.code(), ExitCode::BadInput);
  EXPECT_THAT(merged.what(), HasSubstr("the beauty is " + kind));
}

TEST(Containers, Deep) {
  const TemporaryFolder folder;
  const std::string path = folder / "deep.exr";
  constexpr int width = 4, height = 3;
  {
    Imf::Header header(width, height);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    for (const char* name : {"R", "G", "B", "A", "Z"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    std::vector<unsigned> counts(width * height, 1);
    std::vector<float> values(width * height, 0.5F);
    std::vector<float*> pointers;
    for (float& value : values) pointers.push_back(&value);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), sizeof(unsigned) * width));
    for (const char* name : {"R", "G", "B", "A", "Z"})
      buffer.insert(name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(float*),
                                         sizeof(float*) * width, sizeof(float)));
    Imf::DeepScanLineOutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
  }
  expect_refused(path, "deep", "save a flat image");
}

TEST(Containers, MipMapped) {
  const TemporaryFolder folder;
  const std::string path = folder / "mip.exr";
  TestPart part;
  part.channels = layer("", "RGB");
  part.window = part.display = {0, 0, 8, 8};
  part.tile = 8;
  part.edit = [](Imf::Header& header) { header.setTileDescription({8, 8, Imf::MIPMAP_LEVELS}); };
  {
    const Imf::Header header = testing::header_of(part);
    Imf::MultiPartOutputFile file(path.c_str(), &header, 1);
    Imf::TiledOutputPart tiles(file, 0);
    std::map<std::string, std::vector<char>> bytes;
    for (const auto& channel : part.channels) bytes[channel.name] = testing::bytes_of(channel, part.window);
    tiles.setFrameBuffer(testing::buffer_of(part, bytes));
    for (int level = 0; level < tiles.numLevels(); ++level) tiles.writeTile(0, 0, level);
  }
  expect_refused(path, "mip-mapped", "save one level");
}

TEST(Containers, MessagesNameThePart) {
  const TemporaryFolder folder;
  const std::string path = folder / "parts.exr";
  TestPart albedo, beauty;
  albedo.name = "albedo";
  beauty.name = "picture";
  albedo.window = albedo.display = beauty.window = beauty.display = {0, 0, 8, 8};
  albedo.channels = layer("albedo", "RGB");
  beauty.channels = layer("beauty", "RGB");
  beauty.tile = 8;
  beauty.edit = [](Imf::Header& header) { header.setTileDescription({8, 8, Imf::MIPMAP_LEVELS}); };
  {
    const std::vector<Imf::Header> headers{testing::header_of(albedo), testing::header_of(beauty)};
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
    std::map<std::string, std::vector<char>> bytes;
    for (const TestPart& part : {albedo, beauty})
      for (const auto& channel : part.channels) bytes[channel.name] = testing::bytes_of(channel, part.window);
    Imf::OutputPart lines(file, 0);
    lines.setFrameBuffer(testing::buffer_of(albedo, bytes));
    lines.writePixels(8);
    Imf::TiledOutputPart tiles(file, 1);
    tiles.setFrameBuffer(testing::buffer_of(beauty, bytes));
    for (int level = 0; level < tiles.numLevels(); ++level) tiles.writeTile(0, 0, level);
  }
  const char* message = "the beauty (part 1 \"picture\") is mip-mapped";
  EXPECT_THAT(error_of([&] { read_frame(path); }).what(), HasSubstr(message));
  std::filesystem::copy_file(path, path + ".copy");
  EXPECT_THAT(error_of([&] { merge({path, path + ".copy"}, folder / "merged.exr"); }).what(), HasSubstr(message));
}

TEST(Containers, Subsampled) {
  const TemporaryFolder folder;
  const std::string path = folder / "sub.exr";
  {
    Imf::Header header(8, 8);
    for (const char* name : {"R", "G"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    header.channels().insert("B", Imf::Channel(Imf::FLOAT, 2, 2));
    header.setType(Imf::SCANLINEIMAGE);
    std::vector<float> full(64, 1.0F), quarter(16, 1.0F);
    Imf::FrameBuffer buffer;
    for (const char* name : {"R", "G"}) buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, full.data(), {0, 0}, 8, 8));
    buffer.insert("B", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(quarter.data()), 4, 16, 2, 2));
    Imf::MultiPartOutputFile file(path.c_str(), &header, 1);
    Imf::OutputPart lines(file, 0);
    lines.setFrameBuffer(buffer);
    lines.writePixels(8);
  }
  expect_refused(path, "subsampled (channel B has a sample for 2 x 2 pixels", "save R, G and B of every pixel");
}

}  // namespace
}  // namespace polyrecon
