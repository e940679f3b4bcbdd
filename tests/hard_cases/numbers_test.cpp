// Cases 16 to 28: results stay finite, symmetric, unbiased and the same to the bit.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "blend/select.h"
#include "core/resample.h"
#include "features/prepare.h"
#include "io/exr_fixture.h"
#include "outliers/remove.h"
#include "outliers/restore.h"
#include "pipeline/memory.h"
#include "pipeline/stage.h"
#include "polyrecon/error.h"
#include "polyrecon/merge.h"
#include "polyrecon/read_frame.h"
#include "support/images.h"
#include "support/instances.h"
#include "support/random.h"
#include "support/reconstruction.h"
#include "support/regression.h"
#include "support/scene.h"
#include "support/threads.h"

namespace polyrecon {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::design_with_constant;
using test::eps;
using test::finite;
using test::image_of;
using test::make_scene;
using test::normal_matrix;
using test::orthonormality_error;
using test::Problem;
using test::quick;
using test::Random;
using test::random_weights;
using test::run;
using test::Scene;
using test::stored;

constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinity = std::numeric_limits<Real>::infinity();

/// The frame with map applied to the images of all its passes.
template <typename F>
Frame mapped(Frame frame, const F& map) {
  const auto map_pass = [&](Pass& pass) {
    for (Image* image : {&pass.mean, &pass.variance, &pass.half_a, &pass.half_b})
      if (!image->empty()) *image = map(*image);
  };
  map_pass(frame.beauty);
  for (Feature& feature : frame.features) map_pass(feature.pass);
  for (Pass& aov : frame.aovs) map_pass(aov);
  return frame;
}

Frame exposed(Frame frame, double factor) {
  for (Image* image : {&frame.beauty.mean, &frame.beauty.half_a, &frame.beauty.half_b})
    if (!image->empty()) *image = test::times(*image, factor);
  if (!frame.beauty.variance.empty()) frame.beauty.variance = test::times(frame.beauty.variance, factor * factor);
  return frame;
}

// ---- 16, 17: bad pixels and bad passes

struct BadPixel {
  const char* pass;
  Image* (*image)(Frame& frame);
};

const BadPixel bad_pixels[] = {
    {"beauty", [](Frame& f) { return &f.beauty.mean; }},
    {"variance", [](Frame& f) { return &f.beauty.variance; }},
    {"half a", [](Frame& f) { return &f.beauty.half_a; }},
    {"half b", [](Frame& f) { return &f.beauty.half_b; }},
    {"albedo", [](Frame& f) { return &f.features[0].pass.mean; }},
    {"normal", [](Frame& f) { return &f.features[1].pass.mean; }},
    {"depth", [](Frame& f) { return &f.features[2].pass.mean; }},
    {"layer", [](Frame& f) { return &f.aovs[0].mean; }},
};

/// With one stage on one level, a pixel influences others within the halo of a stage plus the radii of the firefly
/// removal (neighbourhood 2, density 9). Totals are not restored here, as that changes every pixel.
TEST(Case16, OneBadPixelIsFiniteAndStaysLocal) {
  Params params = quick();
  params.stages = 1;
  params.levels = 1;
  params.radius = 2;
  params.components.restore_totals = false;
  const int halo = stage_halo(params) + 2 + 9;
  Scene scene = make_scene(96, 32, 0.2, 10);
  scene.frame.aovs = {{"Layer", test::times(scene.frame.beauty.mean, 0.5), {}, {}, {}}};
  const Result clean = run(scene.frame, params);
  for (const BadPixel& where : bad_pixels)
    for (const Real value : {nan, infinity, -infinity, Real(1e30), Real(-1e30), Real(-1)}) {
      SCOPED_TRACE(std::string(where.pass) + " " + std::to_string(value));
      Frame frame = scene.frame;
      where.image(frame)->at(4, 16, 0) = value;
      const Result result = run(frame, params);
      EXPECT_TRUE(finite(result));
      const Rect far{4 + halo + 1, 0, 96, 32};
      // Relative errors are divided by the mean brightness of the frame, which changes with one pixel of 3072.
      EXPECT_LT(test::max_difference(crop(result.beauty, far), crop(clean.beauty, far)), 1e-4);
      EXPECT_LT(test::max_difference(result.beauty, clean.beauty), 2);
    }
}

TEST(Case17, ABadPassIsDroppedAndTheRestWorks) {
  const Scene scene = make_scene(48, 40, 0.4, 11);
  for (std::size_t k = 0; k < 3; ++k)
    for (const Real value : {nan, infinity, Real(0), Real(0.5)}) {
      Frame frame = scene.frame;
      Image& mean = frame.features[k].pass.mean;
      mean = Image(mean.width(), mean.height(), mean.channels(), value);
      const Result result = run(frame);
      EXPECT_TRUE(finite(result));
      EXPECT_LT(test::relative_mse(result.beauty, scene.truth),
                0.5 * test::relative_mse(frame.beauty.mean, scene.truth));
    }
}

TEST(Case17, ABeautyWithoutAFinitePixelFailsTheCheck) {
  for (const Real value : {nan, infinity, Real(1e30)}) {
    Frame frame = make_scene(20, 20, 0.4, 11).frame;
    for (Image* image : {&frame.beauty.mean, &frame.beauty.half_a, &frame.beauty.half_b})
      *image = Image(20, 20, 3, value);
    try {
      run(frame);
      FAIL() << value;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::CheckFailed);
    }
  }
}

