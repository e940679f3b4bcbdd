#pragma once

#include <limits>
#include <vector>

#include "polyrecon/image.h"
#include "polyrecon/params.h"
#include "regression/window.h"

namespace polyrecon {

/// A kernel weight below exp(-cut_exponent) = 9e-4 is set to 0, so a window ends where the patch distance reaches
/// cut_exponent times the square of its widest bandwidth.
constexpr Real cut_exponent = 7;

/// Patch distance of the non-local means filter (Buades et al. 2005, in the noise-aware form of Rousselle et al. 2012)
/// between a centre and every pixel of its window:
///     mean over the patch of  (|a - b|^2 - (va + min(va, vb))) / (va + vb + eps (|a|^2 + |b|^2))
/// with colours a, b and their noise variances va, vb summed over RGB. The distance of two pixels of the same true
/// colour is about 0, whatever the noise. Patches repeat the pixels at the border of the image, and of the mask in
/// it. The term of a pixel other than the middle one is limited to PatchParams::most_around, so that one lamp in the
/// corner of a patch does not make the patch unlike all others.
///
/// The terms of one row of patches are summed along the row once and serve all centres of an image column whose patches
/// contain that row. So window_of is fastest where it is called column by column.
class PatchDistances {
 public:
  /// guide: 3 channels of the half that is not fitted. variance: noise variance of that half. block: contains all
  /// centres that window_of will be called with. mask: the pixels that may be in a window
  /// (core/mask.h), which has to outlive the calls of window_of; null: all may.
  void load(const Image& guide, const Image& variance, const Rect& block, int window_radius, const PatchParams& patch,
            const Image* mask = nullptr);

  /// Lists the pixels of the window around a centre (image coordinates inside the block) whose distance is below the
  /// last limit, together with the distance (negative ones as 0). Limits rise. The pixels below the first limit come
  /// first, row by row, then those below the second limit, and so on: the pixels below limit k are the first
  /// window.within[k] of the list.
  void window_of(int center_x, int center_y, const std::vector<Real>& limits, Window& window);

 private:
  static constexpr std::size_t planes = 5;  ///< RGB, v, v + eps |a|^2.
  static constexpr int nowhere = std::numeric_limits<int>::min();

  /// One pixel a of the centre's patch and the pixels b at the same place of the patches around all pixels of the
  /// window; values by plane.
  struct RowOfPixels {
    Real a[planes];
    const Real* b[planes];
  };

  void begin_column(int center_x);
  void copy_rows(int y0, int y1);              ///< Fills rows y0 to y1 - 1 of strip_.
  RowOfPixels pixels_of(int y, int px) const;  ///< For image row y, which is in strip_, and column px of the patch.
  const Real* row_sums(int y);     ///< The terms of all pixels of the window, summed over the patch's row y.
  void sum_patches(int center_y);  ///< Fills distance_ with sums over whole patches.
  /// Moves to the nearest pixel inside the mask within a patch's radius, if there is one.
  void nearest_in_mask(int& x, int& y) const;
  /// Makes the distance of all pixels of `inside` that are outside the mask infinite.
  void leave_void(const Rect& inside, int center_x, int center_y);
  int window_samples() const;        ///< Samples from the first pixel of a window to its last, in rows of pitch_.
  std::size_t slot_of(int y) const;  ///< Index of patch row y in sums_ and summed_, which are circular.
  /// Lists the pixels of `inside` whose distance is below limit in near_, as 64 y + x from the window's corner, and
  /// returns their number. Branch-free compaction: every pixel is written, and the cursor advances only past near ones.
  std::size_t find_near(const Rect& inside, int center_x, int center_y, Real limit);

  int radius_ = 0, patch_radius_ = 0, pitch_ = 0;
  Real most_ = 0;                    ///< PatchParams::most_around.
  Rect bounds_;                      ///< Bounds of the image.
  const Image* mask_ = nullptr;      ///< Null where all pixels are inside.
  Rect loaded_;                      ///< Area of loaded_planes_; extends beyond the image.
  std::vector<Real> loaded_planes_;  ///< planes x loaded_, border pixels repeated.

  // Shared by the windows of one column of centres.
  int column_ = nowhere;                             ///< Its x in the image.
  std::vector<Real> strip_;                          ///< planes x rows of loaded_ x pitch_ pixels around the column.
  int copied_from_ = nowhere, copied_to_ = nowhere;  ///< Rows of strip_ that are filled.
  std::vector<Real> sums_;      ///< row_sums of the last 2 patch radius + 1 rows, window_samples() values each.
  std::vector<int> summed_;     ///< The y of each row in sums_.
  std::vector<Real> distance_;  ///< Patch sums of one window: rows of pitch_ samples, the first 2 radius + 1 in use.
  std::vector<int> near_;       ///< Filled by find_near.
};

/// The kernel K_h of equations (3) and (4): w_i = exp(-d_i / bandwidth^2), 0 where the exponent exceeds cut_exponent.
/// Fills window.padded weights, zero beyond window.count, and returns their sum.
double kernel_weights(const Window& window, Real bandwidth, Real* weight);

}  // namespace polyrecon
