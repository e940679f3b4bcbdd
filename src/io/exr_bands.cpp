#include "io/exr_bands.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputPart.h>

#include <algorithm>
#include <string_view>

namespace polyrecon {
namespace {

bool is_tiled(const Imf::Header& header) {
  return header.hasType() ? Imf::isTiled(header.type()) : header.hasTileDescription();
}

}  // namespace

std::size_t size_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

std::size_t hash_of(const NativeChannel& channel) {
  return std::hash<std::string_view>{}({channel.samples.data(), channel.samples.size()});
}

NativeBand::NativeBand(const Imf::Header& header, int first, int last_excluded)
    : x0(header.dataWindow().min.x),
      width(header.dataWindow().max.x - header.dataWindow().min.x + 1),
      y0(first),
      y1(last_excluded) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(y1 - y0);
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    channels.push_back({c.name(), c.channel().type, std::vector<char>(pixels * size_of(c.channel().type))});
}

NativeChannel* NativeBand::find(const std::string& name) {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const NativeChannel& c) { return c.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

Imf::FrameBuffer NativeBand::buffer() {
  Imf::FrameBuffer buffer;
  for (NativeChannel& channel : channels) {
    const std::size_t size = size_of(channel.type);
    buffer.insert(channel.name, Imf::Slice::Make(channel.type, channel.samples.data(), Imath::V2i(x0, y0), width,
                                                 y1 - y0, size, size * static_cast<std::size_t>(width)));
  }
  return buffer;
}

std::vector<std::pair<int, int>> bands_of(const Imf::Header& header, int lines) {
  const int first = header.dataWindow().min.y, end = header.dataWindow().max.y + 1;
  if (is_tiled(header)) lines = static_cast<int>(header.tileDescription().ySize);
  std::vector<std::pair<int, int>> bands;
  for (int y = first; y < end; y += std::min(lines, end - y)) bands.emplace_back(y, y + std::min(lines, end - y));
  if (header.lineOrder() == Imf::DECREASING_Y) std::reverse(bands.begin(), bands.end());
  return bands;
}

void read_band(Imf::InputPart& input, NativeBand& band) {
  input.setFrameBuffer(band.buffer());
  input.readPixels(band.y0, band.y1 - 1);
}

void write_bands(Imf::MultiPartOutputFile& output, int part, const std::function<void(NativeBand&)>& make, int lines) {
  const Imf::Header& header = output.header(part);
  if (is_tiled(header)) {
    Imf::TiledOutputPart tiles(output, part);
    for (const auto& [y0, y1] : bands_of(header)) {
      NativeBand band(header, y0, y1);
      make(band);
      tiles.setFrameBuffer(band.buffer());
      const int row = (y0 - header.dataWindow().min.y) / static_cast<int>(header.tileDescription().ySize);
      tiles.writeTiles(0, tiles.numXTiles() - 1, row, row);
    }
    return;
  }
  Imf::OutputPart scanlines(output, part);
  for (const auto& [y0, y1] : bands_of(header, lines)) {
    NativeBand band(header, y0, y1);
    make(band);
    scanlines.setFrameBuffer(band.buffer());
    scanlines.writePixels(y1 - y0);
  }
}

}  // namespace polyrecon
