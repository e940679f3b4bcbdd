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

/// A file that may hold several passes of a render.
struct FileOfPasses {
  std::string path;
  bool named_so = false;  ///< Its name says that it holds passes: "shot_aovs". Else it is any word: "shot_lookdev".
};

/// A file and the other files of its render.
struct FilesOfRender {
  std::string pass;  ///< The pass of the file itself, by its name or its folder's; empty where unknown.
  std::vector<SiblingFile> others;
  std::vector<FileOfPasses> of_several;  ///< In the order of their paths.
};

/// The other passes of a render that has a file for each, with the same extension.
///
/// Files in the folder of path have names that differ from that of path in one of two ways; the numbers of a frame and
/// a version may follow:
/// - Another pass that some renderer is known to write, or a companion, stands in place of the pass in the name of
/// path:
///   "Color" | "Albedo", "NormalB"; "shot_beauty.0001" | "shot_N.0001", "shot_beauty_variance.0001".
/// - A feature, or a companion of the beauty, is added to the name: "shot.0001" | "shot_albedo.0001".
///
/// Each pass may be in a folder of its own, whose names differ in the same ways: "beauty/shot.0001" |
/// "albedo/shot.0001", "AOV_N/shot_N.0001", or all of them in a folder: "aovs/shot_albedo.0001". Files in the folder of
/// path come first.
///
/// Files of several passes have a word in place of the pass, or added: "shot_aovs.0001" | "shot_beauty.0001"; or they
/// have the same name in a folder for passes: "aovs/shot.0001".
FilesOfRender find_siblings(const std::string& path);

/// The pass in the file's name ("Color"), before its numbers if there are any; empty where there is none.
std::string pass_in_file_name(const std::string& path);

/// Whether a file that is named so holds the beauty after a denoiser: "beauty_denoised", "Denoised".
bool is_denoised_name(const std::string& pass);

}  // namespace polyrecon
