#include "prior/prior_candidate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "blend/select.h"
#include "core/gaussian.h"
#include "core/halves.h"
#include "support/images.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

constexpr std::size_t plenty = std::size_t{1} << 30;

using test::image_of;

constexpr int size = 64;
constexpr double noise = 0.4;       // standard deviation of a half
constexpr double our_error = 0.06;  // amplitude of the error of the reconstruction

double detail(int x, int y) { return 1 + 0.3 * std::sin(0.7 * x) * std::cos(0.5 * y); }
Image truth() {
  return image_of(size, size, 3, [](int x, int y, int) { return detail(x, y); });
}

/// A noisy pair, a reconstruction with an error whose size is known but not its place, and the estimated error.
struct Case {
  HalfPair pair = test::pair_of(truth(), noise, 7);
  Image ours = image_of(size, size, 3,
                        [](int x, int y, int) { return detail(x, y) + our_error * ((x / 4 + y / 4) % 2 ? 1 : -1); });
  Image mse{size, size, 3, Real(1.5 * our_error * our_error)};

  Candidate result() const { return {{ours, ours}, mse, mse, Image(size, size, 1)}; }
  double error_with(const Pass& prior) const {
    const Candidate out = add_prior(pair, correct_prior(prior, pair, ours), mse, result(), SelectParams{}, plenty);
    double sum = 0;
    const Image wanted = truth();
    for (std::size_t i = 0; i < wanted.pixels(); ++i) {
      const double d = static_cast<double>(out.half[0].plane(1)[i]) - static_cast<double>(wanted.plane(1)[i]);
      sum += d * d;
    }
    return sum / static_cast<double>(wanted.pixels());
  }
};

Pass pass_of(Image mean) { return {"prior", std::move(mean), {}, {}, {}}; }

constexpr double own_mse = our_error * our_error;

TEST(AddPrior, TakesAnImageThatIsBetter) { EXPECT_LT(Case().error_with(pass_of(truth())), 0.3 * own_mse); }

TEST(AddPrior, CorrectsTheExposure) {
  EXPECT_LT(Case().error_with(pass_of(image_of(size, size, 3, [](int x, int y, int) { return 1.3 * detail(x, y); }))),
            0.3 * own_mse);
}

TEST(AddPrior, AWrongImageCostsNothing) {
  const Case c;
  const auto other = [](int x, int y, int) { return 1 + 0.9 * std::sin(0.2 * x + 0.3 * y); };
  EXPECT_LE(c.error_with(pass_of(image_of(size, size, 3, other))), 1.02 * own_mse);
  const auto shifted = [](int x, int y, int) { return detail(x + 2, y); };
  EXPECT_LE(c.error_with(pass_of(image_of(size, size, 3, shifted))), 1.02 * own_mse);
  EXPECT_LE(c.error_with(pass_of(Image(size, size, 3))), 1.02 * own_mse);
}

TEST(AddPrior, ABlurredImageIsSharpenedOrCostsNothing) {
  for (const double sigma : {0.6, 1.0, 2.0, 4.0}) {
    SCOPED_TRACE(sigma);
    EXPECT_LE(Case().error_with(pass_of(gaussian_blur(truth(), sigma))), (sigma < 2 ? 0.5 : 1.02) * own_mse);
  }
}

TEST(AddPrior, SharpenedPixelsAreTrustedLess) {
  const Case c;
  const auto distance = [&](double added) {  // of the result from the reconstruction
    const Candidate out =
        add_prior(c.pair, {truth(), Image(size, size, 3, Real(added))}, c.mse, c.result(), {}, plenty);
    double sum = 0;
    for (std::size_t i = 0; i < c.ours.pixels(); ++i) {
      const double d = static_cast<double>(out.half[0].plane(1)[i]) - static_cast<double>(c.ours.plane(1)[i]);
      sum += d * d;
    }
    return sum;
  };
  EXPECT_LT(distance(3 * our_error), 0.5 * distance(0));
}

TEST(AddPrior, PixelsThatAreNoNumberAreOurs) {
  const Case c;
  Image holes = truth();
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size / 2; ++x) holes.at(x, y, 1) = std::numeric_limits<Real>::quiet_NaN();
  const CorrectedPrior prior = correct_prior(pass_of(holes), c.pair, c.ours);
  EXPECT_NEAR(prior.value.at(3, 5, 1) - prior.sharpening.at(3, 5, 1), c.ours.at(3, 5, 1), 1e-6);
  EXPECT_LT(c.error_with(pass_of(holes)), own_mse);
  const Image nothing(size, size, 3, std::numeric_limits<Real>::infinity());
  EXPECT_TRUE(test::same_bits(correct_prior(pass_of(nothing), c.pair, c.ours).value, c.ours));
}

TEST(AddPrior, HalvesAreAveraged) {
  const Case c;
  Pass halves = pass_of(Image(size, size, 3));
  halves.half_a = image_of(size, size, 3, [](int x, int y, int) { return detail(x, y) + 0.2; });
  halves.half_b = image_of(size, size, 3, [](int x, int y, int) { return detail(x, y) - 0.2; });
  EXPECT_LT(c.error_with(halves), 0.3 * own_mse);
}

TEST(AddPrior, OtherLayersStayAsTheyAre) {
  Case c;
  const auto with_layer = [](const Image& beauty) {
    return image_of(size, size, 6, [&](int x, int y, int k) { return static_cast<double>(beauty.at(x, y, k % 3)); });
  };
  Candidate ours = c.result();
  for (std::size_t h = 0; h < 2; ++h) {
    ours.half[h] = with_layer(ours.half[h]);
    c.pair.color[h] = with_layer(c.pair.color[h]);
  }
  const Candidate out = add_prior(c.pair, {truth(), Image(size, size, 3)}, c.mse, ours, SelectParams{}, plenty);
  for (const int first : {0, 3}) {
    const auto part = [&](const Image& image) { return crop(image, image.bounds(), first, 3); };
    EXPECT_EQ(test::same_bits(part(out.half[0]), part(ours.half[0])), first == 3);
  }
}

TEST(AddPrior, TheErrorStaysThatOfTheReconstruction) {
  const Case c;
  const Candidate out = add_prior(c.pair, {truth(), Image(size, size, 3)}, c.mse, c.result(), SelectParams{}, plenty);
  EXPECT_TRUE(test::same_bits(out.squared_bias, c.mse));
  EXPECT_TRUE(test::same_bits(out.variance, c.mse));
}

TEST(NoiseInPrior, IsOneForTheInputAndNothingForTheTruth) {
  const Case c;
  const Image noisy = image_of(size, size, 3, [&](int x, int y, int k) {
    return 0.5 * (static_cast<double>(c.pair.color[0].at(x, y, k)) + static_cast<double>(c.pair.color[1].at(x, y, k)));
  });
  EXPECT_NEAR(noise_in_prior(noisy, c.pair, c.ours), 1, 1e-4);
  EXPECT_LT(noise_in_prior(truth(), c.pair, c.ours), 0.1);
}

/// The pair has no outliers any more, but a prior that is the input still has them.
TEST(NoiseInPrior, IsNotMovedByAnOutlier) {
  const Case c;
  Image noisy = mean_of_halves(c.pair.color, 3);
  noisy.at(20, 30, 1) = 1e4;
  EXPECT_NEAR(noise_in_prior(noisy, c.pair, c.ours), 1, 0.02);
}

}  // namespace
}  // namespace polyrecon
