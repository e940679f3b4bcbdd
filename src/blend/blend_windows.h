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

/// Settings of fit_and_blend. fit_params and first_fit_params (pipeline/stage.h) derive them from Params, which has the
/// defaults.
struct FitParams {
  int radius = 0;                ///< Radius of the window Omega_c, pixels.
  int stride = 0;                ///< Distance of the centres of the first lattice, pixels.
  PatchParams patch;             ///< Patches by whose distance the pixels of a window are weighted.
  std::vector<Real> bandwidths;  ///< h of the kernel K_h, rising; one blended image each.
  int max_order = 0;             ///< Highest Taylor order that select_order may choose, 0..4.
  double order_tolerance = 0;    ///< See select_order.
  double coverage = 0;           ///< Centres of finer lattices are added at pixels whose kernel weights sum to less.
  bool shrinkage = true;         ///< See select_order.
};

/// The inputs of fit_and_blend; all images have one size.
struct FitSource {
  const Image* response = nullptr;        ///< Beauty and AOVs of the half that is fitted.
  const Image* noise_variance = nullptr;  ///< Noise variance of the beauty of that half, 3 channels.
  const Image* features = nullptr;        ///< Those of the other half.
  const Image* guide = nullptr;           ///< Colours that patches are compared in: the other half's or the previous
                                          ///< stage's, 3 channels.
  const Image* guide_variance = nullptr;  ///< Noise variance of guide.
  const Image* guess = nullptr;           ///< The previous stage's guess of mu, 3 channels; null in stage 1.
  double epsilon = 0;                     ///< As in HalfPair; see BlendedFit.
  const Image* mask = nullptr;            ///< HalfPair::sampled: other pixels are in no window. Null: all may be.
  const Image* other = nullptr;           ///< Colours of the half that is not fitted; needed with a bound.
  const Image* bound = nullptr;           ///< HalfPair::bound. Null or empty: windows count by their weights alone.
};

/// The overlapping windows of one bandwidth, blended by equation (3). The bias is the weighted mean of the biases of
/// the windows: by Minkowski's inequality this is the tightest bound that does not depend on their signs. The bias of a
/// window is relative to its mean of fit^2 + epsilon, so that an error in a bright part of a window does not count
/// fully in the dark part next to it.
///
/// A window may fit most of its pixels and contradict a few: one that covers a glint smears it over its neighbours. So
/// where the squared distance d^2 of a fit from the other half's pixel, summed over the colours, exceeds the noise
/// bound b, the window's weight at that pixel is multiplied by exp(1 - d^2 / b). A pixel without noise takes no fit.
/// All colours and layers share the factor, so layers that add up to the beauty still do, and no pixel is clipped,
/// which would draw an edge.
struct BlendedFit {
  Image value;         ///< Channels as in FitSource::response.
  Image squared_bias;  ///< Squared bias of value, from the windows' (5), 3 channels; radiance squared.
  Image variance;      ///< Variance (6) of the windows, blended like the value, 3 channels; radiance squared.
  Image order;         ///< Taylor order k, blended, 1 channel.
};

/// Channels of a BlendedFit.
std::size_t blended_fit_channels(std::size_t color_channels);

/// Channels of the sums that fit_and_blend holds for each bandwidth.
std::size_t blend_sums_channels(std::size_t color_channels);

/// Bytes per pixel of the masks that fit_and_blend holds: centres needed, centres of the lattice, centres done.
constexpr std::size_t blend_mask_bytes = 3;

/// Counts over all windows. They are integers, so the order of the threads does not matter.
struct FitCounters {
  std::atomic<std::size_t> windows{0}, rank_deficient{0}, dropped{0}, uncovered_pixels{0};
  std::array<std::atomic<std::size_t>, BasisLayout::max_models> per_model{};
};

/// Centres are placed and pixels are summed in blocks aligned to this many pixels. The result for a crop that begins at
/// a multiple of twice this size has the same bits as that part of the whole image's.
constexpr int block_size = 64;
constexpr int block_groups = 4;  // even or odd column, even or odd row of blocks; worked one group after the other

/// Pixels around a region that its result depends on: window radius, radius of the windows that cover a pixel, and
/// patch radius; more where there are many lattices, since the centres of each lattice depend on those before.
int fit_halo(const FitParams& params);

/// Fits a window (2) around every stride-th pixel, chooses its order (7) and blends the windows (3), for every
/// bandwidth. Then halves the stride, down to single pixels, and adds centres where the sum of the kernel weights is
/// below FitParams::coverage. active: one byte per pixel, 0 for pixels whose result does not matter. Windows that cover
/// no active pixel are skipped. Pixels that no finite fit covers keep the response.
std::vector<BlendedFit> fit_and_blend(const FitSource& source, const std::vector<unsigned char>& active,
                                      const FitParams& params, FitCounters& counters, Progress& progress);

}  // namespace polyrecon
