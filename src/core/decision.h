#pragma once

#include <string>

namespace polyrecon {

/// Whether an effect of the pipeline is run on this frame, and why (or why not).
struct Decision {
  std::string effect;
  bool run = false;
  std::string reason;
};

}  // namespace polyrecon
