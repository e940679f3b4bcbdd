#include "noise/variance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "support/images.h"
#include "support/random.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

constexpr int width = 96, height = 80;

/// Mean over the image of estimate / truth.
double mean_ratio(const Image& estimate, const Image& truth) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < truth.pixels(); ++i)
      sum += static_cast<double>(estimate.plane(c)[i]) / static_cast<double>(truth.plane(c)[i]);
  return sum / (3.0 * static_cast<double>(truth.pixels()));
}

NoiseVariance variance_of(const Frame& frame) { return noise_variance(frame, silent_progress()); }

TEST(NoiseVariance, TakesWhatTheFileSays) {
  const Frame frame = test::make_scene(20, 20, 0.2, 1).frame;
  const NoiseVariance out = variance_of(frame);
  EXPECT_EQ(out.source, "from the file");
  EXPECT_TRUE(test::same_bits(out.variance, frame.beauty.variance));
}

/// (A - B)^2 / 4 has the variance of the mean as its expectation and one degree of freedom: standard deviation sqrt(2)
/// of it. The noise of make_scene is smooth but for the steps of texture and disk, over which the blur averages: mean
/// of the ratio within 4 standard errors sqrt(2 / 23040) = 0.009 and the bias of blurring v next to v' (v'/v up to 4 at
/// the disk's rim): bounded by 10 %.
TEST(NoiseVariance, FromTheHalvesIsThatOfTheMean) {
  Frame frame = test::make_scene(width, height, 0.2, 2).frame;
  const Image truth = frame.beauty.variance;
  frame.beauty.variance = Image();
  const NoiseVariance out = variance_of(frame);
  EXPECT_EQ(out.source, "from the half buffers");
  EXPECT_NEAR(mean_ratio(out.variance, truth), 1, 0.1);
}

TEST(NoiseVariance, FromTheHalvesOfUniformNoiseIsUnbiased) {
  Frame frame = test::make_scene(width, height, 0.2, 3).frame;
  const double sigma = 0.3;
  test::Random random(30);
  const auto half = [&](int, int, int) { return 1 + std::sqrt(2.0) * sigma * random.normal(); };
  frame.beauty.half_a = test::image_of(width, height, 3, half);
  frame.beauty.half_b = test::image_of(width, height, 3, half);
  frame.beauty.variance = Image();
  EXPECT_NEAR(mean_ratio(variance_of(frame).variance, Image(width, height, 3, Real(sigma * sigma))), 1,
              4 * std::sqrt(2.0 / (3 * width * height)) + 0.01);
}

/// Uniform noise on a plane: the residual variance of each fit is chi^2 of 46 degrees of freedom over 46 (49 pixels,
/// constant and plane; a median of those lies 1 - 2/(9 x 46), cubed, = 1.4 % below 1), and neighbouring fits share
/// pixels: within 5 %.
TEST(NoiseVariance, FromTheImageOnAPlaneIsThatOfTheNoise) {
  const double sigma = 0.1;
  test::Random random(4);
  Frame frame;
  frame.beauty.mean = test::image_of(
      width, height, 3, [&](int x, int y, int c) { return 1 + 0.01 * x - 0.02 * y + c + sigma * random.normal(); });
  const NoiseVariance out = variance_of(frame);
  EXPECT_EQ(out.source, "estimated from the image");
  EXPECT_NEAR(mean_ratio(out.variance, Image(width, height, 3, Real(sigma * sigma))), 1, 0.05);
}

TEST(NoiseVariance, FromTheImageDoesNotTakeRoundingToHalfFloatsForNoise) {
  // A half float holds 11 binary digits.
  const auto to_half = [](double v) {
    int exponent;
    const double mantissa = std::frexp(v, &exponent);
    return std::ldexp(std::round(mantissa * 2048) / 2048, exponent);
  };
  test::Random random(12);
  const auto sky = [](int x, int y, int c) { return 0.3 + 0.003 * x - 0.001 * y + c; };
  Frame frame;
  frame.beauty.mean = test::image_of(width, height, 3, [&](int x, int y, int c) { return to_half(sky(x, y, c)); });
  EXPECT_TRUE(test::same_bits(variance_of(frame).variance, Image(width, height, 3)));
  // Noise of a thousandth of the radiance is estimated.
  frame.beauty.mean = test::image_of(
      width, height, 3, [&](int x, int y, int c) { return to_half(sky(x, y, c) * (1 + 0.001 * random.normal())); });
  const Image noisy = variance_of(frame).variance;
  for (int c = 0; c < 3; ++c) EXPECT_GT(noisy.at(width / 2, height / 2, c), 0);
}