// ---- 18: hard features

Frame with_features_times(Frame frame, double factor) {
  for (Feature& feature : frame.features) feature.pass.mean = test::times(feature.pass.mean, factor);
  return frame;
}

/// Without the prefilter, which leaves rounding errors in a flat feature that a fit may follow.
TEST(Case18, FeaturesOfAnyScaleGiveTheSameImage) {
  const Scene scene = make_scene(48, 40, 0.3, 12);
  Params params = quick();
  params.steps.prefilter = false;
  const Image plain = run(scene.frame, params).beauty;
  for (const double factor : {1e-6, 1e6, 1e-12})
    EXPECT_LT(test::max_difference(run(with_features_times(scene.frame, factor), params).beauty, plain),
              1e-5 * test::max_magnitude(plain))
        << factor;
}

TEST(Case18, PrefilteredFeaturesOfAnyScaleGiveTheSameBits) {
  const Scene scene = make_scene(48, 40, 0.3, 12);
  Frame frame = scene.frame;  // without depth, which is divided by its median
  frame.features.erase(std::remove_if(frame.features.begin(), frame.features.end(),
                                      [](const Feature& f) { return f.role == Role::Depth; }),
                       frame.features.end());
  const Image plain = run(frame).beauty;
  for (const double factor : {0x1p-20, 0x1p20, 0x1p-40})
    EXPECT_TRUE(test::same_bits(run(with_features_times(frame, factor)).beauty, plain)) << factor;
}

TEST(Case18, DependentFeaturesChangeNothing) {
  const Scene scene = make_scene(48, 40, 0.3, 13);
  const Result plain = run(scene.frame);
  Frame twice = scene.frame;
  twice.features.push_back(twice.features[0]);  // the columns span the same space
  const Result duplicate = run(twice);
  EXPECT_GT(duplicate.report.rank_deficient_windows, 0u);
  EXPECT_LT(test::max_difference(duplicate.beauty, plain.beauty), 1e-5 * test::max_magnitude(plain.beauty));
}

TEST(Case18, HardFeaturesAreFinite) {
  const Scene scene = make_scene(40, 36, 0.3, 14);
  test::Random random(14);
  for (const double size : {1e-44, 1e-38, 1e-30, 1e10, 1e14}) {
    Frame frame = scene.frame;
    frame.features.push_back(
        {Role::Visibility,
         {"hard", image_of(40, 36, 1, [&](int, int, int) { return size * random.uniform(); }), {}, {}, {}}});
    frame.features.push_back(
        {Role::Depth,
         {"sky", image_of(40, 36, 1, [&](int x, int, int) { return x < 10 ? 1e10 : 3 + 0.1 * x; }), {}, {}, {}}});
    const Result result = run(frame);
    EXPECT_TRUE(finite(result)) << size;
    EXPECT_LT(test::relative_mse(result.beauty, scene.truth), 0.5 * test::relative_mse(frame.beauty.mean, scene.truth))
        << size;
  }
}

