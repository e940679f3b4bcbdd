#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace polyrecon {

/// The frames that "1-10,20-40x2,50" names, in the order given, each once. Throws Error{Usage}.
std::vector<int> parse_frames(const std::string& text);

/// The same frames as text that parse_frames reads: "1-4,9".
std::string frames_text(std::vector<int> frames);

/// The name of a sequence's files: the frame number stands in place of `####` (at least as many digits as signs) or
/// `%04d`, `%d`, everywhere in the path.
class FramePattern {
 public:
  /// Nothing where the text holds no such place. A path that exists as it stands is a file, never a pattern.
  static std::optional<FramePattern> parse(const std::string& text);

  std::string path(int frame) const;

  /// Frames whose file is there, ascending. The place must be in the file's name, not in its folder's.
  /// Throws Error{Missing} where there are none.
  std::vector<int> existing_frames() const;

 private:
  std::vector<std::string> pieces_;  ///< Text between the places; one more than digits_.
  std::vector<int> digits_;          ///< Least number of digits in each place.
};

/// The last number in a file's name, "shot.0012.exr" -> 12; nothing where there is none.
std::optional<int> frame_in_name(const std::string& path);

}  // namespace polyrecon
