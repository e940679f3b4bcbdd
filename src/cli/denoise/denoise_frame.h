#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "cli/denoise/job.h"
#include "polyrecon/progress.h"
#include "polyrecon/read_frame.h"
#include "temporal/neighbour.h"

namespace polyrecon {

/// A frame before or after, prepared for reconstruct; several frames in work may share it.
struct LoadedNeighbour {
  int offset = 0;
  std::shared_ptr<const Neighbour> frame;
};

/// A frame in memory, with the frames that help it.
struct LoadedFrame {
  ReadResult in;
  double read_seconds = 0;
  std::vector<LoadedNeighbour> neighbours;
};

/// Throws as read_frame does.
LoadedFrame load_frame(const std::string& path, const ReadOptions& options);

/// Reconstructs a frame within max_memory bytes and writes its picture, maps and report. Prints the roles of its layers
/// and the report unless the job is quiet. Throws as reconstruct and write_result do.
void denoise_frame(const Job& job, const FrameFiles& files, LoadedFrame loaded, std::size_t max_memory,
                   Progress& progress);

}  // namespace polyrecon
