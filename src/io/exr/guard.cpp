#include "io/exr/guard.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <string_view>

#include "core/bad_file.h"
#include "io/exr/chunks.h"
#include "io/exr/compression.h"

namespace polyrecon {
namespace {

constexpr std::uint64_t small_claim = std::uint64_t{16} << 20;  ///< Bytes that may be claimed without question.
constexpr std::uint64_t minimum_chunk_bytes = 16;               ///< Its offset in the table, its place and its size.

std::uint32_t little_endian(const std::array<char, 4>& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = (value << 8) | static_cast<unsigned char>(bytes[i]);
  return value;
}

/// Reads the numbers and names of a header, and knows how much of the file is left.
class HeaderWalk {
 public:
  HeaderWalk(const std::string& path, std::uint64_t bytes)
      : path_(path), stream_(path, std::ios::binary), bytes_(bytes) {}

  std::uint32_t number() {
    std::array<char, 4> raw{};
    if (!stream_.read(raw.data(), raw.size())) cut();
    position_ += raw.size();
    return little_endian(raw);
  }

  int byte() {
    char raw = 0;
    if (!stream_.get(raw)) cut();
    ++position_;
    return static_cast<unsigned char>(raw);
  }

  /// A name of at most 255 bytes and its closing zero.
  std::string name() {
    std::string text;
    for (char c = 0; text.size() <= 255; text += c) {
      if (!stream_.get(c)) cut();
      ++position_;
      if (c == '\0') return text;
    }
    refuse_file(path_, "incomplete or damaged header (a name longer than 255 bytes)");
  }

  void skip(std::uint32_t size, const std::string& attribute) {
    if (size > bytes_ - position_)
      refuse_file(path_, fmt::format("incomplete or damaged header (attribute {} claims {} bytes)", attribute, size));
    position_ += size;
    stream_.seekg(static_cast<std::streamoff>(position_));
  }

  std::uint64_t position() const { return position_; }

  [[noreturn]] void unsupported(const std::string& what) { refuse_file(path_, what); }

  [[noreturn]] void damaged(const std::string& attribute) {
    refuse_file(path_, fmt::format("incomplete or damaged header (attribute {})", attribute));
  }

 private:
  [[noreturn]] void cut() { refuse_file(path_, "incomplete: the file ends inside its header"); }