TEST(Case18, MoreFeaturesThanTheModelHoldsAreLeftOut) {
  Scene scene = make_scene(40, 36, 0.3, 15);
  for (int k = 0; k < 12; ++k) scene.frame.features.push_back(scene.frame.features[static_cast<std::size_t>(k % 2)]);
  EXPECT_TRUE(finite(run(scene.frame)));
  scene.frame.beauty.variance = scene.frame.beauty.half_a = scene.frame.beauty.half_b =
      Image();  // the variance is estimated
  EXPECT_TRUE(finite(run(scene.frame)));
}

// ---- 19: variance

TEST(Case19, WithoutNoiseTheImageComesBackUnchanged) {
  Scene scene = make_scene(48, 40, 0.3, 16);
  Frame& frame = scene.frame;
  frame.beauty.mean = frame.beauty.half_a = frame.beauty.half_b = scene.truth;
  frame.beauty.variance = Image(48, 40, 3);
  EXPECT_TRUE(test::same_bits(run(frame).beauty, scene.truth));
  frame.beauty.half_a = frame.beauty.half_b = Image();
  EXPECT_TRUE(test::same_bits(run(frame).beauty, scene.truth));
}

TEST(Case19, WrongVarianceIsStable) {
  const Scene scene = make_scene(48, 40, 0.3, 17);
  const double before = test::relative_mse(scene.frame.beauty.mean, scene.truth);
  for (const double factor : {0.01, 100.0}) {
    Frame frame = scene.frame;
    frame.beauty.variance = test::times(frame.beauty.variance, factor);
    const Result result = run(frame);
    EXPECT_TRUE(finite(result));
    EXPECT_LT(test::relative_mse(result.beauty, scene.truth), before) << factor;
  }
  Frame frame = scene.frame;
  for (int k = 0; k < 40; ++k)
    for (int c = 0; c < 3; ++c) frame.beauty.variance.at(k, (7 * k) % 40, c) = 0;
  const Result result = run(frame);
  EXPECT_TRUE(finite(result));
  EXPECT_LT(test::relative_mse(result.beauty, scene.truth), 0.5 * before);
}

// ---- 20: extreme values

TEST(Case20, HardImagesAreFinite) {
  test::Random random(18);
  const int w = 40, h = 36;
  struct Case {
    const char* name;
    Image truth;
  };
  const Case cases[] = {
      {"black", Image(w, h, 3)},
      {"equal", Image(w, h, 3, Real(0.3))},
      {"checkerboard of extremes", image_of(w, h, 3, [](int x, int y, int) { return (x + y) % 2 ? 1e6 : 1e-8; })},
      {"1e-8 to 1e6", image_of(w, h, 3, [&](int, int, int) { return std::pow(10, random.uniform(-8, 6)); })},
      {"one bright pixel", image_of(w, h, 3, [](int x, int y, int) { return x == 20 && y == 20 ? 1e6 : 0; })},
      {"negative", Image(w, h, 3, Real(-1))},
      {"tiny", Image(w, h, 3, Real(1e-35))},
      {"large", Image(w, h, 3, Real(1e14))},
  };
  for (const Case& k : cases)
    for (const double noise : {0.0, 0.5}) {
      SCOPED_TRACE(std::string(k.name) + (noise > 0 ? " with noise" : ""));
      Frame frame;
      frame.beauty.name = "Combined";
      const auto half = [&](int x, int y, int c) {
        return static_cast<double>(k.truth.at(x, y, c)) * (1 + noise * random.normal());
      };
      frame.beauty.half_a = image_of(w, h, 3, half);
      frame.beauty.half_b = image_of(w, h, 3, half);
      frame.beauty.mean = test::mean_of(frame.beauty.half_a, frame.beauty.half_b);
      frame.beauty.variance = image_of(w, h, 3, [&](int x, int y, int c) {
        return std::pow(noise * static_cast<double>(k.truth.at(x, y, c)), 2) / 2;
      });
      const Result result = run(frame);
      EXPECT_TRUE(finite(result));
      if (noise == 0) {
        EXPECT_TRUE(test::same_bits(result.beauty, k.truth));
      }
      // No value is much larger than the largest input.
      EXPECT_LE(test::max_magnitude(result.beauty),
                1.5 * std::max(test::max_magnitude(frame.beauty.half_a), test::max_magnitude(frame.beauty.half_b)));
    }
}

