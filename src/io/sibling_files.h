#pragma once

#include <string>
#include <vector>

#include "io/channel_names.h"
#include "io/exr/file.h"

namespace polyrecon {

/// A pass in a file of its own.
struct SiblingFile {
  std::string path;
  std::string pass;  ///< "Albedo", "ColorVariance": the file's name without what all of them share, without extension.
};

/// The other passes of a render that is written one pass to a file (Tungsten, LuxCore): files in the same folder, with
/// the same extension, whose names differ from path's only in a pass that channel_names knows ("Color" | "Albedo",
/// "NormalB"). Empty where path's own name does not end in a known pass.
std::vector<SiblingFile> find_siblings(const std::string& path);

/// The pass in the name of the file itself ("Color"), empty where there is none.
std::string pass_in_file_name(const std::string& path);

}  // namespace polyrecon
