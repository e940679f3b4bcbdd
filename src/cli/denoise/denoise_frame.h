#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/denoise/denoise_options.h"
#include "cli/denoise/frame_files.h"
#include "polyrecon/progress.h"
#include "polyrecon/read_frame.h"
#include "temporal/neighbour.h"

namespace polyrecon {

/// The options of one frame of several: its number goes into the sample map.
DenoiseOptions options_for(const FrameFiles& files, const DenoiseOptions& options);

/// A neighbour as reconstruct takes it.
struct LoadedNeighbour {
  int offset = 0;
  std::shared_ptr<const Neighbour> frame;
};

/// A frame as it was read.
struct LoadedFrame {
  ReadResult in;
  double read_seconds = 0;
  std::vector<LoadedNeighbour> neighbours;
};

/// Throws as read_frame does.
LoadedFrame load_frame(const std::string& path, const DenoiseOptions& options);

/// Reconstructs a frame and writes its picture, maps and report; prints roles and the report's table unless quiet.
/// Throws as reconstruct and write_result do.
void denoise_frame(const FrameFiles& files, LoadedFrame loaded, const DenoiseOptions& options, Progress& progress);

}  // namespace polyrecon