TEST(NoiseVariance, FromTheImageDoesNotTakeAnEdgeForNoise) {
  const double sigma = 0.05;
  test::Random random(5);
  Frame frame;
  frame.beauty.mean =
      test::image_of(width, height, 3, [&](int x, int, int) { return (x < 48 ? 1 : 3) + sigma * random.normal(); });
  const Image out = variance_of(frame).variance;
  // The edge (a step of 2) would contribute 1, 400 times the noise. It has no effect outside of the windows that cover
  // it. Single pixels may be taken for spikes, so columns are averaged.
  for (const int x : {5, 20, 36, 60, 80}) {
    double sum = 0;
    for (int y = 0; y < height; ++y) sum += static_cast<double>(out.at(x, y, 1));
    EXPECT_LT(sum / height, 1.5 * sigma * sigma) << x;
  }
}

/// Texture with blades of two pixels that is in no feature: the residual of a fit is far above the noise.
TEST(NoiseVariance, FromTheImageDoesNotTakeTextureForNoise) {
  const double sigma = 0.05;
  const auto estimated = [&](double texture) {
    test::Random blades(7), random(8);
    const Image grass = test::image_of(width / 2, height / 2, 1, [&](int, int, int) { return blades.normal(); });
    Frame frame;
    frame.beauty.mean = test::image_of(width, height, 3, [&](int x, int y, int) {
      return 3 + texture * static_cast<double>(grass.at(x / 2, y / 2, 0)) + sigma * random.normal();
    });
    return mean_ratio(variance_of(frame).variance, Image(width, height, 3, Real(sigma * sigma)));
  };
  EXPECT_NEAR(estimated(0), 1, 0.05);
  EXPECT_LT(estimated(0.1), 2);  // the residuals hold 4 times the noise's variance in texture
}

TEST(NoiseVariance, FromTheImageOfBlackIsZero) {
  test::Random random(10);
  Frame frame;
  frame.beauty.mean = test::image_of(
      width, height, 3, [&](int x, int, int c) { return x < 48 || c == 2 ? 0 : 1 + 0.3 * random.normal(); });
  const Image out = variance_of(frame).variance;
  for (int y = 0; y < height; ++y)
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(out.at(47, y, c), 0);
      EXPECT_EQ(out.at(60, y, c) > 0, c < 2);
    }
}

TEST(NoiseVariance, FromTheImageOfASceneWithFeaturesIsOfTheRightSize) {
  // The texture is in the albedo and the disk in normal and depth, so the residuals hold the noise and the curvature of
  // their product.
  Frame frame = test::make_scene(width, height, 0.2, 6).frame;
  const Image truth = frame.beauty.variance;
  frame.beauty.variance = frame.beauty.half_a = frame.beauty.half_b = Image();
  const double ratio = mean_ratio(variance_of(frame).variance, truth);
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.5);
}

/// A beauty and a feature whose noise is of the same samples, with a texture in both: waves of the sea, or blades of
/// grass behind a wide-open lens.
Frame of_same_samples(double texture, double sigma) {
  test::Random random(12);
  const Image noise = test::image_of(width, height, 3, [&](int, int, int) { return random.normal(); });
  const auto pattern = [&](int x, int y) { return texture * std::sin(0.9 * x) * std::cos(0.7 * y); };
  const auto image = [&](double level, double own) {
    return test::image_of(width, height, 3, [&](int x, int y, int c) {
      return level + pattern(x, y) + own * static_cast<double>(noise.at(x, y, c));
    });
  };
  Frame frame;
  frame.beauty.mean = image(1, sigma);
  frame.features.push_back({Role::Normal, {"Normal", image(0.2, sigma), {}, {}, {}}});
  estimate_feature_variance(frame, silent_progress());
  return frame;
}

/// The fit to the noisy feature would leave nothing. The estimate is the median of about 1.0 (test of the plane), of
/// channels whose spikes count: within 15 %.
TEST(NoiseVariance, NoiseOfAFeatureDoesNotExplainThatOfTheBeauty) {
  const double sigma = 0.1;
  const Image truth(width, height, 3, Real(sigma * sigma));
  EXPECT_NEAR(mean_ratio(variance_of(of_same_samples(0, sigma)).variance, truth), 1, 0.15);
}

TEST(NoiseVariance, TextureOfANoisyFeatureStillExplains) {
  // The texture's variance is 0.3^2 / 4 = 22 times that of the noise, which is in both.
  const double sigma = 0.03;
  const Image texture(width, height, 3, Real(0.3 * 0.3 / 4));
  EXPECT_LT(mean_ratio(variance_of(of_same_samples(0.3, sigma)).variance, texture), 0.1);
}

