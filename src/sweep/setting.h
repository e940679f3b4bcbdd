#pragma once

#include <array>
#include <string>
#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/params.h"

namespace polyrecon {

/// One way to reconstruct a frame, as a sweep tries it.
struct Setting {
  std::string name;   ///< "stride 2"; unique within a sweep.
  std::string group;  ///< What is varied: one of setting_groups().
  Params params;
  bool without_halves = false;  ///< Half buffers of the file are not used: they are split from the mean.
  bool without_prior = false;   ///< The denoised layer of the file is not used.
};

/// Groups of settings that trade time for accuracy, and "parts": each part of the method taken out alone.
const std::vector<std::string>& setting_groups();

/// The settings of the named groups that make a difference for this frame, each once; Quality::Standard, which all but
/// "quality" and "steps" vary, comes first.
std::vector<Setting> settings_for(const Frame& frame, const std::vector<std::string>& groups);

/// The frame as a setting wants it.
Frame frame_for(const Frame& frame, const Setting& setting);

/// The ladder that a budget of time or an error to reach is met on (plan.h): from cheap to dear.
struct Step {
  std::string name;
  Params params;
};
constexpr std::size_t step_count = 8;
std::array<Step, step_count> ladder();

}  // namespace polyrecon
