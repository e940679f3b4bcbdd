#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/compare/comparison.h"
#include "io/pictures/color.h"
#include "io/pictures/preview.h"

namespace polyrecon {

/// A line for each comparison.
std::string comparison_text(const std::vector<Comparison>& comparisons);

/// The same as JSON (docs/reference/compare.md). Figures that are not finite are null.
nlohmann::ordered_json comparison_json(const std::string& reference, const std::vector<Comparison>& comparisons);

/// The names of the layers, each once, in their order.
std::vector<std::string> layers_of(const std::vector<Comparison>& comparisons);

/// One scale for the errors of all images of a layer: that of the worst image.
LogRange error_range(const std::vector<Comparison>& comparisons, const std::string& layer);

/// One picture with a row for each layer: the reference, then each image and its relative error. The comparisons must
/// have their images.
Image comparison_picture(const std::vector<Comparison>& comparisons, const DisplayParams& display);

}  // namespace polyrecon
