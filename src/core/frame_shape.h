#pragma once

#include "polyrecon/frame.h"

namespace polyrecon {

/// Images of a pass in memory.
struct PassImages {
  bool variance = false, halves = false;

  int count() const { return 1 + (variance ? 1 : 0) + (halves ? 2 : 0); }
};

/// Adds a pass to what a shape counts by role, and to its channels the variance that is estimated where the file has
/// none. The channels of its images are the caller's to add.
void add_pass(FrameShape& shape, Role role, const PassImages& images);

}  // namespace polyrecon
