#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/files/file.h"

namespace polyrecon {

/// Reads some channels of one part, a band of lines at a time, so that the memory does not grow with the frame.
class ChannelReader {
 public:
  /// Throws Error{BadInput} for a part that is not PartInfo::readable(), or that cannot be opened.
  ChannelReader(const FileInfo& file, int part, std::vector<std::string> channels);
  ~ChannelReader();

  /// Decodes the lines [y0, y1) of the data window, in the coordinates of the file. Returns a plane of (y1 - y0) *
  /// width floats for each channel, one after the other. Throws Error{BadInput} naming the part and the first line that
  /// cannot be read.
  const std::vector<float>& read(int y0, int y1);

  /// Number of lines to read at once: whole chunks of at most about band_samples samples.
  int lines_per_band() const;

 private:
  struct Source;
  std::unique_ptr<Source> source_;
  const FileInfo& file_;
  int part_;
  std::vector<std::string> channels_;
  std::vector<float> band_;
};

/// Some lines of a part: one plane of `pixels` samples after the other, in the order of the requested channels.
struct Band {
  std::size_t first_pixel;  ///< Index of the first pixel in the data window.
  std::size_t pixels;
  const std::vector<float>& samples;
};

/// Reads channels of a part from the first line to the last, a band at a time. Throws as ChannelReader.
void read_bands(const FileInfo& file, int part, const std::vector<std::string>& channels,
                const std::function<void(const Band&)>& each);

}  // namespace polyrecon