// ---- 21: symmetries

TEST(Case21, ExposureByAPowerOfTwoIsExact) {
  const Scene scene = make_scene(48, 40, 0.3, 19);
  const Result plain = run(scene.frame);
  for (const int k : {-12, -1, 3, 12}) {
    const double factor = std::exp2(k);
    const Result result = run(exposed(scene.frame, factor));
    EXPECT_TRUE(test::same_bits(result.beauty, test::times(plain.beauty, factor))) << k;
  }
}

TEST(Case21, ExposureByAnyFactorFollowsToRounding) {
  const Scene scene = make_scene(48, 40, 0.3, 20);
  const Result plain = run(scene.frame);
  const Image expected = test::times(plain.beauty, 3.7);
  EXPECT_LT(test::max_difference(run(exposed(scene.frame, 3.7)).beauty, expected),
            1e-5 * test::max_magnitude(expected));
}

TEST(Case21, ColoursPermute) {
  const Scene scene = make_scene(48, 40, 0.3, 21);
  const auto permuted = [](const Image& image) {
    if (image.empty()) return Image();
    return image_of(image.width(), image.height(), 3, [&](int x, int y, int c) { return image.at(x, y, (c + 1) % 3); });
  };
  Frame frame = scene.frame;
  for (Image* image : {&frame.beauty.mean, &frame.beauty.variance, &frame.beauty.half_a, &frame.beauty.half_b})
    *image = permuted(*image);
  const Image expected = permuted(run(scene.frame).beauty);
  EXPECT_LT(test::max_difference(run(frame).beauty, expected), 1e-5 * test::max_magnitude(expected));
}

/// Parameters under which a flip of the input flips the result: every pixel is a centre, and no noise of features is
/// estimated, as that takes every second pixel. Sizes must be divisible by the pixels of the coarsest level.
Params symmetric() {
  Params params = quick();
  params.stride = 1;
  params.steps.prefilter = false;
  return params;
}

Image flipped_x(const Image& image) {
  return image_of(image.width(), image.height(), image.channels(),
                  [&](int x, int y, int c) { return image.at(image.width() - 1 - x, y, c); });
}

Image flipped_y(const Image& image) {
  return image_of(image.width(), image.height(), image.channels(),
                  [&](int x, int y, int c) { return image.at(x, image.height() - 1 - y, c); });
}

Image transposed(const Image& image) {
  return image_of(image.height(), image.width(), image.channels(),
                  [&](int x, int y, int c) { return image.at(y, x, c); });
}

TEST(Case21, FlipsFollow) {
  const Scene scene = make_scene(36, 32, 0.3, 22);
  const Image plain = run(scene.frame, symmetric()).beauty;
  EXPECT_LT(test::max_difference(run(mapped(scene.frame, flipped_x), symmetric()).beauty, flipped_x(plain)),
            1e-5 * test::max_magnitude(plain));
  EXPECT_LT(test::max_difference(run(mapped(scene.frame, flipped_y), symmetric()).beauty, flipped_y(plain)),
            1e-5 * test::max_magnitude(plain));
}

