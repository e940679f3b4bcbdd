#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "polyrecon/params.h"

namespace polyrecon {

/// Named parameters that --time-budget and --target choose from (presets/settings_choice.h).
struct Preset {
  std::string name;  ///< "draft, stages 2"
  Params params;
};
constexpr std::size_t preset_count = 8;

/// All presets, roughly from fast to accurate. One of them is Quality::Standard.
std::array<Preset, preset_count> presets();

/// Time and error of a preset, as factors of those of Quality::Standard.
struct PresetFigures {
  double seconds = 1;  ///< Time of the reconstruction.
  double error = 1;    ///< relMSE
};

/// Figures of all presets, measured on the samples by tests/bench/accuracy.py.
const std::array<PresetFigures, preset_count>& measured_figures();

}  // namespace polyrecon
