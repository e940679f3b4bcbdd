#pragma once

#include <string>

#include "io/layers/layer_choice.h"
#include "polyrecon/read_options.h"

namespace polyrecon {

/// Opens the headers of a file and of the files next to it that hold its other passes, and chooses the layer for each
/// role. Throws as read_frame does.
LayerChoice choose_layers(const std::string& path, const ReadOptions& options);

}  // namespace polyrecon
