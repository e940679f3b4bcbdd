#include "blend/noise_bound.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/real.h"

namespace polyrecon {
namespace {

constexpr int bound_radius = 3;
constexpr double deviations = 5;

/// Applies reduce(first, end) to the values of a row within `bound_radius` of each pixel.
template <typename Reduce>
Image along_rows(const Image& in, const Reduce& reduce) {
  Image out(in.width(), in.height(), in.channels());
  for_rows(in.height(), [&](int y) {
    for (int c = 0; c < in.channels(); ++c) {
      const Real* row = in.row(c, y);
      for (int x = 0; x < in.width(); ++x)
        out.at(x, y, c) = reduce(row + std::max(x - bound_radius, 0), row + std::min(x + bound_radius + 1, in.width()));
    }
  });
  return out;
}

/// The same along columns. It works row by row: combine(result so far, next value), then finish(result, number of
/// values).
template <typename Combine, typename Finish>
Image along_columns(const Image& in, const Combine& combine, const Finish& finish) {
  Image out(in.width(), in.height(), in.channels());
  for_rows(in.height(), [&](int y) {
    const int first = std::max(y - bound_radius, 0), end = std::min(y + bound_radius + 1, in.height());
    for (int c = 0; c < in.channels(); ++c) {
      Real* row = out.row(c, y);
      std::copy_n(in.row(c, first), in.width(), row);
      for (int v = first + 1; v < end; ++v) std::transform(row, row + in.width(), in.row(c, v), row, combine);
      std::transform(row, row + in.width(), row, [&](Real value) { return finish(value, end - first); });
    }
  });
  return out;
}

Image standard_deviation(const Image& variance) {
  Image out = variance;
  for_rows(out.height(), [&](int y) {
    for (int c = 0; c < out.channels(); ++c)
      std::transform(out.row(c, y), out.row(c, y) + out.width(), out.row(c, y), [](Real v) { return std::sqrt(v); });
  });
  return out;
}

/// Means over 7 x 7 pixels, at the border over fewer.
Image mean_around(const Image& in) {
  const Image rows = along_rows(in, [](const Real* first, const Real* end) {
    Real sum = 0;
    for (const Real* p = first; p < end; ++p) sum += *p;
    return sum / static_cast<Real>(end - first);
  });
  return along_columns(
      rows, [](Real sum, Real v) { return sum + v; }, [](Real sum, int n) { return sum / static_cast<Real>(n); });
}

Image least_around(const Image& in) {
  const Image rows = along_rows(in, [](const Real* first, const Real* end) { return *std::min_element(first, end); });
  return along_columns(
      rows, [](Real least, Real v) { return std::min(least, v); }, [](Real least, int) { return least; });
}

}  // namespace

Image noise_bound(const Image& variance) {
  const Image sigma = standard_deviation(variance), around = least_around(mean_around(sigma));
  Image bound(variance.width(), variance.height(), 1);
  for_rows(bound.height(), [&](int y) {
    for (int x = 0; x < bound.width(); ++x) {
      double sum = 0;
      for (int c = 0; c < variance.channels(); ++c) {
        const double most = deviations * static_cast<double>(std::max(around.at(x, y, c), sigma.at(x, y, c)));
        sum += most * most;
      }
      bound.at(x, y, 0) = storable(sum);
    }
  });
  return bound;
}

}  // namespace polyrecon