TEST(Case21, TranspositionFollows) {
  const Scene scene = make_scene(36, 32, 0.3, 23);
  const Image plain = run(scene.frame, symmetric()).beauty;
  EXPECT_LT(test::max_difference(run(mapped(scene.frame, transposed), symmetric()).beauty, transposed(plain)),
            1e-5 * test::max_magnitude(plain));
}

// ---- 22: sizes

TEST(Case22, AnySizeWorks) {
  for (const auto& [w, h] :
       {std::pair{1, 1}, std::pair{1, 23}, std::pair{31, 1}, std::pair{2, 2}, std::pair{3, 5}, std::pair{7, 11},
        std::pair{37, 41}, std::pair{63, 5}, std::pair{64, 5}, std::pair{65, 5}, std::pair{129, 33}}) {
    SCOPED_TRACE(::testing::Message() << w << " x " << h);
    const Scene scene = make_scene(w, h, 0.3, 24);
    const Result result = run(scene.frame);
    ASSERT_TRUE(result.beauty.same_shape(Image(w, h, 3)));
    EXPECT_TRUE(finite(result));
    EXPECT_LE(test::max_magnitude(result.beauty), 1.2 * std::max(test::max_magnitude(scene.frame.beauty.half_a),
                                                                 test::max_magnitude(scene.frame.beauty.half_b)));
    Frame single = scene.frame;
    single.beauty.half_a = single.beauty.half_b = single.beauty.variance = Image();
    EXPECT_TRUE(finite(run(single)));
  }
}

// ---- 23: the same bits

TEST(Case23, HasTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = make_scene(150, 90, 0.3, 25);
  const Result once = test::with_threads(1, [&] { return run(scene.frame); });
  for (const int threads : {2, 3, 8, 16}) {
    const Result again = test::with_threads(threads, [&] { return run(scene.frame); });
    EXPECT_TRUE(test::same_bits(again.beauty, once.beauty)) << threads;
    EXPECT_TRUE(test::same_bits(again.error.mse, once.error.mse)) << threads;
    EXPECT_TRUE(test::same_bits(again.order, once.order)) << threads;
  }
}

/// Under the smallest limit that is accepted, stages work in tiles.
TEST(Case15, HasTheSameBitsUnderTheLeastMemory) {
  const Scene scene = make_scene(700, 260, 0.3, 27);
  Params params = quick();
  params.stages = 1;  // quick settings, as the frame must be larger than a tile
  params.max_order = 0;
  params.stride = 5;
  const FrameShape shape = shape_of(scene.frame);
  ASSERT_LT(smallest_tile_pixels(params), shape.pixels);
  const std::size_t plenty = params.max_memory;
  params.max_memory = memory_needs(shape, params).least();
  const Result tiled = run(scene.frame, params);
  params.max_memory = plenty;
  const Result whole = run(scene.frame, params);
  EXPECT_TRUE(test::same_bits(tiled.beauty, whole.beauty));
  EXPECT_TRUE(test::same_bits(tiled.error.mse, whole.error.mse));
}

/// A stage gives the same bits with tiles of any size. The frame is a strip of 6 rows, to be quick, and is wider than
/// three tiles with their halos.
TEST(Case23, HasTheSameBitsForAnyMemory) {
  const Scene scene = make_scene(900, 6, 0.3, 26);
  for (const auto& [radius, stride] : {std::pair{4, 4}, std::pair{3, 3}, std::pair{9, 8}}) {
    Params params = quick();
    params.radius = radius;
    params.stride = stride;
    const Preparation look = choose_features(scene.frame);
    Frame frame = scene.frame;
    const HalfPair pair =
        prepare(frame, look, scene.frame.beauty.variance, PrefilterParams{}, false, silent_progress()).pair;
    const auto work = [&](std::size_t bytes) {
      FitCounters counters;
      const Candidate first = run_stage(pair, nullptr, params, bytes, counters, silent_progress());
      return run_stage(pair, &first, params, bytes, counters, silent_progress());
    };
    const Candidate whole = work(std::size_t{1} << 40);
    for (const std::size_t pixels : {std::size_t{1}, std::size_t{2000}, std::size_t{400 * 400}}) {
      const Candidate tiled = work(pixels * stage_bytes_per_pixel(3, pair.features[0].channels(), params));
      for (std::size_t h = 0; h < 2; ++h)
        EXPECT_TRUE(test::same_bits(tiled.half[h], whole.half[h])) << stride << " " << pixels;
      EXPECT_TRUE(test::same_bits(tiled.squared_bias, whole.squared_bias)) << stride << " " << pixels;
      EXPECT_TRUE(test::same_bits(tiled.order, whole.order)) << stride << " " << pixels;
    }
  }
}

