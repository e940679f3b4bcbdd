#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "polyrecon/image.h"

namespace polyrecon {

struct PatchParams {
  int radius = 1;
  Real most_around = std::numeric_limits<Real>::infinity();  ///< What a pixel around the middle one counts at most.
};

struct PrefilterParams {
  int search_radius = 5;
  int patch_radius = 3;
  double bandwidth = 0.5;
};

struct OutlierParams {
  int neighbourhood = 2;             ///< Radius of the neighbourhood that an outlier stands out of, pixels.
  bool variance_is_measured = true;  ///< Otherwise the variance says nothing of single pixels and is not asked.
  double height = 3;  ///< How far above the median it stands, in units of (upper end of the neighbourhood - median).
  /// How far above the other half's pixel it stands, in units of the third largest difference of the halves around.
  double height_over_other_half = 8;
  double reliability = 4;  ///< It is unreliable: its excess is below this many of its own standard deviations.
  int density_radius = 9;  ///< Where outliers are common within this radius they are the light itself and stay.
  double density = 0.01;   ///< Part of the pixels around that may be outliers, beside the pixel itself.
};

struct SelectParams {
  double risk_sigma = 3;   ///< Gaussian over which cross-validated errors are averaged, pixels.
  double map_sigma = 1.5;  ///< Gaussian by which the choice itself is smoothed.
};

struct TemporalParams {
  int radius = 0;                          ///< Frames before and after that may join; 0..8.
  std::vector<double> scales{1, 2, 4, 8};  ///< Standard deviations of the Gaussians that look for a change, pixels.
  double accept = 3;                       ///< Change, in units of what noise alone brings, that is not minded.
  double softness = 2;                     ///< A neighbour's weight falls as exp(-(change - accept) / softness).
  double max_weight = 4;                   ///< Most weight of an estimate beside the pixel's own.
};

/// Which steps may run, and who decides.
struct Steps {
  bool decide = true;  ///< A look at the frame leaves out what it does not call for; false: all that is allowed runs.
  bool normal = true, albedo = true, depth = true, visibility = true;  ///< Feature passes that may take part.
  bool prefilter = true;                                               ///< Of noisy feature passes.
  bool outliers = true;  ///< Their removal, and the return of their light.
};

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
};

Params params_for(Quality quality);

/// Throws Error{Usage} naming the first value out of its range.
void validate(const Params& params);

}  // namespace polyrecon
