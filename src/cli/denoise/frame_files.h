#pragma once

#include <optional>
#include <string>
#include <vector>

namespace polyrecon {

/// The input of a frame before or after, which helps.
struct NeighbourFile {
  int offset = 0;  ///< In frames; in a list, in files.
  int number = 0;  ///< Its frame number; in a list, its place.
  std::string path;
  bool is_worked_too = false;  ///< Whether it is itself one of the frames asked for.
};

/// The files of one frame that `denoise` reads and writes; a path is empty where it was not asked for.
struct FrameFiles {
  std::string input, output, error_map, order_map, sample_map, report;
  std::optional<int> frame;  ///< Its number in a sequence.
  int place = 0;             ///< Its number, or its place in a list: what its neighbours' numbers count from.
  std::vector<NeighbourFile> neighbours;

  /// How messages name it: "frame 12", or the input's path.
  std::string label() const;
};

struct DenoiseOptions;

/// The work that the options ask for, in order: one file, the frames of a pattern, or a list of files whose results go
/// into a folder or into a pattern that takes the number in each file's name. Throws Error{Usage} where names
/// contradict each other, Error{Missing} where a pattern without --frames matches no file.
std::vector<FrameFiles> list_frames(const DenoiseOptions& options);

/// Whether the options ask for more than one plain file: then a frame that fails does not end the work.
bool is_sequence(const DenoiseOptions& options);

}  // namespace polyrecon
