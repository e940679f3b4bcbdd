#include "io/exr/bands.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputPart.h>

#include <algorithm>
#include <string_view>

#include "core/parallel.h"
#include "io/exr/chunks.h"

namespace polyrecon {

std::size_t size_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

std::vector<std::size_t> hashes_of(const NativeBand& band) {
  std::vector<std::size_t> hashes(band.channels.size());
  in_parallel(hashes.size(), [&](std::size_t c) {
    const std::vector<char>& samples = band.channels[c].samples;
    hashes[c] = std::hash<std::string_view>{}({samples.data(), samples.size()});
  });
  return hashes;
}

NativeBand::NativeBand(const Imf::Header& header)
    : x0(header.dataWindow().min.x), width(header.dataWindow().max.x - header.dataWindow().min.x + 1) {
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    channels.push_back({c.name(), c.channel().type, {}});
}

void NativeBand::take_lines(int first, int last_excluded) {
  y0 = first;
  y1 = last_excluded;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(y1 - y0);
  in_parallel(channels.size(), [&](std::size_t c) { channels[c].samples.resize(pixels * size_of(channels[c].type)); });
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
  if (is_tiled_part(header)) lines = static_cast<int>(header.tileDescription().ySize);
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
  NativeBand band(header);
  if (is_tiled_part(header)) {
    Imf::TiledOutputPart tiles(output, part);
    for (const auto& [y0, y1] : bands_of(header)) {
      band.take_lines(y0, y1);
      make(band);
      tiles.setFrameBuffer(band.buffer());
      const int row = (y0 - header.dataWindow().min.y) / static_cast<int>(header.tileDescription().ySize);
      tiles.writeTiles(0, tiles.numXTiles() - 1, row, row);
    }
    return;
  }
  Imf::OutputPart scanlines(output, part);
  for (const auto& [y0, y1] : bands_of(header, lines)) {
    band.take_lines(y0, y1);
    make(band);
    scanlines.setFrameBuffer(band.buffer());
    scanlines.writePixels(y1 - y0);
  }
}

}  // namespace polyrecon
