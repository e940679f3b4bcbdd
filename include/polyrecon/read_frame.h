// Reads one view layer of a render from a file: finds the layers, chooses what each is to the method, decodes them.
#pragma once

#include <string>
#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/layers.h"
#include "polyrecon/read_options.h"

namespace polyrecon {

/// A frame that was read.
struct ReadResult {
  Frame frame;
  FrameSource source;
  /// Layers of ReadOptions::aovs that reach beyond the beauty's data window, so that they are no part of it. They are
  /// not in the frame; ReadOptions::own_windows reads each.
  std::vector<std::string> outside_beauty;
  std::vector<std::string> notes;  ///< Messages of one line: what was dropped, assumed or unusual.
};

/// Reads one view layer of a render. Layers in use are read completely, so that a missing last chunk is noticed. NaN
/// and infinity are kept; reconstruct repairs them. Several channels of a layer whose role has one are averaged.
/// Throws Error{Missing} if the file or a requested layer is missing, Error{BadInput} if the file is damaged, has no
/// beauty, or its layers do not fit together, Error{OutOfMemory} if the pixels need more than options.limits.max_bytes.
ReadResult read_frame(const std::string& path, const ReadOptions& options = {});

/// The same without pixels: source and notes, with the frame empty. Throws as read_frame does.
ReadResult read_frame_header(const std::string& path, const ReadOptions& options = {});

}  // namespace polyrecon
