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

/// The features that vary over the window: where their planes begin, and their values at the centre.
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

/// Terms dx^(o-b) dy^b for b = 0..o, o = 1..order: each from those of one order below.
double* taylor_terms(int order, double dx, double dy, double* term) {
  if (order == 0) return term;
  double* below = term;
  *term++ = dx;
  *term++ = dy;
  for (int o = 2; o <= order; ++o) {
    double* const first = term;
    for (int b = 0; b < o; ++b) *term++ = static_cast<Real>(below[b] * dx);
    *term++ = static_cast<Real>(below[o - 1] * dy);
    below = first;
  }
  return term;
}

void gather_design(const VaryingFeatures& features, int center_x, int center_y, int radius, Window& window) {
  const Real scale = Real(1) / static_cast<Real>(std::max(radius, 1));
  for (std::size_t j = 0; j < static_cast<std::size_t>(window.padded); ++j) {
    double* const row = window.design.data() + j * static_cast<std::size_t>(window.pitch);
    row[0] = 1;
    for (std::size_t f = 0; f < static_cast<std::size_t>(features.count); ++f)
      row[1 + f] = features.plane[f][window.offset[j]] - features.center[f];
    double* const end = taylor_terms(window.layout.order(), static_cast<Real>(window.x[j] - center_x) * scale,
                                     static_cast<Real>(window.y[j] - center_y) * scale, row + 1 + features.count);
    std::fill(end, row + window.pitch, 0.0);
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
  pitch = (columns + vector_lanes - 1) / vector_lanes * vector_lanes;
  design.resize(rows * static_cast<std::size_t>(pitch));
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
  const VaryingFeatures features = varying_features(*source.features, layout.features(), center_x, center_y, window);
  window.layout = BasisLayout(features.count, layout.order());
  gather_design(features, center_x, center_y, radius, window);
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
