#pragma once

#include <vector>

#include "core/image.h"
#include "regression/window.h"

namespace polyrecon {

/// Patch distances are cut where even the widest bandwidth leaves a weight below exp(-cut_exponent).
constexpr Real cut_exponent = 7;

/// Patch distance of the non-local means filter (Buades et al. 2005, in the noise-aware form of Rousselle et al. 2012)
/// between every centre of a block and every pixel of its window:
///     mean over the patch of  sum_rgb ((a - b)^2 - (va + min(va, vb))) / sum_rgb (va + vb + eps (a^2 + b^2))
/// about 0 for two pixels of one colour, whatever the noise. Patches repeat the pixels at the image's border.
class PatchDistances {
 public:
  /// guide: 3 channels of the half that is not fitted; variance: of that half. `block` is where the centres stand;
  /// centres are given as image coordinates inside it.
  void compute(const Image& guide, const Image& variance, const Rect& block, const std::vector<int>& center_x,
               const std::vector<int>& center_y, int window_radius, int patch_radius);

  /// Lists the pixels of the window around a centre, row by row, whose distance is below limit, with their distance
  /// (negative ones as 0).
  void window_of(std::size_t center, Real limit, Window& window) const;

 private:
  void load(const Image& guide, const Image& variance, const Rect& area);
  void all_centers(const Rect& block, int patch_radius);
  void one_center(std::size_t center, int patch_radius);
  void offset_distances(int dx, int dy, const Rect& area, int patch_radius);

  int radius_ = 0, width_ = 0, height_ = 0;
  std::vector<int> center_x_, center_y_;
  Rect loaded_;                   ///< Area of loaded_planes_; reaches beyond the image.
  std::vector<Real> planes_;      ///< Guide RGB, variance RGB over loaded_, border pixels repeated.
  std::vector<Real> difference_;  ///< Distance of single pixels for one offset.
  std::vector<Real> row_sums_;
  std::vector<Real> distance_;  ///< centres x (2 radius + 1)^2.
};

/// w_i = exp(-d_i / bandwidth^2), cut at cut_exponent: the kernel K_h of equations (3) and (4). Fills window.padded
/// weights, zero beyond window.count, and returns their sum.
double kernel_weights(const Window& window, Real bandwidth, Real* weight);

}  // namespace polyrecon
