#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cli/denoise/denoise_options.h"
#include "polyrecon/frame.h"
#include "sweep/settings_choice.h"

namespace polyrecon {

/// How the settings of a frame came about.
struct FramePlan {
  Pilot pilot;
  PlanRequest request;
  Plan plan;
  Params params;  ///< Of the plan, with everything else that the options ask for.
};

/// Chooses the settings that --time-budget and --target ask for. read_seconds: what reading the frame took; writing it
/// is taken to need four times as long. Throws as reconstruct.
FramePlan read_frame_header(const DenoiseOptions& options, const Frame& frame, double read_seconds, Progress& progress);

/// What was chosen, what was predicted and what it took, and what the next step up would cost and gain.
std::string plan_text(const FramePlan& plan, double seconds);
nlohmann::ordered_json plan_json(const FramePlan& plan, double seconds);

}  // namespace polyrecon
