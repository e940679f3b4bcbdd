#pragma once

#include <string>

#include "polyrecon/error_map.h"
#include "polyrecon/image.h"
#include "polyrecon/sample_map.h"

namespace polyrecon {

/// Where a map stands: the windows of the frame it belongs to, in the file's coordinates.
struct MapWindows {
  Rect data, display;
};

/// An error map as it stands in its file.
struct ErrorMapFile {
  ErrorMap map;
  Image sample_count;  ///< 1 channel; empty where the file does not know.
  MapWindows windows;
};

/// Channels mse.R/G/B, relmse.Y, relvariance.Y, relnoise.Y and, where known, samples.Y.
void write_error_map(const std::string& target, const ErrorMap& map, const Image& sample_count,
                     const MapWindows& windows);

/// Throws Error{Missing} where the file or one of its channels but the last two is not there, Error{BadInput} where it
/// is damaged.
ErrorMapFile read_error_map(const std::string& path);

/// Channel order.Y.
void write_order_map(const std::string& target, const Image& order, const MapWindows& windows);

/// Who is to read a sample map; docs/reference/formats.md tells what each takes and how we know.
enum class SampleMapFormat { Polyrecon, Appleseed, Luxcore, Vray };

/// What the attributes of a sample map say beyond its own figures.
struct SampleMapOrigin {
  double budget = 0;  ///< 0 where a target was given.
  double target = 0;
  int frame = 0;
  int seed = 0;
};

/// Polyrecon: samples.Y, importance.Y over the data window. The renderers' formats cover the display window, from (0,
/// 0), and are zero (nothing more to render) outside the data window: Appleseed R = samples / maximum, Luxcore Y =
/// importance, Vray R = G = B = 1 where a pixel gets half a sample or more, else 0.
void write_sample_map(const std::string& target, const SampleMap& map, const MapWindows& windows,
                      const SampleMapOrigin& origin, SampleMapFormat format);

}  // namespace polyrecon
