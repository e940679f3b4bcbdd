#pragma once

#include <string>
#include <vector>

#include "polyrecon/frame.h"

namespace polyrecon {

/// Whether a colour layer can be a part of the beauty: it is not noisy where the beauty has no noise. The windows of
/// the beauty do nothing there, so a layer that is no part of it (a shadow catcher, ambient occlusion) needs its own.
/// The pass must have the size of the beauty, with 3 channels.
bool is_part_of_beauty(const Frame& frame, const Pass& layer);

/// The names of the frame's further layers that are no part of the beauty.
std::vector<std::string> layers_outside_beauty(const Frame& frame);

/// The note about such a layer for the user.
std::string note_of_layer_outside_beauty(const std::string& name);

}  // namespace polyrecon
