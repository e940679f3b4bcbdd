#pragma once

#include <string>
#include <vector>

#include "polyrecon/layers.h"
#include "polyrecon/read_options.h"

namespace polyrecon {

/// The file at path with its layers. A file that holds one pass without a name is joined by the files next to it that
/// hold the other passes of the render; notes then name them.
FrameSource open_source(const std::string& path, const ReadLimits& limits, std::vector<std::string>& notes);

/// Adds one layer of another file. Returns its index.
int add_file(FrameSource& source, const std::string& path, Role role, const ReadLimits& limits);

/// Names a layer of another file after the pass that it holds.
void rename_layer(Layer& layer, const std::string& pass, const LayerView& place = {});

}  // namespace polyrecon