// ---- 24, 25: the fit of one window

/// A matrix of the given rank with singular values in (0.1, 1), as LAPACK's xQRT15 makes them.
MatrixXd matrix_of_rank(int rows, int columns, int rank, Random& random) {
  const auto orthonormal = [&](int n) -> MatrixXd {
    return normal_matrix(n, rank, random).householderQr().householderQ() * MatrixXd::Identity(n, rank);
  };
  const MatrixXd u = orthonormal(rows), v = orthonormal(columns);
  VectorXd singular(rank);
  for (int k = 0; k < rank; ++k) singular(k) = random.uniform(0.1, 1);
  return u * singular.asDiagonal() * v.transpose();
}

/// The six kinds of matrices of LAPACK's least squares tests (xDRVLS): full rank and rank deficient, each unscaled,
/// scaled near underflow and near overflow of the storage type. The ratios are LAPACK's (xQRT17 and xQRT01), which
/// must stay below 30.
TEST(Case24, LapackSixKindsOfMatricesHaveResidualRatiosBelow30) {
  const std::uint64_t seed = 20160701;
  RecordProperty("seed", std::to_string(seed));
  Random random(seed);
  const int instances = test::instances(500, 10000);
  int clear_ranks = 0;
  const double small = static_cast<double>(std::numeric_limits<Real>::min()) / eps, scales[] = {1, small, 1 / small};
  for (int instance = 0; instance < instances; ++instance) {
    const double scale = scales[instance % 3];
    const bool deficient = instance / 3 % 2 == 1;
    const int rows = 20 + random.below(100), columns = 2 + random.below(18);
    const int rank = deficient ? std::max(columns * 3 / 4, 1) : columns;
    MatrixXd x = matrix_of_rank(rows, columns, rank, random);
    x *= scale / x.cwiseAbs().maxCoeff();
    const Problem p(x, random_weights(rows, 0.1, random));
    SCOPED_TRACE("seed " + std::to_string(seed) + ", instance " + std::to_string(instance));
    const VectorXd s = p.w.cwiseSqrt(), y = stored(normal_matrix(rows, 1, random)), z = p.coefficients(y);
    const MatrixXd q = p.q(), sx = s.asDiagonal() * p.x;
    ASSERT_TRUE(q.allFinite());
    // The problem that is solved has additional rows for the penalties.
    const test::Penalised reference = test::penalised(p.x / scale, p.w, {}, 0);
    const MatrixXd& a = reference.augmented;
    MatrixXd aq(a.rows(), columns);
    aq << s.asDiagonal() * q, reference.tail;
    const double n = rows;
    // A column that enters in part leaves part of the columns that depend on it, which then may count too. The rank is
    // certain only if hardly any column enters in part.
    if (reference.tail.squaredNorm() < 0.03 * 0.03) {
      ++clear_ranks;
      EXPECT_EQ(p.factor.rank, rank);
    }
    EXPECT_LT(orthonormality_error(p) / (n * eps), 30);
    EXPECT_LT((a - aq * (aq.transpose() * a)).norm() / (a.norm() * n * eps), 30);
    VectorXd residual(a.rows());
    residual << s.asDiagonal() * (y - q * z), -reference.tail * z;
    EXPECT_LT((residual.transpose() * a).norm() / (a.norm() * (s.asDiagonal() * y).norm() * n * eps), 30);
  }
  EXPECT_GT(clear_ranks, 0.5 * instances);
}

