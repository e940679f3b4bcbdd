#pragma once

#include <string>
#include <vector>

#include "polyrecon/layers.h"

namespace polyrecon {

/// The words of "a,b"; a text that is the whole name of a layer is one word, whatever is in it.
std::vector<std::string> layer_words(const std::string& text, const std::vector<Layer>& layers);

/// Whether the word is a pattern with * or ?.
bool is_layer_pattern(const std::string& word);

/// Whether the pattern fits the whole name of the layer, or its name within the view layer.
bool fits_pattern(const Layer& layer, const std::string& pattern);

/// Whether the layer is colour that --aov can denoise with the beauty: a mean of radiance in three channels or in one,
/// in the file of the beauty.
bool is_light_aov(const Layer& layer);

}  // namespace polyrecon
