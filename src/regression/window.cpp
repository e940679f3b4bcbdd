#include "regression/window.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/simd.h"

namespace polyrecon {
namespace {

POLYRECON_SIMD void gather_plane(const Real* plane, const int* offset, Real minus, Real* column, int n) {
  for (int j = 0; j < n; ++j) column[j] = plane[offset[j]] - minus;
}

void gather_channel(const Image& image, int channel, const Window& window, Real minus, Real* column) {
  gather_plane(image.plane(channel), window.offset.data(), minus, column, window.padded);
}

bool is_flat(const Real* plane, const int* offset, Real center, int n) {
  return std::all_of(offset, offset + n, [&](int at) { return std::abs(plane[at] - center) < Real(least_variation); });
}

/// The features that vary over the window: their planes and their values at the centre.
struct VaryingFeatures {
  int count = 0;
  std::array<const Real*, BasisLayout::max_features> plane;
  std::array<Real, BasisLayout::max_features> center;
};

VaryingFeatures varying_features(const Image& features, int number, int center_x, int center_y, const Window& window) {
  VaryingFeatures out;
  for (int f = 0; f < number; ++f) {
    const Real* plane = features.plane(f);
    const Real center = features.at(center_x, center_y, f);
    if (is_flat(plane, window.offset.data(), center, window.count)) continue;
    out.plane[static_cast<std::size_t>(out.count)] = plane;
    out.center[static_cast<std::size_t>(out.count++)] = center;
  }
  return out;
}

/// Computes the terms dx^(o-b) dy^b for b = 0..o, o = 1..order, each from a term of one order below.
void taylor_terms(int order, Real dx, Real dy, Real* term) {
  Real* below = term;
  *term++ = dx;
  *term++ = dy;
  for (int o = 2; o <= order; ++o) {
    Real* const first = term;
    for (int b = 0; b < o; ++b) *term++ = below[b] * dx;
    *term++ = below[o - 1] * dy;
    below = first;
  }
}

std::size_t taylor_width(int order) {
  return static_cast<std::size_t>((BasisLayout::taylor_terms(order) + vector_lanes - 1) / vector_lanes + 1) *
         vector_lanes;
}

/// Fills the design. The order of the rows matters: the zeros that end a row extend into the next one, which is written
/// after it.
POLYRECON_SIMD void gather_design(const VaryingFeatures& features, int center_x, int center_y, Window& window) {
  const int side = 2 * window.taylor_radius + 1, middle = window.taylor_radius * (side + 1);
  const std::size_t width = taylor_width(window.taylor_order);
  const auto varying = static_cast<std::size_t>(features.count);
  double* row = window.design.data();
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.padded); ++j, row += window.pitch) {
    row[0] = 1;
    for (std::size_t f = 0; f < varying; ++f) row[1 + f] = features.plane[f][window.offset[j]] - features.center[f];
    const auto at = static_cast<std::size_t>((window.y[j] - center_y) * side + window.x[j] - center_x + middle);
    const Real* const terms = window.taylor.data() + at * width;
    for (std::size_t k = 0; k < width; k += vector_lanes)
      *reinterpret_cast<StoredDoubles*>(row + 1 + varying + k) =
          __builtin_convertvector(*reinterpret_cast<const StoredReals*>(terms + k), StoredDoubles);
  }
}

}  // namespace

void Window::reserve(int radius, int columns, int channels) {
  const int side = 2 * radius + 1;
  stride = (side * side + lanes - 1) / lanes * lanes;  // side is odd, so this is at least one more than side^2
  const auto rows = static_cast<std::size_t>(stride);
  x.resize(rows);
  y.resize(rows);
  offset.resize(rows);
  distance.resize(rows);
  pitch = (columns + 2 * vector_lanes - 1) / (2 * vector_lanes) * (2 * vector_lanes);
  design.resize(rows * static_cast<std::size_t>(pitch) + std::size_t{2} * vector_lanes);  // + zeros after the last row
  response.resize(rows * static_cast<std::size_t>(channels));
  origin.resize(static_cast<std::size_t>(channels));
  noise_variance.resize(rows * 3);
  guess.resize(rows * 3);
}

void Window::expand(int radius, int order) {
  if (radius == taylor_radius && order == taylor_order) return;
  taylor_radius = radius;
  taylor_order = order;
  const auto side = static_cast<std::size_t>(2 * radius + 1);
  const std::size_t width = taylor_width(order);
  const Real scale = Real(1) / static_cast<Real>(std::max(radius, 1));
  taylor.assign(side * side * width, Real(0));
  Real* row = taylor.data();
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx, row += width)
      if (order > 0) taylor_terms(order, static_cast<Real>(dx) * scale, static_cast<Real>(dy) * scale, row);
}

void Window::take(int pixels) {
  assert(pixels <= stride);
  count = pixels;
  padded = (count + lanes - 1) / lanes * lanes;
}

void gather(const WindowSource& source, const BasisLayout& layout, int center_x, int center_y, int radius,
            Window& window) {
  window.take(window.count);
  for (auto j = static_cast<std::size_t>(window.count); j < static_cast<std::size_t>(window.padded); ++j) {
    window.x[j] = center_x;
    window.y[j] = center_y;
    window.distance[j] = 0;
  }
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.padded); ++j)
    window.offset[j] = static_cast<int>(source.response->index(window.x[j], window.y[j]));
  const auto stride = static_cast<std::size_t>(window.stride);
  const VaryingFeatures features = varying_features(*source.features, layout.features(), center_x, center_y, window);
  window.layout = BasisLayout(features.count, layout.order());
  window.expand(radius, layout.order());
  gather_design(features, center_x, center_y, window);
  for (int c = 0; c < source.response->channels(); ++c) {
    const Real origin = source.response->at(center_x, center_y, c);
    window.origin[static_cast<std::size_t>(c)] = origin;
    gather_channel(*source.response, c, window, origin, window.response.data() + static_cast<std::size_t>(c) * stride);
  }
  for (int c = 0; c < source.noise_variance->channels(); ++c) {
    const std::size_t offset = static_cast<std::size_t>(c) * stride;
    gather_channel(*source.noise_variance, c, window, 0, window.noise_variance.data() + offset);
    if (source.guess)
      gather_channel(*source.guess, c, window, source.guess->at(center_x, center_y, c), window.guess.data() + offset);
  }
}

}  // namespace polyrecon
