#pragma once

#include <string>
#include <vector>

#include "polyrecon/read_frame.h"

namespace polyrecon {

/// One pass to be read: layers of a FrameSource by index, -1 where there is none.
struct PassChoice {
  Role role = Role::Other;
  int mean = -1, variance = -1, half_a = -1, half_b = -1;
};

struct LayerChoice {
  FrameSource source;
  std::vector<PassChoice> passes;  ///< Beauty first, then features, prior, sample count, alpha of its own, AOVs.
  std::vector<std::string> notes;
};

/// Decides from the headers which layer plays which role. Throws as read_frame does.
LayerChoice choose_layers(const std::string& path, const ReadOptions& options);

}  // namespace polyrecon
