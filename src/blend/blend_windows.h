#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

#include "polyrecon/image.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "regression/basis.h"
#include "regression/weights.h"

namespace polyrecon {

struct FitParams {
  int radius = 9;                ///< Of the window Omega_c, pixels.
  int stride = 2;                ///< Distance of the first lattice of window centres, pixels.
  PatchParams patch;             ///< Of the patches whose distance weighs the window.
  std::vector<Real> bandwidths;  ///< h of the kernel K_h, rising; one blended image each.
  int max_order = 2;             ///< Highest Taylor order offered, 0..4.
  double order_tolerance = 0;    ///< See select_order.
  double coverage = 1;           ///< Where the kernel weights sum to less, centres of finer lattices are added.
  bool shrinkage = true;         ///< See select_order.
};

/// Everything one blended image is made from; all images of one size.
struct FitSource {
  const Image* response = nullptr;        ///< Beauty and AOVs of the half that is fitted.
  const Image* noise_variance = nullptr;  ///< Of its beauty, 3 channels.
  const Image* features = nullptr;        ///< Of the other half.
  const Image* guide = nullptr;  ///< Colours of the other half (or of the stage before), 3 channels: the weights.
  const Image* guide_variance = nullptr;  ///< Noise variance of guide.
  const Image* guess = nullptr;           ///< mu as the stage before saw it, 3 channels; null in stage 1.
  double epsilon = 0;  ///< What is added to squared radiance where errors are relative to it; > 0. See BlendedFit.
};

/// The windows of one bandwidth, overlapped and blended by equation (3). Biases are blended as such, not their squares:
/// Minkowski's inequality, the tightest bound there is without knowing their signs; and relative to the mean of
/// fit^2 + epsilon over the window, so that what a window gets wrong in the light is not all put on the shade beside
/// it.
struct BlendedFit {
  Image value;         ///< As FitSource::response.
  Image squared_bias;  ///< Of the value, from the windows' (5), 3 channels; radiance squared.
  Image variance;      ///< Of the windows, equation (6), blended like the value, 3 channels; radiance squared.
  Image order;         ///< Taylor order k, blended, 1 channel.
};

/// Channels of a BlendedFit.
std::size_t blended_fit_channels(std::size_t color_channels);

/// Channels of the sums that fit_and_blend holds for each bandwidth.
std::size_t blend_sums_channels(std::size_t color_channels);

/// Bytes per pixel of the masks that fit_and_blend holds: centres needed, centres of the lattice, centres done.
constexpr std::size_t blend_mask_bytes = 3;

/// Counted over all windows; plain sums, so the order of the threads does not matter.
struct FitCounters {
  std::atomic<std::size_t> windows{0}, rank_deficient{0}, dropped{0}, uncovered_pixels{0};
  std::array<std::atomic<std::size_t>, BasisLayout::max_models> per_model{};
};

/// Centres are placed and pixels summed in blocks aligned to this many pixels; a crop that begins at a multiple of
/// twice it is worked with the same bits as the whole.
constexpr int block_size = 64;

/// Pixels around a region that fit_and_blend looks at: window + the windows that reach a pixel + patch, and more where
/// lattices are many, since the centres of each depend on the ones before.
int fit_halo(const FitParams& params);

/// Fits a window (2) around every stride-th pixel, chooses its order (7) and blends the windows (3), for every
/// bandwidth; then halves the stride and adds the centres that coverage calls for, down to single pixels. `active` (one
/// byte a pixel) tells which pixels matter; windows that cover none of them are left out, pixels that no finite fit
/// covers keep the response.
std::vector<BlendedFit> fit_and_blend(const FitSource& source, const std::vector<unsigned char>& active,
                                      const FitParams& params, FitCounters& counters, Progress& progress);

}  // namespace polyrecon
