#include "io/exr_raw.h"

#include <fmt/format.h>
#include <openexr.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace polyrecon {
namespace {

void check(exr_result_t result, const std::string& path) {
  if (result != EXR_ERR_SUCCESS) throw std::runtime_error(fmt::format("{}: {}", path, exr_get_default_error_message(result)));
}

void be_silent(exr_const_context_t, exr_result_t, const char*) {}

/// Packed bytes of one part, chunk by chunk.
class RawPart {
 public:
  RawPart(const std::string& path, int part) : path_(path), part_(part) {
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = be_silent;
    check(exr_start_read(&context_, path.c_str(), &setup), path);
    check(exr_get_storage(context_, part, &storage_), path);
  }
  RawPart(const RawPart&) = delete;
  RawPart& operator=(const RawPart&) = delete;
  ~RawPart() { exr_finish(&context_); }

  bool tiled() const { return storage_ == EXR_STORAGE_TILED || storage_ == EXR_STORAGE_DEEP_TILED; }
  bool deep() const { return storage_ == EXR_STORAGE_DEEP_SCANLINE || storage_ == EXR_STORAGE_DEEP_TILED; }

  exr_attr_box2i_t window() const {
    exr_attr_box2i_t box{};
    check(exr_get_data_window(context_, part_, &box), path_);
    return box;
  }
  int lines_per_chunk() const {
    int lines = 0;
    check(exr_get_scanlines_per_chunk(context_, part_, &lines), path_);
    return lines;
  }
  std::vector<char> lines_at(int y) const {
    exr_chunk_info_t info{};
    check(exr_read_scanline_chunk_info(context_, part_, y, &info), path_);
    return bytes(info);
  }

  void tile_levels(int& x, int& y, exr_tile_level_mode_t& mode) const {
    std::uint32_t width = 0, height = 0;
    exr_tile_round_mode_t rounding{};
    check(exr_get_tile_descriptor(context_, part_, &width, &height, &mode, &rounding), path_);
    check(exr_get_tile_levels(context_, part_, &x, &y), path_);
  }
  void level_size(int lx, int ly, int& tiles_x, int& tiles_y) const {
    int tile_width = 0, tile_height = 0, width = 0, height = 0;
    check(exr_get_tile_sizes(context_, part_, lx, ly, &tile_width, &tile_height), path_);
    check(exr_get_level_sizes(context_, part_, lx, ly, &width, &height), path_);
    tiles_x = (width + tile_width - 1) / tile_width;
    tiles_y = (height + tile_height - 1) / tile_height;
  }
  std::vector<char> tile_at(int x, int y, int lx, int ly) const {
    exr_chunk_info_t info{};
    check(exr_read_tile_chunk_info(context_, part_, x, y, lx, ly, &info), path_);
    return bytes(info);
  }

 private:
  std::vector<char> bytes(const exr_chunk_info_t& info) const {
    std::vector<char> packed(info.packed_size + (deep() ? info.sample_count_table_size : 0));
    check(deep() ? exr_read_deep_chunk(context_, part_, &info, packed.data(), packed.data() + info.packed_size)
                 : exr_read_chunk(context_, part_, &info, packed.data()),
          path_);
    return packed;
  }

  std::string path_;
  int part_;
  exr_context_t context_ = nullptr;
  exr_storage_t storage_ = EXR_STORAGE_SCANLINE;
};

bool same_lines(const RawPart& a, const RawPart& b) {
  const exr_attr_box2i_t window = a.window();
  const int lines = a.lines_per_chunk();
  for (std::int64_t y = window.min.y; y <= window.max.y; y += lines)
    if (a.lines_at(static_cast<int>(y)) != b.lines_at(static_cast<int>(y))) return false;
  return true;
}

bool same_level(const RawPart& a, const RawPart& b, int lx, int ly) {
  int across = 0, down = 0;
  a.level_size(lx, ly, across, down);
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x)
      if (a.tile_at(x, y, lx, ly) != b.tile_at(x, y, lx, ly)) return false;
  return true;
}

bool same_tiles(const RawPart& a, const RawPart& b) {
  int levels_x = 0, levels_y = 0;
  exr_tile_level_mode_t mode{};
  a.tile_levels(levels_x, levels_y, mode);
  for (int ly = 0; ly < levels_y; ++ly)
    for (int lx = 0; lx < levels_x; ++lx)
      if ((mode == EXR_TILE_RIPMAP_LEVELS || lx == ly) && !same_level(a, b, lx, ly)) return false;
  return true;
}

}  // namespace

bool same_chunks(const std::string& path_a, const std::string& path_b, int part) {
  const RawPart a(path_a, part), b(path_b, part);
  return a.tiled() ? same_tiles(a, b) : same_lines(a, b);
}

}  // namespace polyrecon
