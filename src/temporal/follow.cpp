#include "temporal/follow.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "temporal/neighbour.h"

namespace polyrecon {
namespace {

constexpr double max_miss = 1;  // pixels between a point and where the vectors lead back to

int nearest(double position, int size) { return std::clamp(static_cast<int>(std::lround(position)), 0, size - 1); }

bool inside(double x, double y, const Image& image) {
  return x > -0.5 && y > -0.5 && x < image.width() - 0.5 && y < image.height() - 0.5;
}

/// Advances the places from one frame to the next one in the same direction, whose image is `image`. channel: first of
/// the two motion channels, 0 for the frame before and 2 for the one after.
void step(const Geometry& here, const Geometry& there, const Image& image, int channel, Places& places) {
  const Image &from = here.motion, &to = there.motion;
  // Offset from an image's coordinates to those of the other one.
  const double shift_x = here.window.x0 - there.window.x0, shift_y = here.window.y0 - there.window.y0;
  for_rows(places.position.height(), [&](int y) {
    for (int x = 0; x < places.position.width(); ++x) {
      unsigned char& seen = places.seen[places.position.index(x, y)];
      if (!seen) continue;
      Real &px = places.position.at(x, y, 0), &py = places.position.at(x, y, 1);
      const double x0 = px, y0 = py;
      double x1 = x0, y1 = y0;
      if (!from.empty()) {
        // The nearest vector: across an edge, a mean of several would be the motion of neither side.
        const int u = nearest(x0, from.width()), v = nearest(y0, from.height());
        x1 += static_cast<double>(from.at(u, v, channel));
        y1 += static_cast<double>(from.at(u, v, channel + 1));
      }
      x1 += shift_x;
      y1 += shift_y;
      seen = std::isfinite(x1) && std::isfinite(y1) && inside(x1, y1, image);
      if (!seen) continue;
      px = static_cast<Real>(x1);
      py = static_cast<Real>(y1);
      if (from.empty() || to.empty()) continue;
      const int u = nearest(x1, to.width()), v = nearest(y1, to.height());
      const double dx = x1 - shift_x + static_cast<double>(to.at(u, v, 2 - channel)) - x0;
      const double dy = y1 - shift_y + static_cast<double>(to.at(u, v, 3 - channel)) - y0;
      seen = dx * dx + dy * dy < max_miss * max_miss;
    }
  });
}

const Neighbour* find(const std::vector<TimedNeighbour>& neighbours, int offset, const HalfPair& pair) {
  for (const TimedNeighbour& n : neighbours)
    if (n.offset == offset && n.frame->pair.color[0].channels() == pair.color[0].channels()) return n.frame;
  return nullptr;
}

/// Weights of pixel floor(place) - 1 and the three pixels after it, along one axis. t: place - floor(place).
std::array<double, 4> cubic_weights(double t) {
  return {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1, ((-1.5 * t + 2) * t + 0.5) * t,
          (0.5 * t - 0.5) * t * t};
}

}  // namespace

std::vector<Places> follow(const Geometry& geometry, const HalfPair& pair,
                           const std::vector<TimedNeighbour>& neighbours) {
  const int width = pair.width(), height = pair.height();
  std::vector<Places> out;
  for (const int side : {-1, 1}) {
    Places places{0, nullptr, Image(width, height, 2), {}};
    places.seen.assign(places.position.pixels(), 1);
    for_rows(height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        places.position.at(x, y, 0) = static_cast<Real>(x);
        places.position.at(x, y, 1) = static_cast<Real>(y);
      }
    });
    const Geometry* from = &geometry;
    for (int offset = side;; offset += side) {
      places.offset = offset;
      places.frame = find(neighbours, offset, pair);
      if (!places.frame) break;
      step(*from, places.frame->geometry, places.frame->pair.variance, side < 0 ? 0 : 2, places);
      out.push_back(places);
      from = &places.frame->geometry;
    }
  }
  return out;
}

Image sample_at(const Image& image, const Places& places, const Rect& area, bool sharp) {
  const int width = image.width(), height = image.height();
  Image out(area.width(), area.height(), image.channels());
  for_rows(area.height(), [&](int row) {
    for (int column = 0; column < area.width(); ++column) {
      const int x = area.x0 + column, y = area.y0 + row;
      if (!places.seen[places.position.index(x, y)]) continue;
      const double px = places.position.at(x, y, 0), py = places.position.at(x, y, 1);
      const int u = static_cast<int>(std::floor(px)), v = static_cast<int>(std::floor(py));
      const auto weights = [&](double t) { return sharp ? cubic_weights(t) : std::array<double, 4>{0, 1 - t, t, 0}; };
      const std::array<double, 4> wx = weights(px - u), wy = weights(py - v);
      for (int c = 0; c < image.channels(); ++c) {
        double sum = 0;
        for (int j = 0; j < 4; ++j) {
          const Real* line = image.row(c, std::clamp(v + j - 1, 0, height - 1));
          double part = 0;
          for (int i = 0; i < 4; ++i)
            part += wx[static_cast<std::size_t>(i)] * static_cast<double>(line[std::clamp(u + i - 1, 0, width - 1)]);
          sum += wy[static_cast<std::size_t>(j)] * part;
        }
        out.at(column, row, c) = static_cast<Real>(sum);
      }
    }
  });
  return out;
}

}  // namespace polyrecon
