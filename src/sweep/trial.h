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

/// What an image is measured against.
struct Reference {
  Image mean;      ///< 3 channels.
  Image variance;  ///< Of mean; empty where unknown.
};

/// What a setting cost and reached.
struct Trial {
  std::string name, group;
  double seconds = 0;  ///< Wall clock of the reconstruction, without files; the median where it ran more than once.
  int runs = 0;        ///< How often it ran.
  std::vector<StageTime> stages;  ///< Of the median run.
  Score score;
  double estimated_relative_mse = 0;  ///< By the error map, which does not know the reference.
  Image beauty;                       ///< 3 channels.
};

/// Reconstructs the frame by the setting and scores it. Short runs are repeated, up to three times and two seconds,
/// so that a moment's disturbance does not count. Throws as reconstruct and score do.
Trial run_trial(const Frame& frame, const Setting& setting, const Reference& reference, Progress& progress);

}  // namespace polyrecon
