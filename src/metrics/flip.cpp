#include "metrics/flip.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/pi.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

using Color = std::array<double, 3>;

constexpr double pixels_per_degree = 0.7 * 3840 / 0.7 * pi / 180;

// The constants below are those of the paper of 2020 (sections 4.1, 4.2).
constexpr double color_exponent = 0.7, feature_exponent = 0.5;  // q_c, q_f
constexpr double compressed_part = 0.4, compressed_to = 0.95;   // p_c, p_t
constexpr double feature_width = 0.082;                         // w, degrees

// ---- Colour spaces (section 4.1). White is linear RGB (1, 1, 1).

Eigen::Matrix3d rgb_to_xyz() {
  Eigen::Matrix3d m;
  m << 10135552, 8788810, 4435075, 2 * 2613072, 2 * 8788810, 2 * 887015, 1425312 / 3.0, 8788810 / 3.0, 70074185 / 3.0;
  return m / 24577794;
}

Color times(const Eigen::Matrix3d& m, const Color& c) {
  const Eigen::Vector3d v = m * Eigen::Vector3d(c[0], c[1], c[2]);
  return {v[0], v[1], v[2]};
}

Color xyz_of(const Color& rgb) {
  static const Eigen::Matrix3d m = rgb_to_xyz();
  return times(m, rgb);
}

Color rgb_of_xyz(const Color& xyz) {
  static const Eigen::Matrix3d m = rgb_to_xyz().inverse();
  return times(m, xyz);
}

const Color& white() {
  static const Color xyz = xyz_of({1, 1, 1});
  return xyz;
}

/// Linear RGB to Y Cx Cz, the linear opponent space in which contrast sensitivity is applied.
Color opponent_of(const Color& rgb) {
  const Color xyz = xyz_of(rgb);
  const double x = xyz[0] / white()[0], y = xyz[1] / white()[1], z = xyz[2] / white()[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Color rgb_of_opponent(const Color& ycc) {
  const double y = (ycc[0] + 16) / 116, x = y + ycc[1] / 500, z = y - ycc[2] / 200;
  return rgb_of_xyz({x * white()[0], y * white()[1], z * white()[2]});
}

/// Linear RGB to L*a*b* with the Hunt effect, by which dark colours look less colourful.
Color hunt_lab_of(const Color& rgb) {
  constexpr double delta = 6.0 / 29.0;
  const Color xyz = xyz_of(rgb);
  Color f{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = xyz[i] / white()[i];
    f[i] = t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
  }
  const double lightness = 116 * f[1] - 16;
  return {lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])};
}

/// Not std::hypot: a program that calls it needs glibc 2.35, and Red Hat Enterprise Linux 9 has 2.34.
double length(double x, double y) { return std::sqrt(x * x + y * y); }

/// HyAB distance: the difference in lightness plus the Euclidean distance in chroma.
double hyab(const Color& a, const Color& b) { return std::abs(a[0] - b[0]) + length(a[1] - b[1], a[2] - b[2]); }

/// Colour difference, 0 to 1, compressed so that small differences take most of the range.
double color_error(const Color& a, const Color& b) {
  static const double largest = std::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), color_exponent);
  const double error = std::pow(hyab(hunt_lab_of(a), hunt_lab_of(b)), color_exponent), knee = compressed_part * largest;
  return error < knee ? compressed_to * error / knee
                      : compressed_to + (error - knee) / (largest - knee) * (1 - compressed_to);
}

// ---- Filters. All are separable into lines of taps from -radius to radius.

using Taps = std::vector<double>;

Taps taps(int radius, const std::function<double(int)>& value) {
  Taps out;
  for (int x = -radius; x <= radius; ++x) out.push_back(value(x));
  return out;
}

Taps scaled(Taps line, double factor) {
  for (double& t : line) t *= factor;
  return line;
}

/// Sum of the positive taps, or of the magnitudes of the negative ones.
double sum_of(const Taps& line, bool positive) {
  double sum = 0;
  for (const double t : line)
    if ((t > 0) == positive) sum += std::abs(t);
  return sum;
}

/// Scales positive and negative taps so that the magnitudes of each sum to 1.
Taps balanced(Taps line) {
  const double positive = sum_of(line, true), negative = sum_of(line, false);
  for (double& t : line) t /= t > 0 ? positive : negative;
  return line;
}

