#pragma once

#include <string>
#include <vector>

#include "polyrecon/read_frame.h"

namespace polyrecon {

/// A render in a folder.
struct FoundRender {
  std::string input;        ///< A file, or the pattern of a sequence.
  std::vector<int> frames;  ///< Numbers, ascending; empty for a single file.
};

/// A file, or the pattern of a sequence, that is no render to denoise.
struct LeftOut {
  std::string input, why;
};

/// The files of a folder.
struct FolderContents {
  std::vector<FoundRender> renders;
  std::vector<LeftOut> left_out;
};

/// Lists the EXR files of a folder by name. Files whose names differ only in the number at the end are one sequence.
/// Left out are results of `denoise`, passes of a render that has a file for each pass, and files without a beauty.
/// Reads the header of the first file of each. Throws Error{Missing} where there is nothing to denoise.
FolderContents find_renders(const std::string& folder, const ReadOptions& options);

}  // namespace polyrecon
