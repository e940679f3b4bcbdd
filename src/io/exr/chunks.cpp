#include "io/exr/chunks.h"

#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/OpenEXRConfig.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "core/bad_file.h"

namespace polyrecon {
namespace {

std::uint64_t ceil_divide(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }

std::uint64_t lines_per_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      break;
  }
#if OPENEXR_VERSION_MAJOR > 3 || OPENEXR_VERSION_MINOR >= 3
  return static_cast<std::uint64_t>(Imf::getCompressionNumScanlines(compression));  // compressions of later releases
#else
  return 1;
#endif
}

/// Sizes of all levels of one side of a mip- or rip-map.
std::vector<std::uint64_t> level_sizes(std::uint64_t size, std::uint64_t levels_for, Imf::LevelRoundingMode rounding) {
  std::vector<std::uint64_t> sizes;
  for (std::uint64_t l = levels_for;; l = rounding == Imf::ROUND_UP ? ceil_divide(l, 2) : l / 2) {
    sizes.push_back(std::max<std::uint64_t>(size, 1));
    size = rounding == Imf::ROUND_UP ? ceil_divide(size, 2) : size / 2;
    if (l <= 1) return sizes;
  }
}

std::uint64_t tile_count(const Imf::TileDescription& tiles, std::uint64_t width, std::uint64_t height) {
  const auto across = [&](std::uint64_t w) { return ceil_divide(w, tiles.xSize); };
  const auto down = [&](std::uint64_t h) { return ceil_divide(h, tiles.ySize); };
  if (tiles.mode == Imf::ONE_LEVEL) return across(width) * down(height);
  std::uint64_t count = 0;
  if (tiles.mode == Imf::MIPMAP_LEVELS) {
    const std::uint64_t longest = std::max(width, height);
    const auto widths = level_sizes(width, longest, tiles.roundingMode);
    const auto heights = level_sizes(height, longest, tiles.roundingMode);
    for (std::size_t l = 0; l < widths.size(); ++l) count += across(widths[l]) * down(heights[l]);
    return count;
  }
  for (std::uint64_t w : level_sizes(width, width, tiles.roundingMode))
    for (std::uint64_t h : level_sizes(height, height, tiles.roundingMode)) count += across(w) * down(h);
  return count;
}

bool is_deep(const Imf::Header& header) { return header.hasType() && Imf::isDeepData(header.type()); }

std::uint64_t lines_per_chunk(const Imf::Header& header) {
  return is_deep(header) ? 1 : lines_per_chunk(header.compression());
}

/// Which pixels a chunk holds, by its place in the part's table.
std::string chunk_title(const Imf::Header& header, std::size_t part, std::uint64_t index) {
  const std::string title =
      header.hasName() ? fmt::format("part {} \"{}\"", part, header.name()) : fmt::format("part {}", part);
  const auto& window = header.dataWindow();
  if (!is_tiled_part(header)) {
    const auto lines = static_cast<std::int64_t>(lines_per_chunk(header));
    const std::int64_t first = window.min.y + static_cast<std::int64_t>(index) * lines;
    return fmt::format("{}, scanlines {} to {}", title, first, std::min<std::int64_t>(first + lines - 1, window.max.y));
  }
  const Imf::TileDescription& tiles = header.tileDescription();
  if (tiles.mode != Imf::ONE_LEVEL) return fmt::format("{}, tile {} of all levels", title, index);
  const std::uint64_t across = ceil_divide(window_side(window.min.x, window.max.x), tiles.xSize);
  return fmt::format("{}, tile ({}, {})", title, index % across, index / across);
}

/// Reads little-endian numbers anywhere in a file.
class FileBytes {
 public:
  FileBytes(const std::string& path, std::uint64_t bytes)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)), bytes_(bytes) {}
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  ~FileBytes() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  std::uint64_t size() const { return bytes_; }

  bool read(std::uint64_t at, unsigned char* to, std::size_t count) const {
    return ::pread(descriptor_, to, count, static_cast<off_t>(at)) == static_cast<ssize_t>(count);
  }

 private:
  int descriptor_;
  std::uint64_t bytes_;
};