/// The image convolved along x or y; border pixels are repeated.
Image convolve(const Image& image, const Taps& line, bool along_x) {
  const int radius = static_cast<int>(line.size() / 2), w = image.width(), h = image.height();
  Image out(w, h, 1);
  for_rows(h, [&](int y) {
    std::vector<double> sum(static_cast<std::size_t>(w), 0.0);
    for (int t = -radius; t <= radius; ++t) {
      const double factor = line[static_cast<std::size_t>(t + radius)];
      const Real* from = image.row(0, along_x ? y : std::clamp(y + t, 0, h - 1));
      for (int x = 0; x < w; ++x)
        sum[static_cast<std::size_t>(x)] += factor * from[along_x ? std::clamp(x + t, 0, w - 1) : x];
    }
    for (int x = 0; x < w; ++x) out.at(x, y, 0) = static_cast<Real>(sum[static_cast<std::size_t>(x)]);
  });
  return out;
}

Image convolve(const Image& image, const Taps& x, const Taps& y) {
  return convolve(convolve(image, x, true), y, false);
}

/// One Gaussian of a contrast sensitivity function, a sqrt(pi / b) exp(-pi^2 d^2 / b) with d in degrees (table 1).
struct Sensitivity {
  double a, b;
};

/// A channel filtered by its contrast sensitivity function, a normalised sum of Gaussians.
Image filter_channel(const Image& channel, const std::vector<Sensitivity>& gaussians) {
  constexpr double widest = 0.04;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * pixels_per_degree));
  std::vector<std::pair<double, Taps>> lines;
  double total = 0;
  for (const auto& [a, b] : gaussians) {
    const double scale = b;
    const Taps line = taps(
        radius, [&](int x) { return std::exp(-pi * pi * x * x / (scale * pixels_per_degree * pixels_per_degree)); });
    const double weight = a * std::sqrt(pi / b), sum = sum_of(line, true);
    lines.emplace_back(weight, line);
    total += weight * sum * sum;
  }
  Image out(channel.width(), channel.height(), 1);
  for (const auto& [weight, line] : lines) {
    const Image part = convolve(channel, scaled(line, weight / total), line);
    for (std::size_t i = 0; i < out.pixels(); ++i) out.plane(0)[i] += part.plane(0)[i];
  }
  return out;
}

/// Strength of edges and points in the achromatic channel (section 4.2).
struct Features {
  Image edges, points;
};

Image gradient_of(const Image& channel, const Taps& derivative, const Taps& gaussian) {
  Image out = convolve(channel, derivative, gaussian);
  const Image y = convolve(channel, gaussian, derivative);
  for (std::size_t i = 0; i < out.pixels(); ++i)
    out.plane(0)[i] = static_cast<Real>(length(out.plane(0)[i], y.plane(0)[i]));
  return out;
}

Features features_of(const Image& achromatic) {
  constexpr double sigma = 0.5 * feature_width * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const auto gauss = [](int x) { return std::exp(-x * x / (2 * sigma * sigma)); };
  Taps gaussian = taps(radius, gauss);
  gaussian = scaled(gaussian, 1 / sum_of(gaussian, true));
  const Taps edge = balanced(taps(radius, [&](int x) { return -x * gauss(x); }));
  const Taps point = balanced(taps(radius, [&](int x) { return (x * x / (sigma * sigma) - 1) * gauss(x); }));
  return {gradient_of(achromatic, edge, gaussian), gradient_of(achromatic, point, gaussian)};
}

// ---- One exposure: two pictures of linear RGB in 0..1.

/// A picture as a viewer perceives it: colours after contrast sensitivity filtering, and features.
struct Perceived {
  Image rgb;
  Features features;
};

Perceived perceive(const Image& rgb) {
  std::array<Image, 3> ycc{Image(rgb.width(), rgb.height(), 1), Image(rgb.width(), rgb.height(), 1),
                           Image(rgb.width(), rgb.height(), 1)};
  Image achromatic(rgb.width(), rgb.height(), 1);
  for (std::size_t i = 0; i < rgb.pixels(); ++i) {
    const Color c = opponent_of({rgb.plane(0)[i], rgb.plane(1)[i], rgb.plane(2)[i]});
    for (std::size_t k = 0; k < 3; ++k) ycc[k].plane(0)[i] = static_cast<Real>(c[k]);
    achromatic.plane(0)[i] = static_cast<Real>((c[0] + 16) / 116);
  }
  ycc[0] = filter_channel(ycc[0], {{1, 0.0047}});
  ycc[1] = filter_channel(ycc[1], {{1, 0.0053}});
  ycc[2] = filter_channel(ycc[2], {{34.1, 0.04}, {13.5, 0.025}});
  Perceived perceived{Image(rgb.width(), rgb.height(), 3), features_of(achromatic)};
  for (std::size_t i = 0; i < rgb.pixels(); ++i) {
    const Color c = rgb_of_opponent({ycc[0].plane(0)[i], ycc[1].plane(0)[i], ycc[2].plane(0)[i]});
    for (int k = 0; k < 3; ++k)
      perceived.rgb.plane(k)[i] = static_cast<Real>(std::clamp(c[static_cast<std::size_t>(k)], 0.0, 1.0));
  }
  return perceived;
}

