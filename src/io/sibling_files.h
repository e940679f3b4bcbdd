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
/// Empty where the name of path does not end in a known pass.
std::vector<SiblingFile> find_siblings(const std::string& path);

/// The pass at the end of the file's name ("Color"); empty where there is none.
std::string pass_in_file_name(const std::string& path);

}  // namespace polyrecon
