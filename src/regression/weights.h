#pragma once

#include <vector>

#include "core/image.h"
#include "regression/window.h"

namespace polyrecon {

/// Patch distances are cut where even the widest bandwidth leaves a weight below exp(-cut_exponent).
constexpr Real cut_exponent = 7;

/// Patch distance of the non-local means filter (Buades et al. 2005, in the noise-aware form of Rousselle et al. 2012)
/// between a centre and every pixel of its window:
///     mean over the patch of  (|a - b|^2 - (va + min(va, vb))) / (va + vb + eps (|a|^2 + |b|^2))
/// with colours a, b and their noise variances va, vb summed over RGB: about 0 for two pixels of one colour, whatever
/// the noise. Patches repeat the pixels at the image's border.
class PatchDistances {
 public:
  /// guide: 3 channels of the half that is not fitted; variance: of that half. `block` is where the centres stand.
  void load(const Image& guide, const Image& variance, const Rect& block, int window_radius, int patch_radius);

  /// Lists the pixels of the window around a centre (image coordinates inside the block), row by row, whose distance is
  /// below limit, with their distance (negative ones as 0).
  void window_of(int center_x, int center_y, Real limit, Window& window);

 private:
  static constexpr std::size_t planes = 5;  ///< RGB, v, v + eps |a|^2.

  void surround(int center_x, int center_y);  ///< Copies what the window's patches cover into around_.
  void sum_patches();                         ///< around_ -> distance_, sums over the patch.

  int radius_ = 0, patch_radius_ = 0, pitch_ = 0;
  Rect bounds_, loaded_;             ///< Of the image; of loaded_planes_, which reach beyond it.
  std::vector<Real> loaded_planes_;  ///< planes x loaded_, border pixels repeated.
  std::vector<Real> around_;         ///< planes x rows of pitch_ samples.
  std::vector<Real> distance_;       ///< Rows of pitch_ samples, the first 2 radius + 1 of each in use.
};

/// w_i = exp(-d_i / bandwidth^2), cut at cut_exponent: the kernel K_h of equations (3) and (4). Fills window.padded
/// weights, zero beyond window.count, and returns their sum.
double kernel_weights(const Window& window, Real bandwidth, Real* weight);

}  // namespace polyrecon
