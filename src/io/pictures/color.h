#pragma once

#include <string>

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

/// The values at the ends of a false-colour scale; logarithmic between.
struct LogRange {
  double low = 0, high = 0;
};

/// The range from the 1st to the 99.9th percentile of the positive finite values, but at most four powers of ten below
/// the upper end; {0, 0} where there is none.
LogRange log_range(const Image& values);

}  // namespace polyrecon
