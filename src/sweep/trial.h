#pragma once

#include <string>
#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/image.h"
#include "polyrecon/progress.h"
#include "polyrecon/report.h"
#include "polyrecon/score.h"
#include "sweep/setting.h"

namespace polyrecon {

/// A converged render that results are compared with.
struct Reference {
  Image mean;      ///< 3 channels.
  Image variance;  ///< Variance of mean; empty if unknown.
};

/// Time and error of a setting.
struct Trial {
  std::string name, group;
  double seconds = 0;             ///< Wall-clock time of the reconstruction, without files; the median of all runs.
  int runs = 0;                   ///< Number of runs.
  std::vector<PhaseTime> phases;  ///< Times of the median run.
  Score score;
  double estimated_relative_mse = 0;  ///< Mean of the error map, which does not know the reference.
  Image beauty;                       ///< 3 channels.
};

/// Reconstructs the frame by the setting and scores the result. A short run is repeated until there are three runs or
/// two seconds have passed, so that a brief disturbance does not change the median. Throws as reconstruct and score do.
Trial run_trial(const Frame& frame, const Setting& setting, const Reference& reference, Progress& progress);

}  // namespace polyrecon
