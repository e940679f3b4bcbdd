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

/// The same with stable keys; docs/reference/report.md lists them. Figures that are not finite are null.
nlohmann::ordered_json comparison_json(const std::string& reference, const std::vector<Comparison>& comparisons);

/// Names of the layers, each once, in order of appearance.
std::vector<std::string> layers_of(const std::vector<Comparison>& comparisons);

/// The scale that shows the errors of all images of a layer: that of the worst one.
LogRange error_range(const std::vector<Comparison>& comparisons, const std::string& layer);

/// One picture: a row for each layer with the reference, then each image and its relative error. The comparisons come
/// with their images.
Image comparison_picture(const std::vector<Comparison>& comparisons, const DisplayParams& display);

}  // namespace polyrecon
