// Writes the seeds of the fuzzer: crops of a few pixels from the samples, in every form that an EXR file can have.
//   make_seeds SAMPLES_FOLDER TARGET_FOLDER

#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfDeepTiledOutputPart.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/exr_fixture.h"

namespace {

namespace fs = std::filesystem;
using namespace polyrecon::testing;
using polyrecon::Rect;

constexpr int crop_width = 12, crop_height = 9, crop_left = 60, crop_top = 40;

constexpr std::array compressions{"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};

/// A crop of one part, moved to the origin. Samples, types and names are kept.
TestPart crop(const std::string& path, int index) {
  Imf::MultiPartInputFile file(path.c_str());
  const Imf::Header& header = file.header(index);
  TestPart part;
  part.name = header.hasName() ? header.name() : "";
  part.window = part.display = Rect{0, 0, crop_width, crop_height};
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    const Imf::PixelType type = c.channel().type;
    const std::vector<char> bytes = stored_bytes(path, index, c.name());
    const int width = header.dataWindow().max.x - header.dataWindow().min.x + 1;
    part.channels.push_back({c.name(), type, [bytes, width, type](int x, int y) {
                               const auto i = static_cast<std::size_t>((y + crop_top) * width + x + crop_left);
                               if (type == Imf::HALF) return double{reinterpret_cast<const half*>(bytes.data())[i]};
                               return double{reinterpret_cast<const float*>(bytes.data())[i]};
                             }});
  }
  return part;
}

std::vector<TestPart> crops(const std::string& path, int parts) {
  std::vector<TestPart> all;
  for (int p = 0; p < parts; ++p) all.push_back(crop(path, p));
  return all;
}

/// The channels of all parts in one part, as Blender 3.4 and most renderers write them.
TestPart joined(const std::vector<TestPart>& parts) {
  TestPart one = parts.front();
  one.name.clear();
  for (std::size_t p = 1; p < parts.size(); ++p)
    one.channels.insert(one.channels.end(), parts[p].channels.begin(), parts[p].channels.end());
  one.edit = [](Imf::Header& header) {
    header.insert("cycles.ViewLayer.samples", Imf::StringAttribute("16"));
    Imf::addOwner(header, "nobody");
  };
  return one;
}

void write_deep(const std::string& path, bool tiled, Imf::Compression compression) {
  Imf::Header header(crop_width, crop_height);
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  header.compression() = compression;
  header.setType(tiled ? Imf::DEEPTILE : Imf::DEEPSCANLINE);
  header.setName("deep");
  if (tiled) header.setTileDescription({8, 8, Imf::ONE_LEVEL});
  std::array<unsigned, crop_width * crop_height> counts{};
  std::array<std::array<half, 3>, crop_width * crop_height> red{};
  std::array<std::array<float, 3>, crop_width * crop_height> depth{};
  std::array<half*, crop_width * crop_height> reds{};
  std::array<float*, crop_width * crop_height> depths{};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = static_cast<unsigned>(i % 4);
    reds[i] = red[i].data();
    depths[i] = depth[i].data();
    for (std::size_t s = 0; s < 3; ++s) depth[i][s] = static_cast<float>(i + s);
  }
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), sizeof(unsigned) * crop_width));
  buffer.insert("R", Imf::DeepSlice(Imf::HALF, reinterpret_cast<char*>(reds.data()), sizeof(half*),
                                    sizeof(half*) * crop_width, sizeof(half)));
  buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(depths.data()), sizeof(float*),
                                    sizeof(float*) * crop_width, sizeof(float)));
  TestPart flat;
  flat.name = "flat";
  flat.window = flat.display = Rect{0, 0, crop_width, crop_height};
  flat.channels = layer("", "RGB");
  const std::array headers{header, header_of(flat)};
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  if (tiled) {
    Imf::DeepTiledOutputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.writeTiles(0, part.numXTiles() - 1, 0, part.numYTiles() - 1);
  } else {
    Imf::DeepScanLineOutputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.writePixels(crop_height);
  }
  write_part(file, 1, flat);
}

