// The headers of an image file, without its pixels: parts, channels, windows, attributes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

/// Limits beyond which a file is refused. The header is compared with them before memory of that size is allocated.
struct ReadLimits {
  std::size_t max_pixels = std::size_t{1} << 28;  ///< Pixels in the data window of a part: 16384 x 16384.
  std::size_t max_channels = 4096;                ///< Channels of all parts together.
  std::size_t max_parts = 1024;                   ///< Parts of a file.
  std::size_t max_bytes = std::size_t{16} << 30;  ///< Bytes of decoded samples in memory at one time.
};

/// How a file stores the samples of a channel: 32-bit unsigned integers, 16-bit or 32-bit floating point numbers.
enum class SampleType { Uint, Half, Float };

/// A channel of a part.
struct ChannelInfo {
  std::string name;  ///< Whole name as in the file: "ViewLayer.Combined.R".
  SampleType type = SampleType::Float;
  int x_sampling = 1, y_sampling = 1;  ///< Pixels per sample along a row and along a column.
};

/// An attribute of a header as text; value is empty if its type has no short text form (previews, opaque types).
struct AttributeInfo {
  std::string name, type, value;
};

/// A part of a file; files of formats without parts have one.
struct PartInfo {
  std::string name;  ///< Empty in most single-part files.
  std::string view;  ///< Stereo view of the whole part; empty without one.
  Rect data_window, display_window;
  std::string compression;  ///< "zip", "dwaa", ...; "none".
  bool tiled = false, deep = false, mipmapped = false;
  std::vector<ChannelInfo> channels;  ///< In file order (sorted by name).
  std::vector<std::string> views;     ///< Attribute `multiView`: stereo views that channel names distinguish.
  std::vector<AttributeInfo> attributes;

  /// Whether read_frame can read the pixels: a flat image of one level with one sample per pixel in each channel.
  bool readable() const { return obstacle().empty(); }
  /// Why read_frame cannot read the pixels, and what to do; empty where it can.
  std::string obstacle() const;
};

/// Identifies a file, to find out whether it is still the one that was read.
struct FileStamp {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t modified = 0, changed = 0;  ///< Times of the contents and of the inode, nanoseconds.

  bool operator==(const FileStamp& other) const {
    return device == other.device && inode == other.inode && bytes == other.bytes && modified == other.modified &&
           changed == other.changed;
  }
};

/// The headers of an image file.
struct FileInfo {
  std::string path;
  std::string format;       ///< "openexr", or OpenImageIO's name of another format ("pnm" for PFM).
  std::uint64_t bytes = 0;  ///< Length of the file.
  FileStamp stamp;          ///< Taken before the file was opened.
  std::vector<PartInfo> parts;
};

/// "uint", "half" or "float".
const char* name_of(SampleType type);

/// Reads the headers of a file. Throws Error{Missing} if there is no such file. Throws Error{BadInput} if the file is
/// empty or has no chunk written ("not yet rendered"), is cut off ("incomplete"), is damaged, or if its header claims
/// more than the limits or the file's length allow.
FileInfo describe_file(const std::string& path, const ReadLimits& limits = {});

/// An attribute of a part; nullptr if there is none of this name.
const AttributeInfo* find_attribute(const PartInfo& part, const std::string& name);

}  // namespace polyrecon
