#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

/// What a file may claim before it is refused. Every number is compared with the header before anything of that size is
/// allocated, here or in a library.
struct ReadLimits {
  std::size_t max_pixels = std::size_t{1} << 28;  ///< Pixels of one part's data window: 16384 x 16384.
  std::size_t max_channels = 4096;                ///< Channels of all parts together.
  std::size_t max_parts = 1024;
  std::size_t max_bytes = std::size_t{16} << 30;  ///< Decoded samples held at once.
};

enum class SampleType { Uint, Half, Float };

struct ChannelInfo {
  std::string name;  ///< Whole name as in the file: "ViewLayer.Combined.R".
  SampleType type = SampleType::Float;
  int x_sampling = 1, y_sampling = 1;
};

/// A header attribute in readable form; value is empty where the type has no short text (previews, opaque types).
struct AttributeInfo {
  std::string name, type, value;
};

struct PartInfo {
  std::string name;  ///< Empty in most single-part files.
  std::string view;  ///< Stereo view of the whole part, empty without one.
  Rect data_window, display_window;
  std::string compression;  ///< "zip", "dwaa", ...; "none".
  bool tiled = false, deep = false, mipmapped = false;
  std::vector<ChannelInfo> channels;  ///< In file order (sorted by name).
  std::vector<std::string> views;     ///< The `multiView` attribute: views told apart by channel names.
  std::vector<AttributeInfo> attributes;

  /// Whether the pixels are a plain image: flat, one level, and every channel has one sample a pixel.
  bool readable() const;
};

/// All that the headers of an image file say; no pixels.
struct FileInfo {
  std::string path;
  std::string format;  ///< "openexr", or OpenImageIO's name of another format ("pnm" for PFM).
  std::uint64_t bytes = 0;
  std::vector<PartInfo> parts;
};

const char* name_of(SampleType type);

/// Reads the headers only. Throws Error{Missing} where there is no such file, and Error{BadInput} where it is empty or
/// has no chunk written ("not yet rendered"), is cut ("incomplete"), is damaged, or claims more than limits or its own
/// length allow.
FileInfo describe_file(const std::string& path, const ReadLimits& limits = {});

/// An attribute of a part, nullptr where there is none.
const AttributeInfo* find_attribute(const PartInfo& part, const std::string& name);

}  // namespace polyrecon
