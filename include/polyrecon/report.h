#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

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

/// Wall-clock seconds of one stage of the pipeline.
struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// What a reconstruction did. Everything here is counted or measured, nothing is assumed.
struct Report {
  int width = 0, height = 0;
  std::vector<StageTime> stages;
  std::vector<Decision> decisions;
  std::string variance_source;  ///< "from the file", "from half buffers" or "estimated from the image".

  std::size_t windows = 0;                         ///< Local fits made.
  std::array<std::size_t, 6> windows_per_order{};  ///< [0]: constant only; [k]: order k - 1 with features, k = 1..5.
  std::size_t rank_deficient_windows = 0;       ///< Fits in which a column depends on others: counts for half at most.
  std::size_t dropped_windows = 0;              ///< Fits that were not finite and left out.
  std::size_t pixels_fallen_back_to_input = 0;  ///< Pixels that no finite fit covered.
  std::size_t bound_pixels = 0;                 ///< Pixels kept within reach of their noise (blend/noise_bound.h).
  std::size_t raised_pixels = 0;                ///< Pixels raised to the least input around them (blend/undershoot.h).
  std::size_t repaired_pixels = 0;              ///< Non-finite input pixels replaced before the fit, all passes.
  std::size_t negative_pixels = 0;              ///< Beauty pixels with a negative channel (kept as they are).

  std::size_t neighbours = 0;   ///< Frames before and after that joined.
  double neighbour_weight = 0;  ///< Mean weight of all of them beside the own pixel's 1.

  std::size_t outliers = 0;                ///< Pixels replaced by equation (10)'s median.
  std::array<double, 3> outlier_energy{};  ///< Sum of e_o per channel, radiance x pixels.
  std::array<double, 3> restored_gain{};   ///< Factor - 1 by which each channel was brought to the input's mean.
  std::array<double, 3> energy_before{};   ///< Mean of the noisy beauty per channel.
  std::array<double, 3> energy_after{};    ///< Mean of the result per channel.
  double estimated_relative_mse = 0;       ///< Mean of the error map's relative MSE.
};

}  // namespace polyrecon
