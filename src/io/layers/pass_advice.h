#pragma once

#include <string>
#include <vector>

#include "polyrecon/layers.h"

namespace polyrecon {

/// A pass that a frame lacks, what it would bring, and where to switch it on.
struct PassAdvice {
  std::string pass;     ///< "albedo", "variance" for what shows the noise, "prior" for few samples, "aov" for AOVs
                        ///< that stay noisy.
  std::string without;  ///< "textures blur": the loss without it.
  std::string how;      ///< In the words of the renderer, where it is known: "Blender: View Layer > Passes > ...".
};

/// Advice for a frame that was read, the most useful first; empty where all is there.
/// samples: per pixel; 0 if unknown. oidn_is_installed: whether --prior oidn works as it is.
std::vector<PassAdvice> pass_advice(const FrameSource& source, double samples, bool oidn_is_installed);

/// The advice for people, a line for each place where something is switched on.
std::vector<std::string> advice_lines(const std::vector<PassAdvice>& advice);

}  // namespace polyrecon
