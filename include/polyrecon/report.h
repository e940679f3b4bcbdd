// The report of a reconstruction: decisions, counts and times.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace polyrecon {

/// The work that a decision saves: fits of pixels, columns of the fits, or the prefilter of a feature.
enum class Spared { Nothing, Pixels, Columns, Prefilter };

/// Whether a step of the method was run on a frame, and why.
struct Decision {
  std::string step;  ///< In words: "feature albedo", "firefly removal".
  bool run = false;
  std::string reason;
  Spared spared = Spared::Nothing;
  int channels = 0;          ///< Channels of the pass that the decision is about.
  double saved_seconds = 0;  ///< Estimate of the time that the saved work would have taken on this machine.
};

/// Wall-clock seconds of one phase of the pipeline.
struct PhaseTime {
  std::string phase;  ///< "noise variance", "features", ...
  double seconds = 0;
};

/// The phase that fits polynomials, which takes nearly all of the time.
inline constexpr const char* fit_phase = "polynomials";

/// The report of a reconstruction. Apart from estimates that are called so, everything is counted or measured.
struct Report {
  int width = 0, height = 0;      ///< Pixels.
  std::vector<PhaseTime> phases;  ///< In order.
  std::vector<Decision> decisions;
  std::string variance_source;  ///< "from the file", "from the half buffers" or "estimated from the image".

  std::size_t windows = 0;                         ///< Fits of windows.
  std::array<std::size_t, 6> windows_per_order{};  ///< [0]: constant only; [k]: order k - 1 with features, k = 1..5.
  std::size_t rank_deficient_windows = 0;  ///< Fits in which a column depends on others and enters by half at most.
  std::size_t windows_not_finite = 0;      ///< Fits that were not finite and were left out.
  std::size_t pixels_kept_noisy = 0;       ///< Pixels that no finite fit covers.
  std::size_t pixels_raised_to_input = 0;  ///< Pixels raised to the lowest input within 2 pixels.
  std::size_t repaired_pixels = 0;         ///< Non-finite input pixels replaced before the fit, all passes.
  std::size_t negative_pixels = 0;         ///< Beauty pixels with a negative channel, which are kept.

  std::size_t neighbours = 0;         ///< Frames before and after that were averaged into this one.
  double neighbour_weight = 0;        ///< Mean of the neighbours' total weight at noisy pixels; the frame's own is 1.
  double neighbour_shared_noise = 0;  ///< Share of the noisy pixels whose noise the neighbours repeat, as
                                      ///< frames of one random seed do. They do not join there.

  std::size_t outliers = 0;                ///< Fireflies: pixels replaced by the median of equation (10).
  std::array<double, 3> outlier_energy{};  ///< Sum of e_o, equation (11), per channel, radiance x pixels.
  std::array<double, 3> restored_gain{};   ///< Factor by which each channel was brought to the input's mean, minus 1.
  std::array<double, 3> energy_before{};   ///< Mean of the noisy beauty's usable pixels per channel, radiance.
  std::array<double, 3> energy_after{};    ///< Mean of the result per channel, radiance.
  std::array<double, 3> energy_change{};   ///< Change of each channel's sum, over the pixels that are usable in the
                                           ///< input, relative to the sum of the input's magnitudes there.
  double estimated_relative_mse = 0;       ///< ErrorMap::mean_relative_mse.
};

}  // namespace polyrecon
