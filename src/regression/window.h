#pragma once

#include <vector>

#include "polyrecon/image.h"
#include "regression/basis.h"

namespace polyrecon {

/// The least variation of a feature, whose values are of order 1: weighted root mean square over a window of what is
/// left of the feature after the projection onto the columns before it. Smaller variation is rounding, mostly of
/// prefiltered features, where each pixel of a flat region is a quotient of different sums; as a column it would be
/// fitted to the noise (docs/lab/2026-11-27-float-and-double.md).
inline constexpr double least_variation = 2e-4;

/// The pixels of one window Omega_c that may have weight, gathered from the images into contiguous columns. A window
/// object is reused from centre to centre, so that the inner loops neither allocate nor access memory at random. Rows
/// beyond count (up to padded) are other pixels of the window or repeat its centre; their weight is always 0.
struct Window {
  static constexpr int lanes = 16;  ///< Columns are padded to a multiple of this, for vector instructions.

  BasisLayout layout{0, 0};  ///< Layout of the design's columns.

  int count = 0;   ///< Pixels in the window.
  int padded = 0;  ///< count rounded up to a multiple of lanes.
  int stride = 0;  ///< Distance between columns; at least padded, and above the number of pixels of a full window.
  int pitch = 0;   ///< Distance between rows of the design; its columns rounded up to a multiple of 2 vector_lanes.
  std::vector<int> within;  ///< Number of leading pixels below each limit of the distance; see PatchDistances.

  std::vector<int> x, y;             ///< Position of each pixel in the image.
  std::vector<int> offset;           ///< Index of each pixel in a plane of the image.
  std::vector<Real> distance;        ///< Patch distance of each pixel to the centre, >= 0.
  std::vector<double> design;        ///< The model's columns at each pixel: stride rows of pitch values, of which the
                                     ///< first layout.columns() are rounded to Real and the rest are zeros.
  std::vector<Real> response;        ///< y at each pixel minus y at the centre, channels x stride.
  std::vector<Real> origin;          ///< y at the centre, channels.
  std::vector<Real> noise_variance;  ///< sigma^2 at each pixel, 3 x stride.
  std::vector<Real> guess;           ///< The previous stage's guess of mu minus its value at the centre, 3 x stride;
                                     ///< unused in stage 1.

  /// Taylor terms of orders 1 to k at every pixel of a full window, computed once per radius and order. Each row is a
  /// multiple of vector_lanes values, of which at least the last vector_lanes are zeros.
  std::vector<Real> taylor;
  int taylor_radius = -1, taylor_order = -1;  ///< The radius and order that taylor is for.

  /// Allocates for windows of the given radius.
  void reserve(int radius, int columns, int channels);
  /// Makes taylor valid for this radius and order.
  void expand(int radius, int order);
  /// Restricts the window to the first pixels of those gathered.
  void take(int pixels);
};

/// The images that a window is gathered from, all of one size.
struct WindowSource {
  const Image* response = nullptr;        ///< Beauty and AOVs of one half, 3 channels each.
  const Image* noise_variance = nullptr;  ///< Variance of the half's beauty, at most 3 channels.
  const Image* features = nullptr;        ///< Features of the other half.
  const Image* guess = nullptr;           ///< The previous stage's guess of mu, 3 channels; null in stage 1.
};

/// Fills design, response, noise_variance and guess for the window.count pixels listed in window.x and window.y, and
/// sets window.layout to `layout` without the features that vary over the window by rounding only.
///
/// The columns are those of equation (2) up to scale: features minus their value at the centre, and positions as
/// (i - c) / radius, both at most of order 1. The values at the centre are also subtracted from y and from the guess,
/// which changes the coefficient of the constant only. Without that, the error of a bright window with little noise,
/// which is a difference of energies, would be lost in the rounding of q.
void gather(const WindowSource& source, const BasisLayout& layout, int center_x, int center_y, int radius,
            Window& window);

}  // namespace polyrecon
