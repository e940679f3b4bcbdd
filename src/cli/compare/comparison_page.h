#pragma once

#include <string>
#include <vector>

#include "cli/compare/comparison.h"
#include "io/pictures/color.h"

namespace polyrecon {

/// An HTML page in a single file: the figures, and for each layer a viewer that alternates between the reference, the
/// images, and their differences as FLIP and as relative error. Pictures wider than 1920 pixels are shown at a half, a
/// third, ... of their size. The comparisons must have their images. reference: path of its file.
std::string comparison_page(const std::string& reference, const std::vector<Comparison>& comparisons,
                            const DisplayParams& display);

}  // namespace polyrecon
