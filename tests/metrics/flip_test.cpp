#include "metrics/flip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "polyrecon/error.h"

namespace polyrecon {
namespace {

double mean(const Image& map) {
  double sum = 0;
  for (std::size_t i = 0; i < map.pixels(); ++i) sum += map.plane(0)[i];
  return sum / static_cast<double>(map.pixels());
}

/// Dark and bright halves with waves and one very bright pixel: nine exposures.
Image reference() {
  Image r(48, 32, 3);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x)
        r.at(x, y, c) =
            static_cast<Real>((x < 24 ? 0.2 : 2.0) * (1 + 0.5 * std::sin(0.3 * x + c)) * std::exp(y / 16.0) +
                              (x == 30 && y == 10 ? 500.0 : 0.0));
  return r;
}

/// The reference times a wave that differs in each channel, and one red pixel.
Image image() {
  Image t = reference();
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x)
        t.at(x, y, c) = t.at(x, y, c) * static_cast<float>(1 + 0.2 * std::cos(0.7 * y + 1.3 * x + 2 * c));
  for (int c = 0; c < 3; ++c) t.at(10, 20, c) = c == 0 ? Real{50} : Real{0};
  return t;
}

/// The numbers are those of the authors' own program: flip_evaluator 1.7 (Python),
/// evaluate(reference, image, "HDR", applyMagma=False). It works in float.
TEST(Flip, AgreesWithTheAuthorsProgram) {
  const Image map = flip(image(), reference(), silent_progress());
  ASSERT_EQ(map.channels(), 1);
  EXPECT_NEAR(mean(map), 0.106380, 1e-5);
  EXPECT_NEAR(map.at(0, 0, 0), 0.245276, 1e-4);
  EXPECT_NEAR(map.at(30, 10, 0), 0.063252, 1e-4);
  EXPECT_NEAR(map.at(10, 20, 0), 0.532293, 1e-4);
  EXPECT_NEAR(map.at(47, 31, 0), 0.232299, 1e-4);
  EXPECT_NEAR(map.at(24, 16, 0), 0.094653, 1e-4);
}

TEST(Flip, IsZeroForEqualImagesAndOneAtMost) {
  EXPECT_EQ(mean(flip(reference(), reference(), silent_progress())), 0);
  const Image black(16, 16, 3);
  Image green(16, 16, 3), blue(16, 16, 3);
  for (std::size_t i = 0; i < green.pixels(); ++i) green.plane(1)[i] = blue.plane(2)[i] = 1e6f;
  const double most = mean(flip(green, blue, silent_progress()));  // the two colours farthest apart on a display
  EXPECT_GT(most, 0.9);
  EXPECT_LE(most, 1);
  EXPECT_EQ(mean(flip(black, black, silent_progress())), 0);
}

TEST(Flip, BadSamplesCountAsBlack) {
  Image bad = image(), black = bad;
  constexpr Real nan = std::numeric_limits<Real>::quiet_NaN(), infinite = std::numeric_limits<Real>::infinity();
  for (int c = 0; c < 3; ++c) {
    bad.at(3, 4, c) = c == 0 ? nan : c == 1 ? infinite : Real{-1};
    black.at(3, 4, c) = 0;
  }
  const Image a = flip(bad, reference(), silent_progress()), b = flip(black, reference(), silent_progress());
  for (std::size_t i = 0; i < a.pixels(); ++i) ASSERT_EQ(a.plane(0)[i], b.plane(0)[i]);
}

TEST(Flip, RefusesOtherShapes) {
  EXPECT_THROW(flip(Image(4, 4, 3), Image(5, 4, 3), silent_progress()), Error);
  EXPECT_THROW(flip(Image(4, 4, 1), Image(4, 4, 1), silent_progress()), Error);
}

}  // namespace
}  // namespace polyrecon