/// The sum is the number of columns kept, less the part that the penalties take.
TEST(Case25, LeverageLiesBetweenZeroAndOneAndSumsToTheRank) {
  const std::uint64_t seed = 4;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random(seed);
  for (int round = 0; round < test::instances(500, 10000); ++round) {
    // Some rounds have fewer pixels with weight than columns; every leverage is then 0 or 1.
    const int rows = 3 + random.below(60), columns = 1 + random.below(20);
    const Problem p(design_with_constant(rows, columns, random), random_weights(rows, 0.4, random));
    const MatrixXd q = p.q();
    double sum = 0;
    for (int j = 0; j < rows; ++j) {
      const double leverage = p.w(j) * q.row(j).squaredNorm();
      EXPECT_GE(leverage, 0);
      EXPECT_LE(leverage, 1 + 1000 * eps) << rows << " x " << columns;
      sum += leverage;
    }
    const double taken = test::penalised(p.x, p.w, {}, 0).tail.squaredNorm();
    EXPECT_NEAR(sum, static_cast<double>(p.factor.kept) - taken, 1000 * eps * std::max(p.factor.rank, 1));
    EXPECT_LE(p.factor.rank, p.factor.kept);
    EXPECT_LE(sum, static_cast<double>((p.w.array() > 0).count()) * (1 + 100 * eps));
  }
}

TEST(Case25, LeaveOneOutResidualIsTheResidualOverOneMinusLeverage) {
  Random random(5);
  const Problem p(design_with_constant(30, 6, random), random_weights(30, 0, random));
  const VectorXd y = stored(normal_matrix(30, 1, random)), z = p.coefficients(y), s = p.w.cwiseSqrt();
  const MatrixXd q = p.q();
  const VectorXd fit = q * z;
  for (int j = 0; j < 30; ++j) {
    VectorXd without = s;
    without(j) = 0;
    const MatrixXd sx = without.asDiagonal() * p.x;
    const VectorXd beta = sx.colPivHouseholderQr().solve(without.asDiagonal() * y);
    const double expected = y(j) - p.x.row(j).dot(beta);
    const double leverage = p.w(j) * q.row(j).squaredNorm();
    EXPECT_NEAR((y(j) - fit(j)) / (1 - leverage), expected,
                200 * eps * std::max(1.0, std::abs(expected)) / (1 - leverage))
        << j;
  }
}

// ---- 26: energy

/// Removal and restoration together keep the energy of each channel to 1e-6, whatever the spikes.
TEST(Case26, EnergyOfAnySpikesComesBack) {
  const std::uint64_t first = 2600;
  for (int instance = 0; instance < test::instances(200, 5000); ++instance) {
    SCOPED_TRACE("seed " + std::to_string(first + static_cast<std::uint64_t>(instance)));
    Random random(first + static_cast<std::uint64_t>(instance));
    const int width = 1 + random.below(40), height = 1 + random.below(40);
    const double base = random.uniform() < 0.2 ? 0 : std::pow(10, random.uniform(-4, 4));
    const Image truth =
        image_of(width, height, 6, [&](int x, int, int c) { return base * (c < 3 ? 1 + 0.02 * x : 0.3); });
    HalfPair pair = test::pair_of(truth, 0.02 * base, first);
    for (int k = random.below(1 + width * height / 100 + 3); k >= 0; --k) {
      const int x = random.below(width), y = random.below(height);  // of one to three pixels in a row, in one half
      const std::size_t half = static_cast<std::size_t>(random.below(2));
      const double value = (base + 1) * std::pow(10, random.uniform(0, 4));
      for (int run = random.below(3); run >= 0; --run)
        for (int c = 0; c < 6; ++c) {
          pair.color[half].at(std::min(x + run, width - 1), y, c) = static_cast<Real>(c < 3 ? value : 0.3 * value);
          if (c < 3) pair.variance.at(std::min(x + run, width - 1), y, c) = static_cast<Real>(value * value / 2);
        }
    }
    const Image before = test::mean_of(pair.color[0], pair.color[1]);
    const auto outliers = remove_outliers(pair, {true, true}, OutlierParams{}, silent_progress());
    Image after = test::mean_of(pair.color[0], pair.color[1]);
    restore_energy(outliers, pair.variance, 0.02, after);
    EXPECT_TRUE(test::all_finite(after));
    for (int c = 0; c < 6; ++c)
      EXPECT_NEAR(test::sum_of(after, c), test::sum_of(before, c), 1e-6 * test::sum_of(before, c)) << c;
  }
}

