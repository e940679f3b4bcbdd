#include "features/prefilter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/images.h"
#include "support/random.h"

namespace polyrecon {
namespace {

constexpr int width = 48, height = 40;

std::array<Image, 2> filtered(const std::array<Image, 2>& halves, const Image& variance) {
  return prefilter(halves, variance, PrefilterParams{}, silent_progress());
}

TEST(Prefilter, AConstantStays) {
  const Image flat(width, height, 3, Real(0.7));
  for (const Image& out : filtered({flat, flat}, Image(width, height, 3, Real(0.01))))
    EXPECT_LT(test::max_difference(out, flat), 1e-6);
}

TEST(Prefilter, WithoutNoiseAnEdgeStaysToTheBit) {
  const Image edge = test::image_of(width, height, 1, [](int x, int, int) { return x < 20 ? 0.25 : 0.75; });
  for (const Image& out : filtered({edge, edge}, Image(width, height, 1)))
    EXPECT_LT(test::max_difference(out, edge), 1e-6);
}

/// An edge of height 1 in noise of standard deviation 0.1 in each half. Weights across the edge are 0 except within a
/// patch radius. The search window has 121 pixels, so the variance that remains must be well below a tenth of that of
/// the noise, and the contrast of the edge must stay.
TEST(Prefilter, TakesTheNoiseAndKeepsTheEdge) {
  test::Random random(3);
  const double sigma = 0.1;
  const auto truth = [](int x) { return x < 24 ? 0.0 : 1.0; };
  const auto half = [&](int x, int, int) { return truth(x) + sigma * random.normal(); };
  const std::array<Image, 2> halves{test::image_of(width, height, 1, half), test::image_of(width, height, 1, half)};
  const auto out = filtered(halves, Image(width, height, 1, Real(sigma * sigma)));
  for (std::size_t h = 0; h < 2; ++h) {
    double left = 0, edge = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double d = static_cast<double>(out[h].at(x, y, 0)) - truth(x);
        (std::abs(x - 23.5) > 4 ? left : edge) += d * d;
      }
    EXPECT_LT(left / (height * (width - 8)), 0.1 * sigma * sigma);
    EXPECT_LT(edge / (height * 8), 0.5 * sigma * sigma);
  }
}

TEST(Prefilter, TheHalvesErrorsStayIndependent) {
  // Half 0 is noisy and half 1 exact. Weights measured on half 1 average half 0 over a flat area evenly, so the
  // filtered half 0 has the noise of a plain mean of the 121 pixels in the search window: 1/121 of the variance. The
  // means overlap, so the image has 48 x 40 / 121 independent ones.
  test::Random random(4);
  const Image flat(width, height, 1, Real(1));
  const Image noisy = test::image_of(width, height, 1, [&](int, int, int) { return 1 + 0.1 * random.normal(); });
  const Image out = filtered({noisy, flat}, Image(width, height, 1, Real(0.01)))[0];
  double mean[2] = {0, 0};
  for (int y = 15; y <= 25; ++y)
    for (int x = 15; x <= 25; ++x) mean[0] += static_cast<double>(noisy.at(x, y, 0)) / 121;
  mean[1] = static_cast<double>(out.at(20, 20, 0));
  EXPECT_NEAR(mean[1], mean[0], 1e-6);
}

TEST(Prefilter, SmallerThanItsPatchIsFine) {
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 9}, std::pair{7, 1}, std::pair{2, 3}}) {
    const Image flat(w, h, 3, Real(2));
    for (const Image& out : filtered({flat, flat}, Image(w, h, 3, Real(1))))
      EXPECT_LT(test::max_difference(out, flat), 1e-6);
  }
}

}  // namespace
}  // namespace polyrecon
