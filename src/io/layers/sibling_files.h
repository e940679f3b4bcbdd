#pragma once

#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/layers/channel_names.h"

namespace polyrecon {

/// A file that holds one pass of a render.
struct SiblingFile {
  std::string path;
  std::string pass;  ///< "Albedo", "ColorVariance": the part of the name that differs from the other files.
};

/// The other passes of a render that has a file for each: files in the folder of path with the same extension, whose
/// names differ from that of path in one of two ways. The numbers of a frame and a version may follow.
/// - Another pass that some renderer is known to write, or a companion, stands in place of the pass in the name of
/// path:
///   "Color" | "Albedo", "NormalB"; "shot_beauty.0001" | "shot_N.0001", "shot_beauty_variance.0001".
/// - A feature, or a companion of the beauty, is added to the name: "shot.0001" | "shot_albedo.0001".
std::vector<SiblingFile> find_siblings(const std::string& path);

/// The pass in the file's name ("Color"), before its numbers if there are any; empty where there is none.
std::string pass_in_file_name(const std::string& path);

/// Whether a file that is named so holds the beauty after a denoiser: "beauty_denoised", "Denoised".
bool is_denoised_name(const std::string& pass);

}  // namespace polyrecon