/// A glint (a reflection of the sun) has pixels that differ a thousandfold; the surface around it has little noise.
/// Windows that cover both must not spread the glint's energy to pixels without it.
TEST(Case26, AGlintStaysInItsPlace) {
  const auto inside = [](int x, int y) { return (x - 64) * (x - 64) + (y - 48) * (y - 48) <= 4; };
  Random random(2626);
  const auto half = [&] {
    return image_of(128, 96, 3, [&](int x, int y, int) {
      if (!inside(x, y)) return 0.25 + 0.001 * random.normal();
      return random.uniform() < 0.5 ? 1 + random.uniform() : std::pow(10, random.uniform(0, 1.5));
    });
  };
  Frame frame;
  frame.beauty = {"Combined", {}, {}, half(), half()};
  frame.beauty.mean = test::mean_of(frame.beauty.half_a, frame.beauty.half_b);
  frame.beauty.variance = image_of(128, 96, 3, [&](int x, int y, int c) {
    const double a = frame.beauty.half_a.at(x, y, c), b = frame.beauty.half_b.at(x, y, c);
    return std::max((a - b) * (a - b) / 4, inside(x, y) ? 0 : 0.5e-6);
  });
  frame.data_window = {0, 0, 128, 96};
  const auto spread = [&](const Params& params) {
    const Result result = run(frame, params);
    double worst = 0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 128; ++x)
        if (!inside(x, y)) worst = std::max(worst, std::abs(static_cast<double>(result.beauty.at(x, y, 0)) - 0.25));
    return worst;
  };
  Params unbound;
  unbound.components.noise_bound = false;
  const double without = spread(unbound), with = spread(Params{});
  EXPECT_LT(with, 0.02);  // five standard deviations of the noisiest pixel
  EXPECT_LT(with, without / 3) << without;
}

// ---- 27: more samples never increase the error

/// n times the samples stand for a variance that is n times smaller.
TEST(Case27, MoreSamplesNeverMakeItWorse) {
  double before = 1e9;
  for (const int samples : {4, 16, 64, 256, 1024}) {
    const Scene scene = make_scene(64, 48, 2 / std::sqrt(samples), 3);
    const double error = test::relative_mse(run(scene.frame).beauty, scene.truth);
    EXPECT_LT(error, before) << samples;
    EXPECT_LE(error, test::relative_mse(scene.frame.beauty.mean, scene.truth)) << samples;
    before = error;
  }
}

/// Merged renders of one scene with 8, 12 and 16 samples per pixel, against a reference of 2048.
TEST(Case27, MoreSamplesOfARealRenderNeverMakeItWorse) {
  const std::string samples = std::string(POLYRECON_SOURCE_DIR) + "/samples/";
  const testing::TemporaryFolder folder;
  const Image reference = half_resolution(read_frame(samples + "study_ref.exr").frame.beauty.mean);
  double before = 1e9;
  for (const int renders : {2, 3, 4}) {
    std::vector<std::string> paths;
    for (int k = 0; k < renders; ++k) paths.push_back(samples + "study_small_" + std::to_string(k) + ".exr");
    MergeOptions merging;
    merging.samples = 4;
    merge(paths, folder / "merged.exr", merging);
    const Frame frame = read_frame(folder / "merged.exr").frame;
    const double error = test::relative_mse(run(frame, Params()).beauty, reference);
    EXPECT_LT(error, before) << renders;
    EXPECT_LT(error, test::relative_mse(frame.beauty.mean, reference)) << renders;
    before = error;
  }
}

}  // namespace
}  // namespace polyrecon
