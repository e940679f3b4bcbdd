#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/rect.h"
#include "polyrecon/error.h"
#include "polyrecon/image.h"

namespace polyrecon::testing {

/// A folder for the files of one test, removed with them.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "polyrecon-test-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

using Samples = std::function<double(int x, int y)>;  ///< In file coordinates.

/// Values that every type holds exactly: multiples of 1/8 (of 1 for uint) below 64, unlike from channel to channel.
inline Samples pattern(int seed) {
  return [seed](std::int64_t x, std::int64_t y) {
    return static_cast<double>(((x * 7 + y * 13 + seed * 5) % 61 + 61) % 61);
  };
}

inline Samples constant(double value) {
  return [value](int, int) { return value; };
}

/// Noise without sums: 0 to 1, unlike from pixel to pixel and from seed to seed.
inline double grain(int x, int y, int seed) {
  const unsigned place = static_cast<unsigned>(x) * 7919U + static_cast<unsigned>(y) * 104729U;
  const unsigned mixed = (place + static_cast<unsigned>(seed) * 1299709U) * 2654435761U;
  return (mixed >> 16 & 1023U) / 1023.0;
}

struct TestChannel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  Samples samples = constant(0);
};

struct TestPart {
  std::vector<TestChannel> channels;
  Rect window{0, 0, 8, 6};
  Rect display{0, 0, 8, 6};
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  std::string name, view;
  int tile = 0;  ///< Side of the tiles, 0 for scanlines.
  Imf::LineOrder order = Imf::INCREASING_Y;
  std::function<void(Imf::Header&)> edit = [](Imf::Header&) {};
};

/// A part whose channels cover a part of the picture.
inline TestPart part_over(const Rect& window, const Rect& display, std::vector<TestChannel> channels) {
  TestPart part;
  part.window = window;
  part.display = display;
  part.channels = std::move(channels);
  return part;
}

/// For TestPart::edit: sets an attribute of text.
inline std::function<void(Imf::Header&)> with_text(const std::string& name, const std::string& value) {
  return [=](Imf::Header& header) { header.insert(name, Imf::StringAttribute(value)); };
}

inline Imf::Header header_of(const TestPart& part) {
  Imf::Header header({{part.display.x0, part.display.y0}, {part.display.x1 - 1, part.display.y1 - 1}},
                     {{part.window.x0, part.window.y0}, {part.window.x1 - 1, part.window.y1 - 1}});
  header.compression() = part.compression;
  header.lineOrder() = part.order;
  for (const TestChannel& channel : part.channels) header.channels().insert(channel.name, Imf::Channel(channel.type));
  if (!part.name.empty()) header.setName(part.name);
  if (!part.view.empty()) header.setView(part.view);
  header.setType(part.tile > 0 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  if (part.tile > 0)
    header.setTileDescription({static_cast<unsigned>(part.tile), static_cast<unsigned>(part.tile), Imf::ONE_LEVEL});
  part.edit(header);
  return header;
}

/// All samples of one channel as the bytes of its type.
inline std::vector<char> bytes_of(const TestChannel& channel, const Rect& window) {
  std::vector<char> bytes;
  const auto append = [&](const auto& value) {
    const auto* raw = reinterpret_cast<const char*>(&value);
    bytes.insert(bytes.end(), raw, raw + sizeof value);
  };
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x) {
      const double value = channel.samples(x, y);
      if (channel.type == Imf::HALF)
        append(half(static_cast<float>(value)));
      else if (channel.type == Imf::FLOAT)
        append(static_cast<float>(value));
      else
        append(static_cast<unsigned>(value));
    }
  return bytes;
}

inline Imf::FrameBuffer buffer_of(const TestPart& part, std::map<std::string, std::vector<char>>& bytes) {
  Imf::FrameBuffer buffer;
  for (const TestChannel& channel : part.channels) {
    const std::size_t size = channel.type == Imf::HALF ? 2 : 4;
    buffer.insert(channel.name,
                  Imf::Slice::Make(channel.type, bytes[channel.name].data(), {part.window.x0, part.window.y0},
                                   part.window.width(), part.window.height(), size,
                                   size * static_cast<std::size_t>(part.window.width())));
  }
  return buffer;
}