/// White noise spread by a Gaussian of standard deviation `spread`, as splatting renderers spread samples. Walls with
/// one shadow, features without variation but depth.
Frame splatted(double sigma, double spread) {
  test::Random random(21);
  const Image white = test::image_of(width + 4, height + 4, 3, [&](int, int, int) { return random.normal(); });
  double energy = 0;
  for (int v = -2; v <= 2; ++v)
    for (int u = -2; u <= 2; ++u) energy += std::exp(-(u * u + v * v) / (spread * spread));
  Frame frame;
  frame.beauty.mean = test::image_of(width, height, 3, [&](int x, int y, int c) {
    double sum = 0;
    for (int v = 0; v <= 4; ++v)
      for (int u = 0; u <= 4; ++u)
        sum += static_cast<double>(white.at(x + u, y + v, c)) *
               std::exp(-((u - 2) * (u - 2) + (v - 2) * (v - 2)) / (2 * spread * spread));
    return (x < 40 ? 1 : 2) + 0.01 * y + sigma * sum / std::sqrt(energy);
  });
  frame.features.push_back({Role::Albedo, {"Albedo", Image(width, height, 3, Real(0.5)), {}, {}, {}}});
  frame.features.push_back({Role::Normal, {"Normal", Image(width, height, 3, Real(0.2)), {}, {}, {}}});
  const Image depth = test::image_of(width, height, 1, [](int x, int y, int) { return 3 + 0.01 * x + 0.002 * x * y; });
  frame.features.push_back({Role::Depth, {"Depth", depth, {}, {}, {}}});
  return frame;
}

TEST(NoiseCorrelation, IsThatOfASplattingFilter) {
  const auto kernel = [](double spread, int u) { return std::exp(-u * u / (2 * spread * spread)); };
  for (const double spread : {0.5, 0.56}) {
    double energy = 0, product = 0;
    for (int u = -3; u <= 3; ++u) {
      energy += kernel(spread, u) * kernel(spread, u);
      product += kernel(spread, u) * kernel(spread, u + 1);
    }
    EXPECT_NEAR(noise_correlation(splatted(0.1, spread), silent_progress()), product / energy, 0.05) << spread;
  }
}

TEST(NoiseCorrelation, IsNoneOfWhiteNoiseOrWithoutFlatPlaces) {
  EXPECT_EQ(noise_correlation(splatted(0.1, 0.01), silent_progress()), 0);
  Frame bare = splatted(0.1, 0.5);
  bare.features.clear();
  EXPECT_EQ(noise_correlation(bare, silent_progress()), 0);
  test::Random random(22);
  Frame grass = splatted(0.1, 0.5);
  grass.features[0].pass.mean = grass.features[1].pass.mean =
      test::image_of(width, height, 3, [&](int, int, int) { return random.uniform(); });
  EXPECT_EQ(noise_correlation(grass, silent_progress()), 0);
}

/// The fit to texture takes correlated noise for texture: without the correlation the estimate is a quarter.
TEST(NoiseVariance, OfSplattedNoiseIsOfTheRightSize) {
  const Frame frame = splatted(0.1, 0.5);
  const Image truth(width, height, 3, Real(0.01));
  const double correlation = noise_correlation(frame, silent_progress());
  EXPECT_NEAR(mean_ratio(noise_variance(frame, silent_progress(), {}, correlation).variance, truth), 1, 0.2);
}

TEST(NoiseVariance, FeaturesBeyondWhatTheModelHoldsAreLeftOut) {
  // The scene has 7 channels and each further pass 3, so the fourth of these does not fit into 16.
  Frame frame = test::make_scene(40, 36, 0.2, 8).frame;
  frame.beauty.variance = frame.beauty.half_a = frame.beauty.half_b = Image();
  test::Random random(9);
  Image full;
  for (int more = 1; more <= 5; ++more) {
    const Image noise = test::image_of(40, 36, 3, [&](int, int, int) { return random.normal(); });
    frame.features.push_back({Role::Albedo, {"More", noise, {}, {}, {}}});
    const Image out = variance_of(frame).variance;
    if (more == 3) full = out;
    if (more > 3) {
      EXPECT_TRUE(test::same_bits(out, full)) << more;
    }
  }
}

TEST(NoiseVariance, OfBadAndTinyImagesIsFiniteAndNotNegative) {
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 7}, std::pair{5, 1}, std::pair{3, 5}, std::pair{2, 2}}) {
    Frame frame;
    frame.beauty.mean = Image(w, h, 3, Real(1));
    frame.beauty.mean.at(w - 1, h - 1, 0) = std::numeric_limits<Real>::quiet_NaN();
    const Image out = variance_of(frame).variance;
    EXPECT_TRUE(test::all_finite(out));
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < out.pixels(); ++i) EXPECT_GE(out.plane(c)[i], Real(0));
  }
}