/// Replaces each pixel of largest by the difference of a and b if that is larger.
void raise_to_difference(Image& largest, const Perceived& a, const Perceived& b) {
  for_rows(largest.height(), [&](int y) {
    for (int x = 0; x < largest.width(); ++x) {
      const std::size_t i = largest.index(x, y);
      const auto color = [&](const Image& rgb) { return Color{rgb.plane(0)[i], rgb.plane(1)[i], rgb.plane(2)[i]}; };
      const double edges = std::abs(a.features.edges.plane(0)[i] - b.features.edges.plane(0)[i]);
      const double points = std::abs(a.features.points.plane(0)[i] - b.features.points.plane(0)[i]);
      const double feature = std::pow(std::min(std::max(edges, points) / std::sqrt(2.0), 1.0), feature_exponent);
      const double error = std::pow(color_error(color(a.rgb), color(b.rgb)), 1 - feature);
      largest.plane(0)[i] = std::max(largest.plane(0)[i], static_cast<Real>(error));
    }
  });
}

// ---- Exposures (the paper of 2021, section 3).

// The tone curve is K. Narkowicz's fit to the ACES curve (2016), with the exposure bias 0.6 in its coefficients:
// (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5).
constexpr double k0 = 0.6 * 0.6 * 2.51, k1 = 0.6 * 0.03, k3 = 0.6 * 0.6 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;

double tone(double x) { return std::clamp((k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5), 0.0, 1.0); }

/// The radiance that the tone curve maps to `level`.
double radiance_at(double level) {
  const double a = k0 - k3 * level, b = k1 - k4 * level, c = -k5 * level;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

/// Exposures in stops, from the one that maps the brightest pixel of the reference to 85 % to the one that maps its
/// median luminance there.
std::vector<double> exposures_of(const Image& reference) {
  std::vector<double> luminance(reference.pixels());
  for (std::size_t i = 0; i < luminance.size(); ++i)
    luminance[i] = xyz_of({reference.plane(0)[i], reference.plane(1)[i], reference.plane(2)[i]})[1];
  constexpr double least = std::numeric_limits<float>::epsilon();
  const double brightest = std::max(*std::max_element(luminance.begin(), luminance.end()), least);
  std::sort(luminance.begin(), luminance.end());
  const std::size_t n = luminance.size();
  const double median = std::max((luminance[(n - 1) / 2] + luminance[n / 2]) / 2, least);
  const double first = std::log2(radiance_at(0.85) / brightest), last = std::log2(radiance_at(0.85) / median);
  const int count = std::max(2, static_cast<int>(std::ceil(last - first)));
  std::vector<double> stops;
  for (int i = 0; i < count; ++i) stops.push_back(first + (last - first) * i / (count - 1));
  return stops;
}

Image exposed(const Image& linear, double stops) {
  const double factor = std::exp2(stops);
  Image out(linear.width(), linear.height(), 3);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < linear.pixels(); ++i)
      out.plane(c)[i] = static_cast<Real>(tone(factor * linear.plane(c)[i]));
  return out;
}

Image without_bad_samples(Image image) {
  for (int c = 0; c < image.channels(); ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      if (Real& v = image.plane(c)[i]; !std::isfinite(v) || v < 0) v = 0;
  return image;
}

}  // namespace

Image flip(const Image& image, const Image& reference, Progress& progress) {
  if (!image.same_shape(reference) || image.channels() != 3 || image.empty())
    throw Error(ExitCode::BadInput, "an image and its reference must have the same size and three channels");
  const Image x = without_bad_samples(image), r = without_bad_samples(reference);
  Image largest(x.width(), x.height(), 1);
  for (const double stops : exposures_of(r)) {
    if (progress.cancelled()) throw Error(ExitCode::Interrupted, "interrupted");
    raise_to_difference(largest, perceive(exposed(r, stops)), perceive(exposed(x, stops)));
  }
  return largest;
}

}  // namespace polyrecon
