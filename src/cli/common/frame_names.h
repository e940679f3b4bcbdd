#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace polyrecon {

/// The frames of "1-10,20-40x2,50", in the order given, each once. A step is written x2 or, as Open Job Description
/// does, :2. Throws Error{Usage}.
std::vector<int> parse_frames(const std::string& text);

/// The same frames as text that parse_frames reads, in ascending order: "1-4,9".
std::string frames_text(std::vector<int> frames);

/// The names of a sequence's files, "shot.####.exr" or "shot.%04d.exr".
///
/// `####` stands for at least as many digits, with a minus sign before them where the number is negative, as Blender
/// writes it: -0005. `%04d` and `%d` are those of C, where the sign counts as a digit, as Nuke writes it: -005. The
/// last such place in the file's name is the frame's number. Other places, in the name or in its folders, stand for the
/// number only where their text is the same: "####/shot.####.exr". Folders that exist under exactly this name have no
/// places. The drivers follow the same rules
/// (pipelines/common/frame_names.py); tests/inputs/frame_names.json has examples of each.
class FramePattern {
 public:
  /// Nothing where the file's name has no such place, or where a file of exactly this name exists. Throws Error{Usage}
  /// where a place is longer than a file's name can be.
  static std::optional<FramePattern> parse(const std::string& text);

  std::string path(int frame) const;

  /// The frame whose path is `path`; nothing where there is none.
  std::optional<int> frame_of(const std::string& path) const;

  /// The frames whose files exist, ascending. Throws Error{Missing} where there are none, Error{Usage} where the
  /// folder's name contains the number.
  std::vector<int> existing_frames() const;

 private:
  /// Where the folder has frames with another number of digits: their pattern, for a message; else empty.
  std::string other_width(const std::filesystem::path& folder) const;
  std::string number(int frame) const;

  std::vector<std::string> pieces_;  ///< The text between the places; one more than there are places.
  bool in_folder_ = false;           ///< Whether the folder's name has a place too.
  int width_ = 0;                    ///< Least length of the number.
  bool sign_counts_ = false;         ///< Whether a minus sign counts towards width_.
};

/// The name of a file without its folders.
std::string file_name(const std::string& path);

/// The index at which the number's place in a file's name begins, as FramePattern finds it; nothing where there is
/// none.
std::optional<std::size_t> number_begin(const std::string& name);

/// The last number in a file's name, "shot.0012.exr" -> 12; nothing where there is none.
std::optional<int> frame_in_name(const std::string& path);

}  // namespace polyrecon
