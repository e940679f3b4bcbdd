#include "regression/window.h"

#include <algorithm>
#include <cassert>

namespace polyrecon {
namespace {

void gather_plane(const Image& image, int channel, const Window& window, Real minus, Real* column) {
  const Real* plane = image.plane(channel);
  for (int j = 0; j < window.padded; ++j) {
    const auto k = static_cast<std::size_t>(j);
    column[k] = plane[image.index(window.x[k], window.y[k])] - minus;
  }
}

/// Columns (dx/r)^(o-b) (dy/r)^b for b = 0..o, o = 1..order: each from the column of one order below.
void taylor_columns(int order, int center_x, int center_y, int radius, const Window& window, Real* column) {
  const auto stride = static_cast<std::size_t>(window.stride);
  const Real scale = Real(1) / static_cast<Real>(std::max(radius, 1));
  const Real* below = nullptr;  // first column of the order below
  for (int o = 1; o <= order; ++o) {
    Real* const first = column;
    for (int b = 0; b <= o; ++b, column += stride)
      for (std::size_t j = 0; j < static_cast<std::size_t>(window.padded); ++j) {
        const Real dx = static_cast<Real>(window.x[j] - center_x) * scale;
        const Real dy = static_cast<Real>(window.y[j] - center_y) * scale;
        if (o == 1)
          column[j] = b == 0 ? dx : dy;
        else
          column[j] = b < o ? below[static_cast<std::size_t>(b) * stride + j] * dx
                            : below[static_cast<std::size_t>(b - 1) * stride + j] * dy;
      }
    below = first;
  }
}

}  // namespace

void Window::reserve(int radius, int columns, int channels) {
  const int side = 2 * radius + 1;
  stride = (side * side + lanes - 1) / lanes * lanes;
  const auto rows = static_cast<std::size_t>(stride);
  x.resize(rows);
  y.resize(rows);
  distance.resize(rows);
  design.resize(rows * static_cast<std::size_t>(columns));
  response.resize(rows * static_cast<std::size_t>(channels));
  noise_variance.resize(rows * 3);
  guess.resize(rows * 3);
}

void gather(const WindowSource& source, const BasisLayout& layout, int center_x, int center_y, int radius,
            Window& window) {
  assert(window.count <= window.stride);
  window.padded = (window.count + Window::lanes - 1) / Window::lanes * Window::lanes;
  for (auto j = static_cast<std::size_t>(window.count); j < static_cast<std::size_t>(window.padded); ++j) {
    window.x[j] = center_x;
    window.y[j] = center_y;
    window.distance[j] = 0;
  }
  const auto stride = static_cast<std::size_t>(window.stride);
  Real* column = window.design.data();
  std::fill(column, column + window.padded, Real(1));
  column += stride;
  for (int f = 0; f < layout.features(); ++f, column += stride)
    gather_plane(*source.features, f, window, source.features->at(center_x, center_y, f), column);
  taylor_columns(layout.order(), center_x, center_y, radius, window, column);
  for (int c = 0; c < source.response->channels(); ++c)
    gather_plane(*source.response, c, window, 0, window.response.data() + static_cast<std::size_t>(c) * stride);
  for (int c = 0; c < 3; ++c) {
    const std::size_t offset = static_cast<std::size_t>(c) * stride;
    gather_plane(*source.noise_variance, c, window, 0, window.noise_variance.data() + offset);
    if (source.guess) gather_plane(*source.guess, c, window, 0, window.guess.data() + offset);
  }
}

}  // namespace polyrecon
