#pragma once

#include <functional>
#include <optional>

#include "cli/denoise_frame.h"
#include "cli/denoise_options.h"
#include "cli/frame_files.h"

namespace polyrecon {

/// Reads a frame, or finds that it needs no work (--skip-existing): then there is nothing. A file that is not there,
/// not complete or not readable yet is tried again until it was left unchanged for --wait seconds.
/// Throws as read_frame does; Error{Interrupted} when cancelled() says so.
std::optional<LoadedFrame> fetch_frame(const FrameFiles& files, const DenoiseOptions& options,
                                       const std::function<bool()>& cancelled);

}  // namespace polyrecon