/// Writes a part with the levels of a mipmap or ripmap, and a flat part.
void write_levels(const std::string& path, Imf::LevelMode mode, Imf::LevelRoundingMode rounding) {
  Imf::Header header(crop_width, crop_height);
  header.channels().insert("extra.R", Imf::Channel(Imf::HALF));
  header.setType(Imf::TILEDIMAGE);
  header.setName("levels");
  header.setTileDescription({4, 4, mode, rounding});
  TestPart flat;
  flat.name = "flat";
  flat.window = flat.display = Rect{0, 0, crop_width, crop_height};
  flat.channels = layer("", "RGBA", 0, Imf::HALF);
  const std::array headers{header, header_of(flat)};
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  std::vector<half> samples(crop_width * crop_height, half(0.5F));
  Imf::TiledOutputPart tiles(file, 0);
  for (int ly = 0; ly < tiles.numYLevels(); ++ly)
    for (int lx = 0; lx < tiles.numXLevels(); ++lx) {
      if (mode == Imf::MIPMAP_LEVELS && lx != ly) continue;
      Imf::FrameBuffer buffer;
      buffer.insert("extra.R", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(samples.data()), sizeof(half),
                                          sizeof(half) * crop_width));
      tiles.setFrameBuffer(buffer);
      tiles.writeTiles(0, tiles.numXTiles(lx) - 1, 0, tiles.numYTiles(ly) - 1, lx, ly);
    }
  write_part(file, 1, flat);
}

/// Writes channels Y, RY and BY; the last two have a sample for 2 x 2 pixels.
void write_luminance_chroma(const std::string& path) {
  Imf::Header header(crop_width, 8);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.channels().insert("RY", Imf::Channel(Imf::HALF, 2, 2));
  header.channels().insert("BY", Imf::Channel(Imf::HALF, 2, 2));
  header.setType(Imf::SCANLINEIMAGE);
  std::vector<half> samples(crop_width * 8, half(0.25F));
  Imf::FrameBuffer buffer;
  auto* raw = reinterpret_cast<char*>(samples.data());
  buffer.insert("Y", Imf::Slice(Imf::HALF, raw, sizeof(half), sizeof(half) * crop_width));
  for (const char* chroma : {"RY", "BY"})
    buffer.insert(chroma, Imf::Slice(Imf::HALF, raw, sizeof(half), sizeof(half) * crop_width, 2, 2));
  Imf::MultiPartOutputFile file(path.c_str(), &header, 1);
  Imf::OutputPart part(file, 0);
  part.setFrameBuffer(buffer);
  part.writePixels(8);
}

void write_stereo(const std::string& path) {
  TestPart part;
  part.window = Rect{-3, -2, crop_width - 3, crop_height - 2};
  part.display = Rect{0, 0, crop_width, crop_height};
  part.channels = join({layer("", "RGB"), layer("right", "RGB", 4), layer("N", "XYZ", 9)});
  part.edit = [](Imf::Header& header) { Imf::addMultiView(header, {"left", "right"}); };
  write_exr(path, {part});
}

void make_seeds(const fs::path& samples, const fs::path& target) {
  const std::vector<TestPart> study = crops((samples / "study_small_0.exr").string(), 7);
  const std::vector<TestPart> lighthouse = crops((samples / "lighthouse_16.exr").string(), 8);
  const auto to = [&](const std::string& name) { return (target / (name + ".exr")).string(); };
  for (std::size_t c = 0; c < compressions.size(); ++c) {
    const auto compression = static_cast<Imf::Compression>(c);
    const std::string name = compressions[c];
    std::vector<TestPart> several = {study[0], study[2], lighthouse[4]};
    for (TestPart& part : several) part.compression = compression;
    several[1].tile = 4;
    write_exr(to("parts-" + name), several);
    TestPart one = joined({study[0], study[1], study[3], lighthouse[4]});
    one.compression = compression;
    write_exr(to("single-" + name), {one});
    one.tile = 8;
    one.channels.resize(6);
    write_exr(to("tiles-" + name), {one});
  }
  TestPart down = joined({study[0]});
  down.order = Imf::DECREASING_Y;
  write_exr(to("decreasing"), {down});
  write_deep(to("deep-lines"), false, Imf::ZIPS_COMPRESSION);
  write_deep(to("deep-lines-rle"), false, Imf::RLE_COMPRESSION);
  write_deep(to("deep-tiles"), true, Imf::NO_COMPRESSION);
  write_levels(to("mipmap"), Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN);
  write_levels(to("ripmap"), Imf::RIPMAP_LEVELS, Imf::ROUND_UP);
  write_luminance_chroma(to("luminance-chroma"));
  write_stereo(to("stereo"));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    fs::create_directories(argv[2]);
    make_seeds(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "make_seeds: %s\n", problem.what());
    return 1;
  }
}
