#pragma once

#include <cstddef>
#include <string>

#include "polyrecon/frame.h"
#include "polyrecon/params.h"

namespace polyrecon {

FrameShape shape_of(const Frame& frame);

/// Channels held for so many neighbours in time: halves, variance and motion vectors of each.
int neighbour_channels(const FrameShape& shape, int neighbours);

/// Channels held for the next frame of a sequence while one is worked: its passes, itself and one more as neighbours.
int channels_ahead(const FrameShape& shape, const Params& params);

/// Bytes that a reconstruction needs, counted from the images that live at once.
struct MemoryNeeds {
  std::size_t prepare = 0;  ///< While the passes are read and prepared.
  std::size_t held = 0;     ///< While windows are fitted, beside the tile in work.
  std::size_t tile = 0;     ///< Of the smallest tile that a stage can work.

  std::size_t least() const { return prepare > held + tile ? prepare : held + tile; }
};

MemoryNeeds memory_needs(const FrameShape& shape, const Params& params);

/// Throws Error{OutOfMemory}, naming the frame and the limit that would do, where params.max_memory is not enough.
void require_memory(const std::string& name, const FrameShape& shape, const Params& params);

/// What the tiles of the stages may use together: params.max_memory less what is held beside them.
std::size_t tile_memory(const FrameShape& shape, const Params& params);

}  // namespace polyrecon
