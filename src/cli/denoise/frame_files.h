#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/checks.h"

namespace polyrecon {

struct DenoiseOptions;

/// --frame-radius of a sequence.
constexpr int default_frame_radius = 2;

/// The files that `denoise` writes for a frame; a path is empty where the file was not requested.
struct OutputPaths {
  std::string picture, error_map, order_map, sample_map, report;
};

enum class OutputKind {
  Picture,  ///< All pictures of the input in one file.
  Map,      ///< A file for each picture.
  Report,   ///< JSON about all pictures.
};

FileKind file_kind_of(OutputKind kind);

/// An option that names an output, and the place of its path.
struct OutputOption {
  const char* name;  ///< "--error-map"
  std::string OutputPaths::*path;
  OutputKind kind;
};

const std::array<OutputOption, 5>& output_options();

/// The input of a frame before or after, whose samples help.
struct NeighbourFile {
  int offset = 0;            ///< In frames; in a list of files, in files.
  int number = 0;            ///< Its frame number; in a list of files, its index.
  std::optional<int> frame;  ///< The number in its name; unknown for a file without one.
  std::string path;
  bool is_denoised_too = false;  ///< Whether the run denoises this frame too.
};

/// The files of one frame that `denoise` reads and writes.
struct FrameFiles {
  std::string input;
  OutputPaths outputs;
  std::optional<int> frame;  ///< Number of the frame; unknown for a file that is no frame of a sequence.
  int place = 0;             ///< Number, or index in a list of files: its neighbours' numbers count from it.
  std::vector<NeighbourFile> neighbours;

  /// Its name in messages: "frame 12", or the input's path.
  std::string label() const;

  /// The number that stands for #### in the names of other inputs: its own, or the one in the input's name.
  std::optional<int> number_in_names() const;
};

/// The frames of a run, in order.
struct FrameList {
  std::vector<FrameFiles> frames;
  bool is_sequence = false;  ///< Frames of a pattern, or a list of files; false for one plain file.
  int radius = 0;            ///< How many frames before and after help each one.
};

/// The output of an input if none was named: "shot_denoised.exr" next to "shot.exr", and
/// "shot_denoised.####.exr" next to "shot.####.exr".
std::string default_output(const std::string& input);

/// The path of an output that goes into a folder: it has the name of the input.
std::string path_in_folder(const OutputOption& option, const std::string& folder, const std::string& input);

/// Lists one file, the frames of a pattern, or a list of files. Outputs that are folders take the names of the inputs;
/// a pattern takes the number in each file's name. Without -o results go to default_output. Looks on the disk for the
/// frames of a pattern without --frames, and for files whose names look like patterns. Throws Error{Usage} where names
/// contradict each other, Error{Missing} where a pattern without --frames matches no file.
FrameList list_frames(const DenoiseOptions& options);

}  // namespace polyrecon
