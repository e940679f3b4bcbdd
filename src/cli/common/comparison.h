#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/common/layers.h"
#include "polyrecon/progress.h"
#include "polyrecon/score.h"

namespace polyrecon {

/// One layer of an image compared with the same layer of a reference.
struct Comparison {
  std::string image, layer;  ///< Path of the image, whole name of the layer.
  Score score;
  double flip = 0;  ///< Mean of HDR-FLIP.
  /// A note if the pictures do not show the same, and one if the reference's variance is not used.
  std::vector<std::string> notes;
  std::optional<int> frame;       ///< Number of the frame; nothing where no sequence is compared.
  std::optional<double> flicker;  ///< flicker() from the frame before; nothing in the first frame.
  /// Radiance of both (3 channels), the variance of the reference's mean where it is known, FLIP and relative error of
  /// each pixel (1 channel). Empty unless compare_files was called with with_images.
  Image picture, reference, reference_variance, flip_map, error;
  int x = 0, y = 0;  ///< Place of the reference's upper left pixel in its file.
};

/// Compares the main colour layers, whatever their names, then the other colour layers that have the same name in both
/// files. Throws Error{Missing} where a file has no main colour layer, Error{BadInput} where the sizes differ,
/// Error{Interrupted} when progress asks to stop.
std::vector<Comparison> compare_files(const LayeredFile& image, const LayeredFile& reference, bool with_images,
                                      Progress& progress);

/// flicker() between a comparison and that of its layer in the frame before; nothing if that frame lacks the layer or
/// has another size.
std::optional<double> flicker_since(const std::vector<Comparison>& before, const Comparison& now);

/// The figures alone.
Comparison without_images(const Comparison& comparison);

/// The name of the layer for readers: "RGB" where it has none.
std::string shown_layer(const Comparison& comparison);

}  // namespace polyrecon
