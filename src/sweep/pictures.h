#pragma once

#include <string>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

struct Picture {
  std::string name, details;
  const Image* linear = nullptr;  ///< 3 channels, radiance.
};

/// A picture as a page shows it: data URIs of PNG.
struct PicturedResult {
  std::string name, details;
  std::string whole;  ///< The frame, at most 640 pixels wide.
  std::string part;   ///< A sixteenth of the frame, pixel for pixel: where the pictures are worst.
  std::string error;  ///< Squared relative error in false colours; empty for the reference itself.
};

/// All pictures have the reference's size and share the part that is enlarged and the scale of the error.
std::vector<PicturedResult> picture_results(const std::vector<Picture>& pictures, const Image& reference);

}  // namespace polyrecon
