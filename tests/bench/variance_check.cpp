// Compares the noise variance that is estimated from an image with the true one: variance_check RENDER REFERENCE ...
// The pixels of a render are sorted by the estimate and divided into ten equal parts. For each part the program prints
// the mean of the estimate, and the mean of the file's variance if it has one, over the mean of the true squared error
// (render - reference)^2 - variance of the reference. Means are taken because the true error of a pixel is known from
// only one squared sample.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <numeric>
#include <vector>

#include "noise/variance.h"
#include "polyrecon/read_frame.h"

using polyrecon::Frame;
using polyrecon::Image;
using polyrecon::Real;

namespace {

double mean_at(const Image& image, std::size_t i) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += static_cast<double>(image.plane(c)[i]);
  return sum / 3;
}

/// Mean over RGB of the squared error of each pixel.
std::vector<double> true_squares(const Frame& frame, const Frame& reference) {
  std::vector<double> out(frame.beauty.mean.pixels());
  for (std::size_t i = 0; i < out.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double d =
          static_cast<double>(frame.beauty.mean.plane(c)[i]) - static_cast<double>(reference.beauty.mean.plane(c)[i]);
      out[i] += (d * d - static_cast<double>(reference.beauty.variance.plane(c)[i])) / 3;
    }
  return out;
}

void check(const char* render, const char* reference_path) {
  Frame frame = polyrecon::read_frame(render).frame;
  const Frame reference = polyrecon::read_frame(reference_path).frame;
  const Image known = frame.beauty.variance;
  frame.beauty.variance = frame.beauty.half_a = frame.beauty.half_b = Image();
  const Image estimate = polyrecon::noise_variance(frame, polyrecon::silent_progress()).variance;
  const std::vector<double> truth = true_squares(frame, reference);
  std::vector<std::size_t> order(truth.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return mean_at(estimate, a) < mean_at(estimate, b); });
  std::printf("%s\n  decile   true variance   estimated/true   file's/true\n", render);
  for (std::size_t part = 0; part < 10; ++part) {
    const std::size_t begin = part * order.size() / 10, end = (part + 1) * order.size() / 10;
    double t = 0, e = 0, k = 0;
    for (std::size_t n = begin; n < end; ++n) {
      t += truth[order[n]];
      e += mean_at(estimate, order[n]);
      if (!known.empty()) k += mean_at(known, order[n]);
    }
    std::printf("  %6zu %15.4g %16.2f", part + 1, t / static_cast<double>(end - begin), e / t);
    known.empty() ? std::printf("             -\n") : std::printf(" %13.2f\n", k / t);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3 || argc % 2 == 0) {
    std::fputs("usage: variance_check RENDER REFERENCE ...\n", stderr);
    return 2;
  }
  for (int k = 1; k + 1 < argc; k += 2) check(argv[k], argv[k + 1]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "variance_check: %s\n", error.what());
  return 1;
}