  const std::string& path_;
  std::ifstream stream_;
  std::uint64_t bytes_, position_ = 0;
};

/// Bytes of the types whose size is fixed, 0 for others. OpenEXR reads these whatever the size field says: where the
/// two differ, it would go on to read from another place than this walk.
std::uint32_t fixed_size(std::string_view type) {
  static const std::map<std::string_view, std::uint32_t> sizes{{"box2f", 16},
                                                               {"box2i", 16},
                                                               {"chromaticities", 32},
                                                               {"compression", 1},
                                                               {"deepImageState", 1},
                                                               {"double", 8},
                                                               {"envmap", 1},
                                                               {"float", 4},
                                                               {"int", 4},
                                                               {"keycode", 28},
                                                               {"lineOrder", 1},
                                                               {"m33d", 72},
                                                               {"m33f", 36},
                                                               {"m44d", 128},
                                                               {"m44f", 64},
                                                               {"rational", 8},
                                                               {"tiledesc", 9},
                                                               {"timecode", 8},
                                                               {"v2d", 16},
                                                               {"v2f", 8},
                                                               {"v2i", 8},
                                                               {"v3d", 24},
                                                               {"v3f", 12},
                                                               {"v3i", 12}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

/// Walks over an attribute's value; the counts inside must agree with its size too. OpenEXR calls a header damaged if
/// it does not know its compression, so that is looked at here.
void walk_value(HeaderWalk& walk, const std::string& attribute, const std::string& type, std::uint32_t size) {
  constexpr std::uint32_t channel_bytes = 16;  // after its name: type, linearity, samplings
  const std::uint64_t end = walk.position() + size;
  if (const std::uint32_t fixed = fixed_size(type); fixed != 0 && fixed != size) walk.damaged(attribute);
  if (type == "chlist") {  // ends with an empty name
    std::string last_name = "?";
    while (walk.position() < end && !(last_name = walk.name()).empty()) walk.skip(channel_bytes, attribute);
    if (!last_name.empty()) walk.damaged(attribute);
  } else if (type == "stringvector") {
    while (walk.position() < end) walk.skip(walk.number(), attribute);
  } else if (type == "compression") {
    if (const std::string obstacle = compression_obstacle(walk.byte()); !obstacle.empty()) walk.unsupported(obstacle);
  } else if (type == "preview") {
    const std::uint64_t width = walk.number(), height = walk.number();
    if (width > size || height > size || width * height * 4 + 8 != size) walk.damaged(attribute);
    walk.skip(size - 8, attribute);
  } else {
    walk.skip(size, attribute);
  }
  if (walk.position() != end) walk.damaged(attribute);
}

/// No encoder packs pixels more than this to one: deflate reaches 1032, and PXR24 takes a quarter off before; RLE makes
/// 2 bytes of 128; PIZ's Huffman code 10 bits of 261 words; B44A 3 bytes of 32; DWA 1 zero-run symbol of a block of 64,
/// deflated. What later releases of OpenEXR add (HTJ2K and ZSTD in 3.4 and 3.5) makes tens of bytes of a chunk of one
/// value, whatever its size.
std::uint64_t packing_limit(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return 1;
    case Imf::RLE_COMPRESSION:
      return 64;
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 1400;
    case Imf::PIZ_COMPRESSION:
      return 512;
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
      return 16;
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return 65536;
    default:
      return std::uint64_t{1} << 24;
  }
}

std::string part_title(const Imf::Header& header, std::size_t index) {
  return header.hasName() ? fmt::format("part {} \"{}\"", index, header.name()) : fmt::format("part {}", index);
}

std::uint64_t bytes_per_pixel(const Imf::Header& header) {
  std::uint64_t bytes = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    bytes += c.channel().type == Imf::HALF ? 2 : 4;
  return bytes;
}

}  // namespace

std::uint64_t check_attribute_sizes(const std::string& path, std::uint64_t file_bytes) {
  HeaderWalk walk(path, file_bytes);
  walk.number();  // the magic number, known to be right
  const std::uint32_t version = walk.number();
  const bool multi_part = (version & Imf::MULTI_PART_FILE_FLAG) != 0;
  for (bool first_in_header = true;;) {
    const std::string attribute = walk.name();
    if (attribute.empty()) {
      if (!multi_part || first_in_header) return walk.position();
      first_in_header = true;
      continue;
    }
    first_in_header = false;
    const std::string type = walk.name();
    walk_value(walk, attribute, type, walk.number());
  }
}

void check_claims(const std::string& path, std::uint64_t file_bytes, const std::vector<Imf::Header>& headers,
                  const ReadLimits& limits) {
  if (headers.size() > limits.max_parts)
    refuse_file(path, fmt::format("{} parts, more than {}", headers.size(), limits.max_parts));
  std::uint64_t channels = 0, chunks = 0, claimed = 0, least = 0;
  for (std::size_t p = 0; p < headers.size(); ++p) {
    const Imf::Header& header = headers[p];
    const auto& window = header.dataWindow();
    const std::uint64_t width = window_side(window.min.x, window.max.x),
                        height = window_side(window.min.y, window.max.y);
    if (width > limits.max_pixels || height > limits.max_pixels || width * height > limits.max_pixels)
      refuse_file(path, fmt::format("{}: {} x {} pixels, more than --max-pixels {}", part_title(header, p), width,
                                    height, limits.max_pixels));
    if (is_tiled_part(header)) {
      const auto& tiles = header.tileDescription();
      if (tiles.xSize == 0 || tiles.ySize == 0 || std::uint64_t{tiles.xSize} * tiles.ySize > limits.max_pixels)
        refuse_file(path, fmt::format("{}: tiles of {} x {} pixels", part_title(header, p), tiles.xSize, tiles.ySize));
      if (std::uint64_t{tiles.xSize} * tiles.ySize * bytes_per_pixel(header) > small_claim &&
          (tiles.xSize > width || tiles.ySize > height))
        refuse_file(path, fmt::format("{}: tiles of {} x {} pixels in an image of {} x {}", part_title(header, p),
                                      tiles.xSize, tiles.ySize, width, height));
    }
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++channels;
    chunks += chunk_count(header);
    if (header.hasType() && Imf::isDeepData(header.type())) continue;  // as many samples as it likes, also none
    claimed += width * height * bytes_per_pixel(header);
    least += width * height * bytes_per_pixel(header) / packing_limit(header.compression());
  }
  if (channels > limits.max_channels)
    refuse_file(path, fmt::format("{} channels, more than --max-channels {}", channels, limits.max_channels));
  if (chunks > file_bytes / minimum_chunk_bytes || (claimed > small_claim && least > file_bytes))
    refuse_file(path, fmt::format("incomplete: the header claims {} chunks and {} MB of pixels, the file has {} bytes",
                                  chunks, claimed >> 20, file_bytes));
}

}  // namespace polyrecon
