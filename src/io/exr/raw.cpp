#include "io/exr/raw.h"

#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "io/exr/chunks.h"
#include "io/exr/guard.h"

namespace polyrecon {
namespace {

/// Packed bytes of one part, chunk by chunk, found through the table of offsets.
class RawPart {
 public:
  RawPart(const std::string& path, int part)
      : path_(path), bytes_(std::filesystem::file_size(path)), stream_(path, std::ios::binary) {
    const Imf::MultiPartInputFile file(path.c_str(), 0, false);
    const std::string& type = file.header(part).type();
    tiled_ = Imf::isTiled(type);
    deep_ = Imf::isDeepData(type);
    several_parts_ = file.parts() > 1;
    std::uint64_t table = check_attribute_sizes(path, bytes_);
    for (int p = 0; p < part; ++p) table += sizeof(std::uint64_t) * chunk_count(file.header(p));
    stream_.seekg(static_cast<std::streamoff>(table));
    offsets_.resize(chunk_count(file.header(part)));
    for (std::uint64_t& offset : offsets_) offset = number(sizeof offset);
  }

  std::size_t chunks() const { return offsets_.size(); }

  /// A chunk as it stands in the file, from its coordinates on.
  std::vector<char> chunk(std::size_t index) {
    const std::uint64_t begin = offsets_[index] + (several_parts_ ? 4 : 0);  // the part's number
    const std::uint64_t sizes = begin + (tiled_ ? 16 : 4);                   // tile and level, or scanline
    stream_.seekg(static_cast<std::streamoff>(sizes));
    std::uint64_t end = 0;
    if (deep_) {
      const std::uint64_t counts = number(8), samples = number(8);  // then the unpacked size
      end = sizes + 24 + std::min(counts, bytes_) + std::min(samples, bytes_);
    } else {
      end = sizes + 4 + number(4);
    }
    if (end > bytes_) throw std::runtime_error(fmt::format("{}: chunk {} is cut", path_, index));
    std::vector<char> packed(end - begin);
    stream_.seekg(static_cast<std::streamoff>(begin));
    stream_.read(packed.data(), static_cast<std::streamsize>(packed.size()));
    if (!stream_) throw std::runtime_error(fmt::format("{}: chunk {} cannot be read", path_, index));
    return packed;
  }

 private:
  std::uint64_t number(std::size_t size) {
    std::array<char, 8> raw{};
    if (!stream_.read(raw.data(), static_cast<std::streamsize>(size)))
      throw std::runtime_error(fmt::format("{}: the table of chunks cannot be read", path_));
    std::uint64_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = (value << 8) | static_cast<unsigned char>(raw[i]);
    return value;
  }

  std::string path_;
  std::uint64_t bytes_;
  std::ifstream stream_;
  bool tiled_ = false, deep_ = false, several_parts_ = false;
  std::vector<std::uint64_t> offsets_;
};

}  // namespace

bool same_chunks(const std::string& path_a, int part_a, const std::string& path_b, int part_b) {
  RawPart a(path_a, part_a), b(path_b, part_b);
  if (a.chunks() != b.chunks()) return false;
  for (std::size_t i = 0; i < a.chunks(); ++i)
    if (a.chunk(i) != b.chunk(i)) return false;
  return true;
}

}  // namespace polyrecon