/// The estimated variance of each feature of a frame whose features have neither variance nor halves; empty if none is
/// estimated.
std::vector<Image> feature_variances(Frame frame) {
  estimate_feature_variance(frame, silent_progress());
  std::vector<Image> out;
  for (Feature& feature : frame.features) out.push_back(std::move(feature.pass.variance));
  return out;
}

TEST(FeatureVariance, IsEstimatedOfWhatComesWithoutButForDepth) {
  Frame frame;
  const double sigma = 0.05;
  test::Random random(31);
  const auto noisy = [&](int x, int, int) { return 0.2 + 0.002 * x + sigma * random.normal(); };
  for (const Role role : {Role::Albedo, Role::Normal, Role::Depth, Role::Visibility}) {
    const int channels = info_of(role).channels;
    frame.features.push_back({role, {"", test::image_of(width, height, channels, noisy), {}, {}, {}}});
  }
  const std::vector<Image> found = feature_variances(frame);
  const Image truth(width, height, 3, Real(sigma * sigma));
  // Ordinary noise has spikes too.
  for (const int k : {0, 1}) EXPECT_NEAR(mean_ratio(found[static_cast<std::size_t>(k)], truth), 1.1, 0.2);
  EXPECT_TRUE(found[2].empty());
  EXPECT_EQ(found[3].channels(), 1);
}

TEST(FeatureVariance, AVarianceInTheFileStays) {
  Frame frame;
  const Image mean(width, height, 3, Real(0.5)), variance(width, height, 3, Real(0.125));
  frame.features.push_back({Role::Albedo, {"", mean, variance, {}, {}}});
  frame.features.push_back({Role::Normal, {"", mean, {}, mean, mean}});
  const std::vector<Image> found = feature_variances(frame);
  EXPECT_TRUE(test::same_bits(found[0], variance));
  EXPECT_TRUE(found[1].empty());
}

/// Grass through an open lens: stripes of one pixel with the noise of samples that fall on either of two values. A fit
/// takes part of it for detail.
TEST(FeatureVariance, OfFineDetailIsOfTheRightSize) {
  Frame frame;
  const double sigma = 0.05;
  test::Random random(33), pattern(34);
  std::vector<double> tone(static_cast<std::size_t>(width) * height);
  for (double& t : tone) t = 0.5 + 0.12 * pattern.normal();
  const auto smooth = [&](int x, int y) {  // as a pixel filter leaves it
    double sum = 0, total = 0;
    for (int v = -3; v <= 3; ++v)
      for (int u = -3; u <= 3; ++u) {
        const int i = std::clamp(x + u, 0, width - 1), j = std::clamp(y + v, 0, height - 1);
        const double weight = std::exp(-0.5 * (u * u + v * v));
        sum += weight * tone[static_cast<std::size_t>(j * width + i)];
        total += weight;
      }
    return sum / total;
  };
  const auto value = [&](int x, int y, int) { return smooth(x, y) + sigma * random.normal(); };
  frame.features.push_back({Role::Albedo, {"", test::image_of(width, height, 3, value), {}, {}, {}}});
  const Image truth(width, height, 3, Real(sigma * sigma));
  EXPECT_NEAR(mean_ratio(feature_variances(frame)[0], truth), 1.15, 0.15);
}

TEST(FeatureVariance, CleanTextureHasNone) {
  Frame frame;
  const auto texture = [](int x, int y, int c) { return 0.5 + 0.3 * std::sin(0.9 * x + 0.2 * c) * std::cos(0.7 * y); };
  frame.features.push_back({Role::Albedo, {"", test::image_of(width, height, 3, texture), {}, {}, {}}});
  const double of_texture = 0.3 * 0.3 / 4;
  EXPECT_LT(mean_ratio(feature_variances(frame)[0], Image(width, height, 3, Real(of_texture))), 0.02);
}

/// Tiles of 6 x 6 pixels, of which the right half of the image has noise.
TEST(FeatureVariance, EqualPixelsHaveNoneEvenNextToEdges) {
  Frame frame;
  test::Random random(35);
  const auto tile = [&](int x, int y, int) {
    return 0.5 + 0.2 * ((x / 6 + y / 6) % 2) + (x < width / 2 ? 0 : 0.05 * random.normal());
  };
  frame.features.push_back({Role::Albedo, {"", test::image_of(width, height, 3, tile), {}, {}, {}}});
  const Image found = feature_variances(frame)[0];
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (x < width / 2)
        EXPECT_EQ(found.at(x, y, 0), Real(0)) << x << ' ' << y;
      else
        EXPECT_GT(found.at(x, y, 0), Real(0)) << x << ' ' << y;
    }
}

}  // namespace
}  // namespace polyrecon
