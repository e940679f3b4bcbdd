#pragma once

#include <string>
#include <vector>

#include "io/channel_names.h"
#include "io/exr/file.h"

namespace polyrecon {

/// A file that holds one pass of a render.
struct SiblingFile {
  std::string path;
  std::string pass;  ///< "Albedo", "ColorVariance": the part of the name that differs from the other files.
};

/// The other passes of a render that has a file for each: files in the folder of path with the same extension, whose
/// names differ from that of path only in a pass that some renderer is known to write ("Color" | "Albedo", "NormalB").
/// The numbers of a frame and a version may follow the pass: "shot_beauty.0001" | "shot_albedo.0001". Where the name of
/// path has no known pass, features that are added to it are found: "shot.0001" | "shot_albedo.0001".
std::vector<SiblingFile> find_siblings(const std::string& path);

/// The pass in the file's name ("Color"), before its numbers if there are any; empty where there is none.
std::string pass_in_file_name(const std::string& path);

}  // namespace polyrecon
