#pragma once

#include <string>

namespace polyrecon {

/// Work that a decision spares.
enum class Spared { Nothing, Pixels, Columns, Prefilter };

/// Whether an step of the pipeline is run on this frame, and why (or why not).
struct Decision {
  std::string step;
  bool run = false;
  std::string reason;
  Spared spared = Spared::Nothing;
  int channels = 0;          ///< Of the pass that the decision is about.
  double saved_seconds = 0;  ///< About what the spared work would have taken on this machine (pipeline/savings.h).
};

/// Which steps may run, and who decides.
struct Steps {
  bool decide = true;  ///< A look at the frame leaves out what it does not call for; false: all that is allowed runs.
  bool normal = true, albedo = true, depth = true, visibility = true;  ///< Feature passes that may take part.
  bool prefilter = true;                                               ///< Of noisy feature passes.
  bool outliers = true;  ///< Their removal, and the return of their light.
};

}  // namespace polyrecon
