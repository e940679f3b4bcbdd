#pragma once

#include <optional>
#include <string>
#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/progress.h"
#include "sweep/setting.h"

namespace polyrecon {

/// What a step of the ladder takes and leaves, over what Quality::Standard does.
struct StepFigures {
  double seconds = 1;  ///< Of the reconstruction.
  double error = 1;    ///< relMSE
};

/// As measured on the samples; made by tests/bench/accuracy.py.
const std::array<StepFigures, step_count>& measured_steps();

/// What draft in two stages did on some tiles of a frame: the machine's speed and the frame's noise.
struct Pilot {
  double seconds = 0;       ///< That it is predicted to take on the whole frame.
  double relative_mse = 0;  ///< That its error map expects.
  double share = 0;         ///< Of the frame's pixels that were tried.
  double spent = 0;         ///< Seconds that the pilot itself took.
};

/// Reconstructs about an eighth of the frame (at least four tiles) by draft in two stages: tiles of 64 x 64 pixels at
/// even ranks of their noise, so that quiet and noisy ones are there in their proportion. All threads work, on
/// different tiles. Throws as reconstruct.
Pilot run_pilot(const Frame& frame, Progress& progress);

/// Seconds that Quality::Standard is predicted to take on the whole frame.
double standard_seconds(const Pilot& pilot, const std::array<StepFigures, step_count>& figures);

/// What is asked for; 0: nothing.
struct PlanRequest {
  double seconds = 0;       ///< That the reconstruction may take, the pilot not counted.
  double relative_mse = 0;  ///< That is enough.
};

struct PlannedStep {
  std::string name;
  double seconds = 0, relative_mse = 0;  ///< Predicted.
};

struct Plan {
  Params params;
  PlannedStep step;
  std::optional<PlannedStep> next;  ///< The next dearer step that is more accurate.
  bool met = true;                  ///< False where no step does what was asked for.
};

/// The most accurate step that is predicted to keep to the seconds, or, with an error asked for, the cheapest that
/// reaches it (within the seconds where both are asked for). Where none does: the cheapest, or the most accurate one.
Plan make_plan(const Pilot& pilot, const PlanRequest& request, const std::array<StepFigures, step_count>& figures);

}  // namespace polyrecon
