#pragma once

#include <vector>

#include "polyrecon/image.h"
#include "regression/basis.h"

namespace polyrecon {

/// Weighted root mean square over a window that a feature, whose values are of order 1, must have beside the columns
/// before it. What varies by less is rounding, of cleaned features above all: even where they are flat, every pixel is
/// a quotient of other sums. As a column of its own it would be fitted to the noise
/// (docs/lab/2026-11-27-float-and-double.md).
inline constexpr double least_variation = 2e-4;

/// The pixels of one window Omega_c that may carry weight, gathered from the images into contiguous columns. Reused
/// from centre to centre, so that the inner loops neither allocate nor jump through memory. Rows beyond count (up to
/// padded) are other pixels of the window or repeat its centre, and always have weight 0.
struct Window {
  static constexpr int lanes = 16;  ///< Columns are padded to a multiple of this, for the vector units.

  BasisLayout layout{0, 0};  ///< Of the design's columns.

  int count = 0;   ///< Pixels in the window.
  int padded = 0;  ///< count rounded up to a multiple of lanes.
  int stride = 0;  ///< Distance between columns; at least padded, and more than pixels in the whole window.
  int pitch = 0;   ///< Distance between rows of the design; its columns rounded up to a multiple of 2 vector_lanes.
  std::vector<int> within;  ///< How many of the pixels, from the first, lie within each limit of the distance.

  std::vector<int> x, y;             ///< Position of each pixel in the image.
  std::vector<int> offset;           ///< Its index in a plane of the image.
  std::vector<Real> distance;        ///< Patch distance of each pixel to the centre, >= 0.
  std::vector<double> design;        ///< The model's columns at each pixel, stride rows of pitch values: those of
                                     ///< layout.columns() as Real has them, then zeros.
  std::vector<Real> response;        ///< y at each pixel minus y at the centre, channels x stride.
  std::vector<Real> origin;          ///< y at the centre, channels.
  std::vector<Real> noise_variance;  ///< sigma^2 at each pixel, 3 x stride.
  std::vector<Real> guess;           ///< The guess of mu of the stage before minus that at the centre, 3 x stride;
                                     ///< unused in stage 1.

  /// Taylor terms of orders 1 to k at every pixel of a whole window, as taylor_terms in window.cpp makes them once for
  /// a radius and an order: rows of a multiple of vector_lanes values, at least that many of them zeros at the end.
  std::vector<Real> taylor;
  int taylor_radius = -1, taylor_order = -1;  ///< Of these.

  /// Makes room for windows of the given radius.
  void reserve(int radius, int columns, int channels);
  /// Sees to it that taylor is that of this radius and order.
  void expand(int radius, int order);
  /// Lets only the first pixels of those gathered take part.
  void take(int pixels);
};

/// What a window is gathered from; all images of one size.
struct WindowSource {
  const Image* response = nullptr;        ///< Beauty and AOVs of one half, 3 channels each.
  const Image* noise_variance = nullptr;  ///< Variance of the half's beauty, 3 channels at most.
  const Image* features = nullptr;        ///< Features of the other half.
  const Image* guess = nullptr;           ///< mu as the stage before saw it, 3 channels; null in stage 1.
};

/// Fills design, response, noise_variance and guess for the pixels already listed in window.x, window.y (count of
/// them), and sets window.layout: that of `layout` without the features that do not vary over the window but by
/// rounding. Features enter minus their value at the centre, positions as (i - c) / radius, both of order 1 or below:
/// the columns of equation (2) but for scale. y and the guess enter minus their values at the centre as well, which
/// changes nothing but the coefficient of the constant: else the errors of bright, quiet windows, differences of
/// energies, would drown in the rounding of q.
void gather(const WindowSource& source, const BasisLayout& layout, int center_x, int center_y, int radius,
            Window& window);

}  // namespace polyrecon
