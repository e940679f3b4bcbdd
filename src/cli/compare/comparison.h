#pragma once

#include <string>
#include <vector>

#include "cli/common/layers.h"
#include "polyrecon/progress.h"
#include "polyrecon/score.h"

namespace polyrecon {

/// One layer of an image against the same layer of a reference.
struct Comparison {
  std::string image, layer;  ///< Path of the file, whole name of the layer.
  Score score;
  double flip = 0;  ///< Mean of HDR-FLIP.
  /// For who shows them: radiance of both (3 channels), FLIP and relative error of each pixel (1 channel). Empty unless
  /// they were asked for.
  Image picture, reference, flip_map, error;
};

/// The main colour layers, whatever their names, then the further colour layers that both files have under one name.
/// Throws Error{Missing} where a file has no main colour layer, Error{BadInput} where the sizes differ,
/// Error{Interrupted} when progress asks to stop.
std::vector<Comparison> compare_files(const LayeredFile& image, const LayeredFile& reference, bool with_images,
                                      Progress& progress);

/// "RGB" for the layer without a name.
std::string shown_layer(const Comparison& comparison);

}  // namespace polyrecon
