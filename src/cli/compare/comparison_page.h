#pragma once

#include <string>
#include <vector>

#include "cli/compare/comparison.h"
#include "io/pictures/color.h"

namespace polyrecon {

/// A comparison as one HTML page that needs nothing beside it: the figures, and for each layer a picture that
/// alternates between the reference, the images, and their difference as FLIP and as relative error. Pictures wider
/// than 1920 pixels are shown at half, a third, ... of their size. The comparisons come with their images; reference:
/// path of its file.
std::string comparison_page(const std::string& reference, const std::vector<Comparison>& comparisons,
                            const DisplayParams& display);

}  // namespace polyrecon
