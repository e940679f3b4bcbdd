// The parameters of a reconstruction, with the defaults of each quality. Distances are pixels unless stated otherwise.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "polyrecon/image.h"
#include "polyrecon/roles.h"

namespace polyrecon {

/// The patches whose difference gives a pixel its weight in a window.
struct PatchParams {
  int radius = 1;                                            ///< 0..4.
  Real most_around = std::numeric_limits<Real>::infinity();  ///< Largest difference that a pixel counts with, unless it
                                                             ///< is the middle one of the patch.
};

/// The prefilter of noisy features: non-local means.
struct PrefilterParams {
  int search_radius = 5;
  int patch_radius = 3;
  double bandwidth = 0.5;
};

/// The conditions under which a pixel is an outlier (a firefly), equation (10).
struct OutlierParams {
  int neighbourhood = 2;  ///< Radius of the neighbourhood that the pixel is compared with.
  double height = 3;      ///< Least height above the median, in units of (upper end of the neighbourhood - median).
  /// Least height above the same pixel of the other half, in units of the third largest difference between the halves
  /// in the neighbourhood.
  double height_over_other_half = 8;
  double reliability = 4;  ///< Largest height of an outlier in its own standard deviations; above, it is reliable.
                           ///< Ignored if the variance is estimated from the image.
  int density_radius = 9;  ///< Radius within which outliers are counted.
  double density = 0.01;   ///< Largest share of other outliers in that radius; where there are more, they are kept.
};

/// The choice between candidates by cross-validation.
struct SelectParams {
  double risk_sigma = 3;   ///< Standard deviation of the Gaussian that averages the estimated errors.
  double map_sigma = 1.5;  ///< Standard deviation of the Gaussian that smooths the shares of the candidates.
};

/// How frames before and after are averaged into a frame.
struct TemporalParams {
  int radius = 0;                          ///< Frames before and after that may take part, 0..8.
  std::vector<double> scales{1, 2, 4, 8};  ///< Standard deviations of the Gaussians under which a change is looked for.
  double accept = 3;      ///< Squared change, in units of its variance from noise, that does not lower a weight.
  double softness = 2;    ///< Above that, a weight falls as exp(-(change - accept) / softness).
  double max_weight = 4;  ///< Largest weight of a neighbour's pixel; the frame's pixel has weight 1.
};

/// The input of another denoiser in this process.
struct DenoiserParams {
  int mean_runs = 2;               ///< Times that the mean is denoised, next to the halves: 0..4.
  bool prefilter_features = true;  ///< Whether it prefilters the features itself; if not, it gets those of the fits.
};

/// The steps of the method that may run.
struct Steps {
  bool decide = true;  ///< Whether steps that the frame does not need are left out; if not, all allowed steps run.
  RoleSet features = feature_roles();  ///< Feature passes that may take part in the fit.
  bool prefilter = true;               ///< Prefilter of noisy feature passes.
  bool fireflies = true;               ///< Removal of fireflies, and redistribution of their energy.
};

/// Presets: Draft is the fastest, Best the slowest.
enum class Quality { Draft, Standard, Best };

struct NamedQuality {
  Quality quality;
  const char* name;
};

/// All qualities by name, from fast to accurate.
inline constexpr std::array<NamedQuality, 3> qualities{
    {{Quality::Draft, "draft"}, {Quality::Standard, "standard"}, {Quality::Best, "best"}}};

/// Components of the method that can be switched off to measure their effect (docs/results/accuracy.md).
struct Components {
  bool cross_filter = true;      ///< A half is fitted with weights and features of the other half.
  bool shrinkage = true;         ///< Each column enters a fit by the factor of least estimated error, not whole.
  bool variance_floor = true;    ///< The variance of a pixel is at least what its neighbourhood suggests.
  bool noise_bound = true;       ///< Windows count less for pixels whose noise they contradict.
  bool raise_undershoot = true;  ///< A result is not below every input within 2 pixels.
  bool restore_totals = true;    ///< The sum of each channel of the result is that of the input.
};

/// All parameters of a reconstruction with the defaults of Quality::Standard.
struct Params {
  int stages = 2;                            ///< Rounds of error estimation, equations (8) and (9), 1..4.
  int levels = 3;                            ///< Resolutions: the frame, its half, its quarter, ...; 1..5.
  int radius = 10;                           ///< Radius of the windows, 1..20.
  int stride = 4;                            ///< Distance between window centres, 1..radius.
  PatchParams patch;                         ///< Patches if the variance of each pixel is known.
  PatchParams estimated_patch{2, Real(10)};  ///< Patches if the variance is estimated from the image, which is less
                                             ///< exact for single pixels.
  int max_order = 2;                         ///< Highest Taylor order that a window may choose, 0..4.
  // Bandwidths of equation (4), > 0, in rising order; each makes a candidate.
  std::vector<Real> first_bandwidths{Real(0.7)};              ///< Stage 1; at least one.
  std::vector<Real> later_bandwidths{Real(0.35), Real(0.7)};  ///< Later stages, weights from the noisy half; at least
                                                              ///< one.
  std::vector<Real> guided_bandwidths{Real(0.5), Real(1)};    ///< Later stages, weights from the previous result.
  double order_tolerance =
      0.02;             ///< Orders whose estimated errors are this close to the least, relative, are averaged.
  double coverage = 2;  ///< Centres are added where the weights of all windows sum to less; 0: nowhere.
  PrefilterParams prefilter;
  OutlierParams outliers;
  SelectParams selection;
  double enough = 0;  ///< Pixels keep the input if their noise variance / (value^2 + 0.01) is at most this; >= 0.
  Steps steps;
  Components components;
  TemporalParams temporal;
  DenoiserParams denoiser;
  bool reconstruct_alpha = false;  ///< Whether alpha is reconstructed with the beauty's windows; if not, it is kept.
  std::size_t max_memory = std::size_t{4} << 30;  ///< Bytes; a frame that needs more is worked in tiles.
};

/// The parameters of a quality.
Params params_for(Quality quality);

/// Throws Error{Usage} that names the first value out of its range.
void validate(const Params& params);

}  // namespace polyrecon
