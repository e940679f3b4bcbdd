#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "polyrecon/frame.h"
#include "polyrecon/params.h"

namespace polyrecon {

/// Bytes of the process without images: code, libraries, windows and sums of each thread.
constexpr std::size_t program_bytes = std::size_t{128} << 20;

/// The size of a frame that has been read.
FrameShape shape_of(const Frame& frame);

/// Adds to a shape what a denoiser in this process brings: its features, and the prior with halves.
void add_denoiser(FrameShape& shape);

/// Channels held for so many neighbours in time.
int neighbours_channels(const FrameShape& shape, int neighbours, const Params& params);

/// Channels held for the next frame of a sequence while the current one is reconstructed: its passes, and where
/// neighbours in time are used also two frames prepared as neighbours.
int channels_ahead(const FrameShape& shape, const Params& params);

/// Bytes that a reconstruction needs: program_bytes and the images that live at once, as each step states them next to
/// its own code, with an allowance for unused memory between images of unequal sizes.
struct MemoryNeeds {
  std::size_t prepare = 0;   ///< While the passes are read and prepared.
  std::size_t denoiser = 0;  ///< While a denoiser makes the prior, with the least that it works with; 0: none does.
  std::size_t held = 0;      ///< Held from the first fit on, without the tile in work.
  std::size_t tile = 0;      ///< For the smallest tile that a stage can work on.

  std::size_t least() const { return std::max({prepare, denoiser, held + tile}); }
};

MemoryNeeds memory_needs(const FrameShape& shape, const Params& params);

/// Throws Error{OutOfMemory} where params.max_memory is not enough. The message names the frame and the least limit.
void require_memory(const std::string& name, const FrameShape& shape, const Params& params);

/// Bytes left for a denoiser: params.max_memory less what is held while it runs.
std::size_t denoiser_memory(const FrameShape& shape, const Params& params);

/// Bytes left for the tile in work: params.max_memory less MemoryNeeds::held.
std::size_t tile_memory(const FrameShape& shape, const Params& params);

}  // namespace polyrecon
