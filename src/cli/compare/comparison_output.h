#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/common/comparison.h"
#include "io/pictures/color.h"
#include "io/pictures/preview.h"

namespace polyrecon {

/// A figure in this format, "nan" without a sign where it does not exist.
std::string figure_text(const char* format, double value);

/// The notes of all comparisons, each once.
std::vector<std::string> notes_of(const std::vector<Comparison>& comparisons);

/// A line for each comparison.
std::string comparison_text(const std::vector<Comparison>& comparisons);

/// The same as JSON (docs/reference/compare.md). Figures that are not finite are null.
nlohmann::ordered_json comparison_json(const std::string& reference, const std::vector<Comparison>& comparisons);

/// Means over the frames of an image; bad is a sum.
struct SequenceFigures {
  double relative_mse = 0, trimmed = 0, energy = 0, flip = 0;
  std::size_t bad = 0;
  std::optional<double> flicker;  ///< Nothing where no frame has one.
};

/// frames: the comparisons of one image and layer, at least one.
SequenceFigures sequence_figures(const std::vector<const Comparison*>& frames);

/// A line with them for each layer. comparisons: of all frames of one image.
std::string sequences_text(const std::string& image, const std::vector<Comparison>& comparisons);

/// The names of the layers, each once, in their order.
std::vector<std::string> layers_of(const std::vector<Comparison>& comparisons);

/// One scale for the errors of all images of a layer: that of the worst image.
LogRange error_range(const std::vector<Comparison>& comparisons, const std::string& layer);

/// One picture with a row for each layer: the reference, then each image and its relative error. The comparisons must
/// have their images.
Image comparison_picture(const std::vector<Comparison>& comparisons, const DisplayParams& display);

}  // namespace polyrecon
