#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/common/frame_names.h"

namespace polyrecon {

/// An argument that names a file, or the files of a sequence.
struct SequenceArgument {
  std::string text;
  std::optional<FramePattern> pattern;  ///< Nothing for a file.
};

/// Throws as FramePattern::parse does.
std::vector<SequenceArgument> sequence_arguments(const std::vector<std::string>& texts);

/// The frames of --frames, else those of which every sequence has a file; none where all arguments are files. Throws
/// Error{Usage} where --frames is given for files, Error{Missing} where sequences have no frame in common.
std::vector<int> common_frames(const std::vector<SequenceArgument>& arguments, const std::string& wanted);

/// Names by which people know these paths: the last part of each, with folders where others have the same.
std::vector<std::string> short_names(const std::vector<std::string>& paths);

}  // namespace polyrecon
