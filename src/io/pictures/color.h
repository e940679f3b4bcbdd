#pragma once

#include <string>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

/// How linear radiance becomes a picture on a display.
struct DisplayParams {
  double exposure = 0;  ///< Stops: radiance is multiplied by 2^exposure first.
  std::string view;     ///< View of the configuration's default display; empty: its default view.
};

/// Linear radiance (3 channels) -> display-encoded RGB in 0..1, by OpenColorIO: the configuration that the environment
/// variable OCIO names, or a built-in one with the sRGB display and the views "Standard" (the plain sRGB curve) and
/// "Filmic" (16.5 stops under a soft shoulder). Pixels that are not finite come out magenta.
/// Throws Error{BadInput} where $OCIO cannot be used, Error{Usage} for an unknown view, naming the known ones.
Image to_display(const Image& linear, const DisplayParams& params);

/// The views of the default display of the configuration that to_display uses.
struct DisplayViews {
  std::vector<std::string> names;
  std::string chosen;  ///< The requested one, else the default view.
  std::string
      plain_srgb;  ///< The one that is the plain sRGB curve, if it is known: that of the built-in configuration.
};

/// wanted: as DisplayParams::view. Throws like to_display.
DisplayViews display_views(const std::string& wanted);

/// A view as a table: what it makes of radiances between which the rest is interpolated.
struct DisplayTable {
  int size = 0;  ///< Levels of each channel. Level i is (2^(length * i / (size - 1)) - 1) / scale.
  double scale = 0, length = 0;
  Image colors;  ///< 3 channels, 0 to 1; size * size wide: red runs fastest, then green; size high: blue.
};

/// Throws like to_display.
DisplayTable display_table(const std::string& view);

/// The values at the ends of a false-colour scale; logarithmic between.
struct LogRange {
  double low = 0, high = 0;
};

/// The range from the 1st to the 99.9th percentile of the positive finite values, but at most four powers of ten below
/// the upper end; {0, 0} where there is none.
LogRange log_range(const Image& values);

}  // namespace polyrecon
