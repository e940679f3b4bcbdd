#pragma once

#include <string>

#include "cli/denoise_options.h"
#include "cli/frame_files.h"
#include "core/progress.h"
#include "io/read_frame.h"

namespace polyrecon {

/// A frame as it was read.
struct LoadedFrame {
  ReadResult in;
  double read_seconds = 0;
};

/// Throws as read_frame does.
LoadedFrame load_frame(const std::string& path, const DenoiseOptions& options);

/// Reconstructs a frame and writes its picture, maps and report; prints roles and the report's table unless quiet.
/// Throws as reconstruct and write_result do.
void denoise_frame(const FrameFiles& files, LoadedFrame loaded, const DenoiseOptions& options, Progress& progress);

}  // namespace polyrecon
