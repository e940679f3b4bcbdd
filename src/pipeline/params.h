#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "blend/blend_windows.h"
#include "blend/select.h"
#include "core/decision.h"
#include "features/prefilter.h"
#include "temporal/join.h"

namespace polyrecon {

enum class Quality { Draft, Standard, Best };

/// Parts of the method that can be taken out, to measure what each is worth (docs/results/accuracy.md).
struct Parts {
  bool cross_filter = true;      ///< A half is fitted with weights and features of the other one.
  bool shrinkage = true;         ///< Columns enter with the factor of least error, not whole (order_selection.h).
  bool variance_floor = true;    ///< noise/variance_floor.h
  bool noise_bound = true;       ///< blend/noise_bound.h
  bool raise_undershoot = true;  ///< blend/undershoot.h
  bool restore_totals = true;    ///< The result's channels are brought to the sums of the input's.
};

/// Everything that steers a reconstruction; the only home of its defaults.
struct Params {
  int stages = 2;                            ///< Rounds of error estimation, equations (8) and (9); 1..4.
  int levels = 3;                            ///< Resolutions worked: the frame, its half, its quarter; 1..5.
  int radius = 10;                           ///< Of the windows, pixels; 1..20.
  int stride = 4;                            ///< Distance of the window centres where windows agree, pixels; 1..radius.
  PatchParams patch;                         ///< Of the patches that weigh a window; radius 0..4.
  PatchParams estimated_patch{2, Real(10)};  ///< The same where the noise is estimated from the image, which knows no
                                             ///< single pixels.
  int max_order = 2;                         ///< Highest Taylor order offered to the selection, 0..4.
  std::vector<Real> first_bandwidths{Real(0.7)};              ///< Stage 1. Rising, as the others.
  std::vector<Real> later_bandwidths{Real(0.35), Real(0.7)};  ///< Later stages, weights from the noisy half.
  std::vector<Real> guided_bandwidths{Real(0.5), Real(1)};    ///< Later stages, weights from the stage before.
  double order_tolerance = 0.02;  ///< Orders are averaged whose estimated errors are within this of the least.
  double coverage = 2;            ///< Sum of weights below which finer centres are added; 0: none.
  PrefilterParams prefilter;      ///< Of noisy feature passes.
  SelectParams selection;
  double enough = 0;  ///< Pixels whose noise variance over (value^2 + 0.01) is below this stay as they are.
  Steps steps;
  Parts parts;
  TemporalParams temporal;         ///< How neighbours in time join, where there are any.
  bool reconstruct_alpha = false;  ///< Reconstruct alpha with the beauty's windows instead of keeping it.
  std::size_t max_memory = std::size_t{4} << 30;  ///< Bytes; larger frames are worked in tiles.

  FitParams fit(const std::vector<Real>& bandwidths) const {
    return {radius, stride, patch, bandwidths, max_order, order_tolerance, coverage, parts.shrinkage};
  }
  /// Of stage 1. Where others follow it only guesses mu for them, and fewer windows do.
  FitParams first_fit() const {
    FitParams fit_params = fit(first_bandwidths);
    if (stages > 1) {
      fit_params.stride = std::min(stride + stride / 2, radius);
      fit_params.coverage = coverage / 4;
    }
    return fit_params;
  }
};

Params params_for(Quality quality);

/// Throws Error{Usage} naming the first value out of its range.
void validate(const Params& params);

}  // namespace polyrecon
