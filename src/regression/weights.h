#pragma once

#include <limits>
#include <vector>

#include "polyrecon/image.h"
#include "polyrecon/params.h"
#include "regression/window.h"

namespace polyrecon {

/// Patch distances are cut where even the widest bandwidth leaves a weight below exp(-cut_exponent).
constexpr Real cut_exponent = 7;

/// Patch distance of the non-local means filter (Buades et al. 2005, in the noise-aware form of Rousselle et al. 2012)
/// between a centre and every pixel of its window:
///     mean over the patch of  (|a - b|^2 - (va + min(va, vb))) / (va + vb + eps (|a|^2 + |b|^2))
/// with colours a, b and their noise variances va, vb summed over RGB: about 0 for two pixels of one colour, whatever
/// the noise. Patches repeat the pixels at the image's border. Pixels around the middle one count up to
/// PatchParams::most_around: one lamp in the corner of a patch does not make it unlike all others.
///
/// What two pixels of a row of patches differ by is summed along the row once and serves all centres of a column whose
/// patches have that row: centres are best asked for column by column.
class PatchDistances {
 public:
  /// guide: 3 channels of the half that is not fitted; variance: of that half. `block` is where the centres stand.
  void load(const Image& guide, const Image& variance, const Rect& block, int window_radius, const PatchParams& patch);

  /// Lists the pixels of the window around a centre (image coordinates inside the block) whose distance is below the
  /// last of the limits, which rise, with their distance (negative ones as 0): those below the first limit, row by row,
  /// then those below the second, and so on, so that each limit's pixels are the first window.within[k] of the list.
  void window_of(int center_x, int center_y, const std::vector<Real>& limits, Window& window);

 private:
  static constexpr std::size_t planes = 5;  ///< RGB, v, v + eps |a|^2.
  static constexpr int nowhere = std::numeric_limits<int>::min();

  /// Pixel a of the centre's patch, and b of the patches of the window's pixels, at the same place of each; by plane.
  struct RowOfPixels {
    Real a[planes];
    const Real* b[planes];
  };

  void begin_column(int center_x);
  void copy_rows(int y0, int y1);              ///< Into strip_.
  RowOfPixels pixels_of(int y, int px) const;  ///< Of row y, column px of the patch; the row is in strip_.
  const Real* row_sums(int y);                 ///< Differences of the window's pixels, summed over row y of the patch.
  void sum_patches(int center_y);              ///< -> distance_, sums over the patch.
  int window_samples() const;                  ///< From a window's first pixel to its last, rows of pitch_ samples.
  std::size_t slot_of(int y) const;            ///< Of row y of a patch in sums_ and summed_.
  /// Lists the pixels inside whose distance is below limit in near_, as 64 y + x from the window's corner; their
  /// number. Each is written whether it stays or not, as no processor foresees which: the next one takes its place.
  std::size_t find_near(const Rect& inside, int center_x, int center_y, Real limit);

  int radius_ = 0, patch_radius_ = 0, pitch_ = 0;
  Real most_ = 0;                    ///< PatchParams::most_around.
  Rect bounds_, loaded_;             ///< Of the image; of loaded_planes_, which reach beyond it.
  std::vector<Real> loaded_planes_;  ///< planes x loaded_, border pixels repeated.

  // What the windows of one column of centres share.
  int column_ = nowhere;     ///< Where it is.
  std::vector<Real> strip_;  ///< planes x loaded rows x the pitch_ pixels that its patches reach.
  int copied_from_ = nowhere, copied_to_ = nowhere;  ///< Rows of strip_ that are filled.
  std::vector<Real> sums_;      ///< Of the last rows of patches, 2 patch radius + 1 times window_samples().
  std::vector<int> summed_;     ///< Which rows these are.
  std::vector<Real> distance_;  ///< Of one window, rows of pitch_ samples, the first 2 radius + 1 in use.
  std::vector<int> near_;       ///< See find_near.
};

/// w_i = exp(-d_i / bandwidth^2), cut at cut_exponent: the kernel K_h of equations (3) and (4). Fills window.padded
/// weights, zero beyond window.count, and returns their sum.
double kernel_weights(const Window& window, Real bandwidth, Real* weight);

}  // namespace polyrecon
