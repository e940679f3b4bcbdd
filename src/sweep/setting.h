#pragma once

#include <string>
#include <vector>

#include "polyrecon/frame.h"
#include "polyrecon/params.h"

namespace polyrecon {

/// One way to reconstruct a frame, as a sweep runs it.
struct Setting {
  std::string name;   ///< "stride 2"; unique within a sweep.
  std::string group;  ///< The group that is varied: one of setting_groups().
  Params params;
  bool without_halves = false;  ///< Ignore the file's half buffers; halves are then split from the mean.
  bool without_prior = false;   ///< Ignore the file's denoised layer.
};

/// Names of the groups: settings that trade time for accuracy, and "ablation", where each setting disables one
/// component of the method.
const std::vector<std::string>& setting_groups();

/// The settings of the named groups that can change the result of this frame, each once. Quality::Standard comes
/// first; all groups but "quality" and "presets" change one thing of it.
std::vector<Setting> settings_for(const Frame& frame, const std::vector<std::string>& groups);

/// A copy of the frame without the passes that the setting ignores.
Frame frame_for(const Frame& frame, const Setting& setting);

}  // namespace polyrecon
