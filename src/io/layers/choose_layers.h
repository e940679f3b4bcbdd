#pragma once

#include <string>
#include <vector>

#include "polyrecon/layers.h"
#include "polyrecon/read_options.h"

namespace polyrecon {

/// The layers of one pass that is read, as indices into FrameSource::layers; -1 without one.
struct PassChoice {
  Role role = Role::Other;
  int mean = -1, variance = -1, half_a = -1, half_b = -1;
};

/// The layers that are read of a file.
struct LayerChoice {
  FrameSource source;
  std::vector<PassChoice> passes;           ///< In the order of the roles, beauty first; the AOVs follow.
  std::vector<std::string> outside_beauty;  ///< As ReadResult::outside_beauty.
  std::vector<std::string> notes;
};

/// The file at path with its layers. A file that holds one pass without a name is joined by the files next to it that
/// hold the other passes of the render; notes then name them.
FrameSource open_source(const std::string& path, const ReadLimits& limits, std::vector<std::string>& notes);

/// Opens the headers of a file and of the files next to it that hold its other passes, and chooses the layer for each
/// role. Throws as read_frame does.
LayerChoice choose_layers(const std::string& path, const ReadOptions& options);

}  // namespace polyrecon