inline void write_part(Imf::MultiPartOutputFile& file, int index, const TestPart& part) {
  std::map<std::string, std::vector<char>> bytes;
  for (const TestChannel& channel : part.channels) bytes[channel.name] = bytes_of(channel, part.window);
  const Imf::FrameBuffer buffer = buffer_of(part, bytes);
  if (part.tile > 0) {
    Imf::TiledOutputPart tiles(file, index);
    tiles.setFrameBuffer(buffer);
    tiles.writeTiles(0, tiles.numXTiles() - 1, 0, tiles.numYTiles() - 1);
  } else {
    Imf::OutputPart lines(file, index);
    lines.setFrameBuffer(buffer);
    lines.writePixels(part.window.height());
  }
}

inline std::string write_exr(const std::string& path, const std::vector<TestPart>& parts) {
  std::vector<Imf::Header> headers;
  for (const TestPart& part : parts) headers.push_back(header_of(part));
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (std::size_t p = 0; p < parts.size(); ++p) write_part(file, static_cast<int>(p), parts[p]);
  return path;
}

/// Writes a file for each part, r0.exr, r1.exr, ... Returns their paths.
inline std::vector<std::string> write_all(const TemporaryFolder& folder, const std::vector<TestPart>& parts) {
  std::vector<std::string> paths;
  for (const TestPart& part : parts)
    paths.push_back(write_exr(folder / ("r" + std::to_string(paths.size()) + ".exr"), {part}));
  return paths;
}

/// Channels LAYER.R, LAYER.G, LAYER.B (or other letters) with consecutive patterns.
inline std::vector<TestChannel> layer(const std::string& name, const std::string& letters, int seed = 0,
                                      Imf::PixelType type = Imf::FLOAT) {
  std::vector<TestChannel> channels;
  for (const char letter : letters)
    channels.push_back({name.empty() ? std::string(1, letter) : name + "." + letter, type, pattern(seed++)});
  return channels;
}

inline std::vector<TestChannel> flat_layer(const std::string& name, const std::string& letters, double value) {
  std::vector<TestChannel> channels = layer(name, letters);
  for (TestChannel& channel : channels) channel.samples = constant(value);
  return channels;
}

inline std::vector<TestChannel> join(const std::vector<std::vector<TestChannel>>& layers) {
  std::vector<TestChannel> all;
  for (const auto& l : layers) all.insert(all.end(), l.begin(), l.end());
  return all;
}

/// Whether channel c holds the pattern of that seed. window: that of the image, in file coordinates.
inline bool holds(const Image& image, int c, const Rect& window, int seed) {
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x)
      if (static_cast<double>(image.at(x - window.x0, y - window.y0, c)) != pattern(seed)(x, y)) return false;
  return !image.empty();
}

/// The same for an image whose window begins at (0, 0).
inline bool holds(const Image& image, int c, int seed) { return holds(image, c, image.bounds(), seed); }

/// One channel of a flat part, decoded with OpenEXR alone, in the bytes of its own type.
inline std::vector<char> stored_bytes(const std::string& path, int part, const std::string& channel) {
  Imf::MultiPartInputFile file(path.c_str());
  Imf::InputPart input(file, part);
  const auto& window = input.header().dataWindow();
  const Imf::Channel* found = input.header().channels().findChannel(channel);
  if (!found) throw std::runtime_error("no channel " + channel);
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  const std::size_t size = found->type == Imf::HALF ? 2 : 4;
  std::vector<char> bytes(size * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  Imf::FrameBuffer buffer;
  buffer.insert(channel, Imf::Slice::Make(found->type, bytes.data(), window.min, width, height, size,
                                          size * static_cast<std::size_t>(width)));
  input.setFrameBuffer(buffer);
  input.readPixels(window.min.y, window.max.y);
  return bytes;
}

inline std::vector<float> stored_floats(const std::string& path, int part, const std::string& channel) {
  const std::vector<char> bytes = stored_bytes(path, part, channel);
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

inline std::string contents(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void put_contents(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The error that action throws; the test fails where it throws none.
template <class Action>
Error error_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no Error was thrown";
  return {ExitCode::Done, ""};
}

}  // namespace polyrecon::testing
