#pragma once

#include <string>

#include "polyrecon/layers.h"

namespace polyrecon {

/// The layer of the file source.path that takes a denoised picture: the denoised one where the renderer's own denoiser
/// wrote both, since people and compositors look for the result there; else `beauty`, the noisy one.
std::string result_layer(const FrameSource& source, const std::string& beauty);

/// The layer that takes the alpha: the picture's, where the beauty's came with it, so that picture and alpha stay
/// together; else the one that it was read from. picture: by result_layer.
std::string alpha_layer(const FrameSource& source, const std::string& beauty, const std::string& picture);

}  // namespace polyrecon
