#include "regression/window.h"

#include <algorithm>
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

bool is_flat(const Real* column, int n) {
  return std::all_of(column, column + n, [](Real x) { return std::abs(x) < Real(least_variation); });
}

POLYRECON_SIMD void first_order_columns(const int* x, const int* y, int center_x, int center_y, Real scale, Real* dx,
                                        Real* dy, int n) {
  for (int j = 0; j < n; ++j) {
    dx[j] = static_cast<Real>(x[j] - center_x) * scale;
    dy[j] = static_cast<Real>(y[j] - center_y) * scale;
  }
}

POLYRECON_SIMD void multiply(const Real* a, const Real* b, Real* product, int n) {
  for (int j = 0; j < n; ++j) product[j] = a[j] * b[j];
}

/// Columns (dx/r)^(o-b) (dy/r)^b for b = 0..o, o = 1..order: each from the columns of one order below.
void taylor_columns(int order, int center_x, int center_y, int radius, const Window& window, Real* column) {
  if (order == 0) return;
  const auto stride = static_cast<std::size_t>(window.stride);
  const int n = window.padded;
  Real *const dx = column, *const dy = column + stride;
  first_order_columns(window.x.data(), window.y.data(), center_x, center_y,
                      Real(1) / static_cast<Real>(std::max(radius, 1)), dx, dy, n);
  const Real* below = column;
  column += 2 * stride;
  for (int o = 2; o <= order; ++o) {
    Real* const first = column;
    for (int b = 0; b < o; ++b, column += stride) multiply(below + static_cast<std::size_t>(b) * stride, dx, column, n);
    multiply(below + static_cast<std::size_t>(o - 1) * stride, dy, column, n);
    column += stride;
    below = first;
  }
}

}  // namespace

void Window::reserve(int radius, int columns, int channels) {
  const int side = 2 * radius + 1;
  stride = (side * side + lanes - 1) / lanes * lanes;  // side is odd: there is one row more, at least
  const auto rows = static_cast<std::size_t>(stride);
  x.resize(rows);
  y.resize(rows);
  offset.resize(rows);
  distance.resize(rows);
  design.resize(rows * static_cast<std::size_t>(columns));
  response.resize(rows * static_cast<std::size_t>(channels));
  origin.resize(static_cast<std::size_t>(channels));
  noise_variance.resize(rows * 3);
  guess.resize(rows * 3);
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
  Real* column = window.design.data();
  std::fill(column, column + window.padded, Real(1));
  column += stride;
  int varying = 0;
  for (int f = 0; f < layout.features(); ++f) {
    gather_channel(*source.features, f, window, source.features->at(center_x, center_y, f), column);
    if (is_flat(column, window.count)) continue;
    column += stride;
    ++varying;
  }
  window.layout = BasisLayout(varying, layout.order());
  taylor_columns(layout.order(), center_x, center_y, radius, window, column);
  for (int c = 0; c < source.response->channels(); ++c) {
    const Real origin = source.response->at(center_x, center_y, c);
    window.origin[static_cast<std::size_t>(c)] = origin;
    gather_channel(*source.response, c, window, origin, window.response.data() + static_cast<std::size_t>(c) * stride);
  }
  for (int c = 0; c < 3; ++c) {
    const std::size_t offset = static_cast<std::size_t>(c) * stride;
    gather_channel(*source.noise_variance, c, window, 0, window.noise_variance.data() + offset);
    if (source.guess)
      gather_channel(*source.guess, c, window, source.guess->at(center_x, center_y, c), window.guess.data() + offset);
  }
}

}  // namespace polyrecon
