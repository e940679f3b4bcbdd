#pragma once

#include <string>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

struct Picture {
  std::string name, details;
  const Image* linear = nullptr;  ///< 3 channels, radiance.
};

/// The pictures of a result as a page shows them: PNG as data URIs.
struct PicturedResult {
  std::string name, details;
  std::string whole;  ///< The frame, at most 640 pixels wide.
  std::string part;   ///< A sixteenth of the frame at full size, where the errors are largest.
  std::string error;  ///< Squared relative error in false colours; empty for the reference.
};

/// The pictures must have the reference's size. All show the same part, and their errors have one scale.
std::vector<PicturedResult> picture_results(const std::vector<Picture>& pictures, const Image& reference);

}  // namespace polyrecon