std::uint64_t number(const unsigned char* raw, int size) {
  std::uint64_t value = 0;
  for (int i = size; i-- > 0;) value = (value << 8) | raw[i];
  return value;
}

/// A chunk is [its part's number,] its place, its packed sizes, its packed bytes.
struct ChunkLayout {
  bool several_parts, tiled, deep;

  std::size_t place() const { return several_parts ? 4 : 0; }
  std::size_t sizes() const { return place() + (tiled ? 16 : 4); }
  std::size_t packed() const { return sizes() + (deep ? 24 : 4); }
};

constexpr std::size_t longest_chunk_header = 44;

/// The fault of a chunk; empty if all its bytes are there.
std::string fault_of(const FileBytes& file, std::uint64_t offset, const ChunkLayout& layout, std::size_t part) {
  std::array<unsigned char, longest_chunk_header> raw{};
  if (offset > file.size() || file.size() - offset < layout.packed() || !file.read(offset, raw.data(), layout.packed()))
    return "the file ends before it";
  if (layout.several_parts && number(raw.data(), 4) != part) return "it is marked as another part's";
  const unsigned char* sizes = raw.data() + layout.sizes();
  const std::uint64_t rest = file.size() - offset - layout.packed();
  const std::uint64_t first = number(sizes, layout.deep ? 8 : 4), second = layout.deep ? number(sizes + 8, 8) : 0;
  return first > rest || second > rest - first ? "the file ends inside it" : "";
}

std::vector<std::uint64_t> read_table(const FileBytes& file, const std::string& path, std::uint64_t begin,
                                      std::uint64_t chunks) {
  std::vector<unsigned char> raw(chunks * 8);
  if (!file.read(begin, raw.data(), raw.size()))
    refuse_file(path, "incomplete: the file ends inside its table of chunks");
  std::vector<std::uint64_t> offsets(chunks);
  for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = number(raw.data() + 8 * i, 8);
  return offsets;
}

}  // namespace

bool is_tiled_part(const Imf::Header& header) {
  return header.hasType() ? Imf::isTiled(header.type()) : header.hasTileDescription();
}

std::uint64_t chunk_count(const Imf::Header& header) {
  const auto& window = header.dataWindow();
  const std::uint64_t width = window_side(window.min.x, window.max.x), height = window_side(window.min.y, window.max.y);
  if (is_tiled_part(header)) return tile_count(header.tileDescription(), width, height);
  return ceil_divide(height, lines_per_chunk(header));
}

void check_chunks(const std::string& path, std::uint64_t file_bytes, std::uint64_t table_begin,
                  const std::vector<Imf::Header>& headers) {
  const FileBytes file(path, file_bytes);
  std::uint64_t written = 0, absent = 0;
  std::string first_absent, first_fault;
  for (std::size_t p = 0; p < headers.size(); ++p) {
    const std::uint64_t chunks = chunk_count(headers[p]);
    const ChunkLayout layout{headers.size() > 1, is_tiled_part(headers[p]), is_deep(headers[p])};
    const auto offsets = read_table(file, path, table_begin, chunks);
    table_begin += chunks * 8;
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      if (offsets[i] == 0) {
        if (absent++ == 0) first_absent = chunk_title(headers[p], p, i);
        continue;
      }
      ++written;
      if (!first_fault.empty()) continue;
      const std::string fault = fault_of(file, offsets[i], layout, p);
      if (!fault.empty()) first_fault = fmt::format("{} cannot be read ({})", chunk_title(headers[p], p, i), fault);
    }
  }
  if (written == 0) refuse_file(path, "not yet rendered: no pixel is written");
  if (absent > 0)
    refuse_file(path, fmt::format("incomplete: {} of {} chunks are not written, the first is {}", absent,
                                  absent + written, first_absent));
  if (!first_fault.empty()) refuse_file(path, fmt::format("incomplete: {}", first_fault));
}

}  // namespace polyrecon
