#pragma once

#include <string>

#include "io/renderers/renderers.h"
#include "polyrecon/error_map.h"
#include "polyrecon/image.h"
#include "polyrecon/sample_map.h"

namespace polyrecon {

/// The windows of the frame that a map belongs to, in the file's coordinates.
struct MapWindows {
  Rect data, display;
};

/// An error map that was read from a file.
struct ErrorMapFile {
  ErrorMap map;
  Image sample_count;  ///< Samples per pixel, 1 channel; empty if unknown.
  MapWindows windows;
};

/// Writes the images of error_map_images that are there and, if known, samples.Y.
void write_error_map(const std::string& target, const ErrorMap& map, const Image& sample_count,
                     const MapWindows& windows);

/// Reads such a file; relnoise.Y and samples.Y may be missing. Throws Error{Missing} where the file or another channel
/// is missing, Error{BadInput} where the file is damaged.
ErrorMapFile read_error_map(const std::string& path);

/// Writes the channel order.Y.
void write_order_map(const std::string& target, const Image& order, const MapWindows& windows);

/// Attributes of a sample map that do not follow from its samples.
struct SampleMapOrigin {
  double budget = 0;  ///< Extra samples per pixel; 0 where a target was given.
  double target = 0;  ///< Mean relative MSE; 0 where a budget was given.
  int frame = 0;
  int seed = 0;
};

/// Writes a sample map: the channels samples.Y and importance.Y over the data window, or the channels that a renderer
/// reads. These cover the display window from (0, 0) and are 0, no more samples, outside the data window. format:
/// nullptr, or the format of a renderer.
void write_sample_map(const std::string& target, const SampleMap& map, const MapWindows& windows,
                      const SampleMapOrigin& origin, const SampleMapFormat* format);

}  // namespace polyrecon
