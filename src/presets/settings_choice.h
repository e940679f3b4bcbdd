#pragma once

#include <array>
#include <optional>
#include <string>

#include "polyrecon/denoiser.h"
#include "polyrecon/frame.h"
#include "polyrecon/progress.h"
#include "presets/preset.h"

namespace polyrecon {

/// Predictions of a trial run on some tiles of a frame for the whole frame. The run uses the preset "draft, stages 2".
struct Pilot {
  double seconds = 0;                                ///< Predicted time of that preset on the whole frame.
  double relative_mse = 0;                           ///< Mean of its error map.
  double share = 0;                                  ///< Share of the frame's pixels that were reconstructed, 0..1.
  double spent = 0;                                  ///< Seconds that the run took.
  std::array<double, preset_count> prior_seconds{};  ///< Added to each preset by a denoiser's prior.
};

/// Reconstructs about an eighth of the frame, but at least four tiles, by "draft, stages 2". The tiles of 64 x 64
/// pixels are taken at even ranks of their noise, so that noise-free and noisy ones occur in their true proportion.
/// Each tile is the work of one thread. A denoiser that will make the prior is timed on a crop of the same size. Throws
/// as reconstruct.
Pilot run_pilot(const Frame& frame, Progress& progress, const Denoiser* denoiser = nullptr);

/// Predicted seconds of Quality::Standard on the whole frame.
double standard_seconds(const Pilot& pilot, const std::array<PresetFigures, preset_count>& figures);

/// Limits that the settings must keep; 0: no limit.
struct SettingsRequest {
  double seconds = 0;       ///< Longest time of the reconstruction, without the pilot.
  double relative_mse = 0;  ///< Largest mean relative MSE.
};

/// A preset with its predicted time and error on a frame.
struct Prediction {
  std::string name;
  double seconds = 0, relative_mse = 0;
};

struct SettingsChoice {
  std::size_t preset = 0;  ///< Index into presets().
  Prediction chosen;
  std::optional<Prediction> next;  ///< The next slower preset that is more accurate; none: the most accurate is chosen.
  bool met = true;                 ///< False where no preset keeps the limits.
};

/// With a limit of error: the fastest preset that is predicted to keep it, but none beyond the limit of time.
/// Otherwise the most accurate preset within the limit of time. Where no preset keeps the limits, the choice is the
/// fastest preset or the most accurate one, whichever comes closest. Presets that another one beats in both time and
/// error are never chosen. Errors are predicted without the prior that a denoiser makes.
SettingsChoice choose_settings(const Pilot& pilot, const SettingsRequest& request,
                               const std::array<PresetFigures, preset_count>& figures);

}  // namespace polyrecon
