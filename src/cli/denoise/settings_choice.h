#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cli/denoise/job.h"
#include "polyrecon/frame.h"
#include "presets/settings_choice.h"

namespace polyrecon {

/// The settings that --time-budget and --target chose for a frame, and why.
struct ChosenSettings {
  Pilot pilot;
  SettingsRequest request;
  SettingsChoice choice;
  Params params;  ///< Those of the choice, with what the other options set.
};

/// Runs a pilot on the frame and chooses settings within the limits. read_seconds: the time that reading the frame
/// took; writing it is expected to take four times as long. Throws as reconstruct.
ChosenSettings choose_settings_for(const Job& job, const FrameLimits& limits, const Frame& frame, double read_seconds,
                                   Progress& progress);

/// The choice, the predictions and the time that the reconstruction took, and what the next more accurate preset would
/// cost and gain: as a line of text, and as JSON (docs/reference/report.md).
std::string settings_choice_text(const ChosenSettings& settings, double seconds);
nlohmann::ordered_json settings_choice_json(const ChosenSettings& settings, double seconds);

}  // namespace polyrecon
