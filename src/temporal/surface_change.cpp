#include "temporal/surface_change.h"

#include <algorithm>
#include <cmath>

#include "core/gaussian.h"
#include "core/parallel.h"
#include "core/pi.h"

namespace polyrecon {
namespace {

constexpr double around = 1;  // pixels; contrast and squares are averaged with a Gaussian of this standard deviation
// Gaussians under which surfaces are compared: wider ones find less, as noise and sampling errors average out.
constexpr std::array<double, 2> scales{1, 2};
// Largest squared difference of a pixel that is no change, in units of the variance of the surface around it. An edge
// that is sampled by some ten samples differs by this much, and so does a place that is wrong by a third of a pixel.
constexpr double sampled_edge = 0.15;
constexpr double same_depth = 0.1;  // of the logarithm; a camera that moves changes depths by less from frame to frame
constexpr double dark_albedo = 0.01, short_normal = 0.5;  // added to the squares that differences are relative to

/// Sum over the channels of the squares.
Image squares(const Image& image) {
  Image out(image.width(), image.height(), 1);
  for_rows(image.height(), [&](int y) {
    for (int x = 0; x < image.width(); ++x) {
      double sum = 0;
      for (int c = 0; c < image.channels(); ++c)
        sum += static_cast<double>(image.at(x, y, c)) * static_cast<double>(image.at(x, y, c));
      out.at(x, y, 0) = static_cast<Real>(sum);
    }
  });
  return out;
}

Image difference_of(const Image& a, const Image& b) {
  Image out = a;
  for (int c = 0; c < a.channels(); ++c)
    for (std::size_t i = 0; i < a.pixels(); ++i) out.plane(c)[i] -= b.plane(c)[i];
  return out;
}

/// Raises `most` to at least image - share x allowed.
void raise_to(const Image& image, const Image& allowed, double share, Image& most) {
  for (std::size_t i = 0; i < most.pixels(); ++i)
    most.plane(0)[i] = std::max(most.plane(0)[i], image.plane(0)[i] - static_cast<Real>(share) * allowed.plane(0)[i]);
}

/// Adds the squared difference of two surfaces beyond what noise and sampling make, relative to the mean of a's
/// squares.
void add_change(const Image& a, const Image& b, const Image& noise, double least_square, Image& change) {
  const Image square = gaussian_blur(squares(a), around), square_of_mean = squares(gaussian_blur(a, around));
  Image allowed = noise.empty() ? Image(a.width(), a.height(), 1) : gaussian_blur(noise, around);
  for (std::size_t i = 0; i < allowed.pixels(); ++i) {
    const Real contrast = std::max(square.plane(0)[i] - square_of_mean.plane(0)[i], Real(0));
    // Several frames have between half and all of the noise of one.
    allowed.plane(0)[i] = Real(1.5) * allowed.plane(0)[i] + static_cast<Real>(sampled_edge) * contrast;
  }
  const Image difference = difference_of(a, b);
  Image most(a.width(), a.height(), 1);
  raise_to(gaussian_blur(squares(difference), around), allowed, 1, most);
  for (const double sigma : scales)
    raise_to(squares(gaussian_blur(difference, sigma)), allowed, 1 / (4 * pi * sigma * sigma), most);
  for (std::size_t i = 0; i < change.pixels(); ++i)
    change.plane(0)[i] += most.plane(0)[i] / (square.plane(0)[i] + static_cast<Real>(least_square));
}

/// Adds how far the logarithms of two depths differ beyond what a moving camera makes.
void add_depth_change(const Image& a, const Image& b, Image& change) {
  for (std::size_t i = 0; i < change.pixels(); ++i) {
    const double difference = std::abs(static_cast<double>(a.plane(0)[i]) - static_cast<double>(b.plane(0)[i]));
    const double excess = std::max(difference / same_depth - 1, 0.0);
    change.plane(0)[i] += static_cast<Real>(excess * excess);
  }
}

}  // namespace

Image surface_change(int width, int height, const std::array<Image, surfaces>& a,
                     const std::array<Image, surfaces>& noise, const std::array<Image, surfaces>& b) {
  Image change(width, height, 1);
  for (const Surface surface : {Surface::Color, Surface::Direction, Surface::Distance}) {
    const std::size_t s = index_of(surface);
    if (a[s].empty() || b[s].empty()) continue;
    if (surface == Surface::Distance)
      add_depth_change(a[s], b[s], change);
    else
      add_change(a[s], b[s], noise[s], surface == Surface::Color ? dark_albedo : short_normal, change);
  }
  return change;
}

}  // namespace polyrecon
