#include "pipeline/reconstruct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "features/prepare.h"
#include "pipeline/memory.h"
#include "pipeline/stage.h"
#include "support/images.h"
#include "support/random.h"
#include "support/scene.h"
#include "support/threads.h"

namespace polyrecon {
namespace {

using test::image_of;
using test::make_scene;
using test::Scene;

constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinity = std::numeric_limits<Real>::infinity();

/// Two stages and two levels with small windows: every part of the pipeline runs, in little time.
Params quick() {
  Params params;
  params.stages = 2;
  params.levels = 2;
  params.radius = 5;
  params.stride = 2;
  return params;
}

Result run(const Frame& frame, const Params& params = quick()) {
  Progress silent;
  Frame taken = frame;
  return reconstruct(taken, params, silent);
}

bool finite(const Result& result) {
  bool all = test::all_finite(result.beauty) && test::all_finite(result.order) && test::all_finite(result.error.mse) &&
             test::all_finite(result.error.relative_mse) && test::all_finite(result.error.relative_variance) &&
             std::isfinite(result.error.cross_validated);
  for (const Image& aov : result.aovs) all &= test::all_finite(aov);
  return all;
}

/// The same function of every image of a frame.
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

// ---- It does what it is for

TEST(Reconstruct, TakesTheNoiseOutOfASceneOfKnownTruth) {
  for (const double noise : {0.1, 0.4, 1.0}) {
    const Scene scene = make_scene(96, 72, noise, 1);
    const Result result = run(scene.frame);
    const double before = test::relative_mse(scene.frame.beauty.mean, scene.truth);
    const double after = test::relative_mse(result.beauty, scene.truth);
    EXPECT_LT(after, 0.2 * before) << noise;
    // The error that it states is on the safe side: blending cancels bias of opposite sign, and the coarser levels take
    // some away, neither of which a window's own estimate knows. Measured 1.4 to 2.1 times the true one.
    EXPECT_GT(result.report.estimated_relative_mse, 0.7 * after) << noise;
    EXPECT_LT(result.report.estimated_relative_mse, 3 * after) << noise;
  }
}

/// HARD_CASE 27 in the small: n times the samples, a variance n times smaller.
TEST(Reconstruct, MoreSamplesNeverMakeItWorse) {
  double before = 1e9;
  for (const int samples : {4, 16, 64, 256, 1024}) {
    const Scene scene = make_scene(64, 48, 2 / std::sqrt(samples), 3);
    const double error = test::relative_mse(run(scene.frame).beauty, scene.truth);
    EXPECT_LT(error, before) << samples;
    EXPECT_LE(error, test::relative_mse(scene.frame.beauty.mean, scene.truth)) << samples;
    before = error;
  }
}

TEST(Reconstruct, WorksWithoutHalvesAndWithoutVariance) {
  for (const bool halves : {true, false})
    for (const bool variance : {true, false}) {
      Scene scene = make_scene(64, 48, 0.4, 2);
      if (!halves) scene.frame.beauty.half_a = scene.frame.beauty.half_b = Image();
      if (!variance) scene.frame.beauty.variance = Image();
      const Result result = run(scene.frame);
      EXPECT_LT(test::relative_mse(result.beauty, scene.truth),
                0.35 * test::relative_mse(scene.frame.beauty.mean, scene.truth))
          << halves << variance;
      EXPECT_TRUE(finite(result));
      const char* source = variance ? "from the file" : halves ? "from the half buffers" : "estimated from the image";
      EXPECT_EQ(result.report.variance_source, source);
    }
}

TEST(Reconstruct, RunsEveryStageAndOrder) {
  const Scene scene = make_scene(40, 36, 0.4, 4);
  const double before = test::relative_mse(scene.frame.beauty.mean, scene.truth);
  for (int stages = 1; stages <= 4; ++stages)
    for (int order = 0; order <= 4; order += stages == 2 ? 1 : 4) {
      Params params = quick();
      params.stages = stages;
      params.max_order = order;
      const Result result = run(scene.frame, params);
      EXPECT_TRUE(finite(result)) << stages << " " << order;
      EXPECT_LT(test::relative_mse(result.beauty, scene.truth), 0.4 * before) << stages << " " << order;
      EXPECT_LE(test::max_magnitude(result.order), order + 1e-5);
    }
}

TEST(Reconstruct, TheErrorMapIsNotNegative) {
  const Result result = run(make_scene(48, 40, 0.4, 5).frame);
  for (const Image* image : {&result.error.mse, &result.error.relative_mse, &result.error.relative_variance})
    for (int c = 0; c < image->channels(); ++c)
      for (std::size_t i = 0; i < image->pixels(); ++i) ASSERT_GE(image->plane(c)[i], Real(0));
}

TEST(Reconstruct, KeepsTheEnergy) {
  const Result result = run(make_scene(96, 72, 0.4, 6).frame);
  // 6912 pixels of relative noise 0.4: the input's own mean is known to 0.5 %.
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(result.report.energy_after[c] / result.report.energy_before[c], 1, 0.01);
}

TEST(Reconstruct, OutliersGiveTheirEnergyBack) {
  Scene scene = make_scene(64, 48, 0.1, 7);
  const Result clean = run(scene.frame);
  double added = 0;
  for (const auto& [x, y] : {std::pair{20, 20}, std::pair{21, 20}, std::pair{63, 0}, std::pair{50, 40}}) {
    for (int c = 0; c < 3; ++c) {
      scene.frame.beauty.half_a.at(x, y, c) += 60;
      scene.frame.beauty.variance.at(x, y, c) = 900;
    }
    added += 30;
  }
  scene.frame.beauty.mean = test::mean_of(scene.frame.beauty.half_a, scene.frame.beauty.half_b);
  const Result result = run(scene.frame);
  EXPECT_EQ(result.report.outliers, clean.report.outliers + 4);
  // What was taken is in the report, about what was put in; the sum over the image grows by it, and no pixel glares.
  EXPECT_NEAR(result.report.outlier_energy[0] - clean.report.outlier_energy[0], added, 1);
  EXPECT_NEAR(test::sum_of(result.beauty, 0), test::sum_of(clean.beauty, 0) + added,
              0.01 * test::sum_of(clean.beauty, 0));
  EXPECT_LT(static_cast<double>(result.beauty.at(20, 20, 0)), 1.5 * static_cast<double>(scene.truth.at(20, 20, 0)));
}

TEST(Reconstruct, AovsThatAddUpStillDo) {
  for (const bool halves : {true, false}) {
    Scene scene = make_scene(56, 48, 0.4, 8);
    Frame& frame = scene.frame;
    const auto part = [&](const Image& whole, bool first) {
      return image_of(56, 48, 3, [&](int x, int y, int c) {
        const double s = 0.5 + 0.4 * std::sin(0.3 * x + 0.1 * y + c);
        return static_cast<double>(whole.at(x, y, c)) * (first ? s : 1 - s);
      });
    };
    for (const bool first : {true, false}) {
      Pass pass{first ? "Diffuse" : "Glossy", part(frame.beauty.mean, first), {}, {}, {}};
      if (halves) {
        pass.half_a = part(frame.beauty.half_a, first);
        pass.half_b = part(frame.beauty.half_b, first);
      }
      frame.aovs.push_back(pass);
    }
    for (int c = 0; c < 3; ++c) {  // a firefly in the glossy layer
      const Real spike = 60;
      frame.beauty.half_a.at(20, 20, c) += spike;
      frame.beauty.mean.at(20, 20, c) += spike / 2;
      frame.beauty.variance.at(20, 20, c) = 900;
      if (halves) frame.aovs[1].half_a.at(20, 20, c) += spike;
      frame.aovs[1].mean.at(20, 20, c) += spike / 2;
    }
    const Result result = run(frame);
    EXPECT_EQ(result.report.outliers, 1u);
    ASSERT_EQ(result.aovs.size(), 2u);
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < result.beauty.pixels(); ++i) {
        const double sum =
            static_cast<double>(result.aovs[0].plane(c)[i]) + static_cast<double>(result.aovs[1].plane(c)[i]);
        const double whole = static_cast<double>(result.beauty.plane(c)[i]);
        ASSERT_NEAR(sum, whole, 1e-3 * std::max(std::abs(whole), 0.1)) << halves << " " << i;
      }
  }
}

/// A layer that is no part of the beauty: an albedo beside a beauty so dark that noise and splitting make it change its
/// sign.
TEST(Reconstruct, ALayerBesideADarkBeautyStaysWhatItIs) {
  Scene scene = make_scene(48, 40, 0.3, 27);
  Frame& frame = scene.frame;
  test::Random random(27);
  frame.beauty.half_a = frame.beauty.half_b = Image();
  frame.beauty.mean = image_of(48, 40, 3, [&](int, int, int) { return 0.001 + 0.05 * random.normal(); });
  frame.beauty.variance = Image(48, 40, 3, Real(0.0025));
  frame.aovs = {{"Albedo", Image(48, 40, 3, Real(0.8)), {}, {}, {}}};
  const Image layer = run(frame).aovs[0];
  // The mean stays; what the halves are set apart by averages out but for the noise of a window.
  EXPECT_LT(test::max_difference(layer, frame.aovs[0].mean), 0.2);
}

TEST(Reconstruct, AlphaIsKeptOrReconstructed) {
  Scene scene = make_scene(40, 36, 0.2, 9);
  scene.frame.alpha = image_of(40, 36, 1, [](int x, int, int) { return x < 20 ? 0.25 : 1; });
  EXPECT_TRUE(test::same_bits(run(scene.frame).alpha, scene.frame.alpha));
  Params params = quick();
  params.reconstruct_alpha = true;
  const Result result = run(scene.frame, params);
  EXPECT_TRUE(test::all_finite(result.alpha));
  EXPECT_GT(test::max_difference(result.alpha, scene.frame.alpha), 0);
}

TEST(Reconstruct, StopsWhenAskedTo) {
  struct Cancelled : Progress {
    bool cancelled() const override { return true; }
  } progress;
  try {
    Frame frame = make_scene(40, 36, 0.2, 9).frame;
    reconstruct(frame, quick(), progress);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::Interrupted);
  }
}

TEST(Reconstruct, TooLittleMemoryIsSaidBeforeTheWork) {
  Params params = quick();
  params.max_memory = 1000;
  try {
    run(make_scene(40, 36, 0.2, 9).frame, params);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::OutOfMemory);
  }
}

// ---- HARD_CASES 16 and 17: bad pixels and bad passes

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

/// A part of the result as it was before restore_totals.
Image without_gain(const Result& result, const Rect& r) {
  const Image part = crop(result.beauty, r);
  return image_of(part.width(), part.height(), 3, [&](int x, int y, int c) {
    return static_cast<double>(part.at(x, y, c)) / (1 + result.report.restored_gain[static_cast<std::size_t>(c)]);
  });
}

/// One stage on one level with windows of radius 2: reach of the fits 2 radii, patch, and the same again for what
/// decides on the finer centres (fit_halo), the choice (select_halo), the outliers (2 + 9) and their restoration (none
/// here).
TEST(Reconstruct, OneBadPixelIsFiniteAndStaysLocal) {
  Params params = quick();
  params.stages = 1;
  params.levels = 1;
  params.radius = 2;
  const int reach = stage_halo(params) + 2 + 9;
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
      const Rect far{4 + reach + 1, 0, 96, 32};
      // Two things are of the whole frame: the gain that keeps its energy, reported, and the mean brightness against
      // which relative errors are weighed, which is off by one pixel in 3072.
      EXPECT_LT(test::max_difference(without_gain(result, far), without_gain(clean, far)), 1e-4);
      EXPECT_LT(test::max_difference(result.beauty, clean.beauty), 2);
    }
}

TEST(Reconstruct, ABadPassIsDroppedAndTheRestWorks) {
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

TEST(Reconstruct, ABeautyWithoutAFinitePixelFailsTheCheck) {
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

// ---- HARD_CASE 18: hard features

TEST(Reconstruct, FeaturesOfAnyScaleGiveTheSameImage) {
  const Scene scene = make_scene(48, 40, 0.3, 12);
  const Result plain = run(scene.frame);
  for (const double factor : {1e-6, 1e6, 1e-12}) {
    Frame frame = scene.frame;
    for (Feature& feature : frame.features) feature.pass.mean = test::times(feature.pass.mean, factor);
    EXPECT_LT(test::max_difference(run(frame).beauty, plain.beauty), 1e-5 * test::max_magnitude(plain.beauty))
        << factor;
  }
}

TEST(Reconstruct, DependentFeaturesChangeNothing) {
  const Scene scene = make_scene(48, 40, 0.3, 13);
  const Result plain = run(scene.frame);
  Frame twice = scene.frame;
  twice.features.push_back(twice.features[0]);  // a duplicate adds no column to the span
  const Result duplicate = run(twice);
  EXPECT_GT(duplicate.report.rank_deficient_windows, 0u);
  EXPECT_LT(test::max_difference(duplicate.beauty, plain.beauty), 1e-5 * test::max_magnitude(plain.beauty));
}

TEST(Reconstruct, HardFeaturesAreFinite) {
  const Scene scene = make_scene(40, 36, 0.3, 14);
  test::Random random(14);
  for (const double size : {1e-44, 1e-38, 1e-30, 1e10, 1e14}) {
    Frame frame = scene.frame;
    frame.features.push_back(
        {FeatureKind::Visibility,
         {"hard", image_of(40, 36, 1, [&](int, int, int) { return size * random.uniform(); }), {}, {}, {}}});
    frame.features.push_back(
        {FeatureKind::Depth,
         {"sky", image_of(40, 36, 1, [&](int x, int, int) { return x < 10 ? 1e10 : 3 + 0.1 * x; }), {}, {}, {}}});
    const Result result = run(frame);
    EXPECT_TRUE(finite(result)) << size;
    EXPECT_LT(test::relative_mse(result.beauty, scene.truth), 0.5 * test::relative_mse(frame.beauty.mean, scene.truth))
        << size;
  }
}

TEST(Reconstruct, MoreFeaturesThanTheModelHoldsAreLeftOut) {
  Scene scene = make_scene(40, 36, 0.3, 15);
  for (int k = 0; k < 6; ++k) scene.frame.features.push_back(scene.frame.features[static_cast<std::size_t>(k % 2)]);
  EXPECT_TRUE(finite(run(scene.frame)));
}

// ---- HARD_CASE 19: variance

TEST(Reconstruct, WithoutNoiseTheImageComesBackUnchanged) {
  Scene scene = make_scene(48, 40, 0.3, 16);
  Frame& frame = scene.frame;
  frame.beauty.mean = frame.beauty.half_a = frame.beauty.half_b = scene.truth;
  frame.beauty.variance = Image(48, 40, 3);
  EXPECT_TRUE(test::same_bits(run(frame).beauty, scene.truth));
  frame.beauty.half_a = frame.beauty.half_b = Image();
  EXPECT_TRUE(test::same_bits(run(frame).beauty, scene.truth));
}

TEST(Reconstruct, WrongVarianceIsStable) {
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

// ---- HARD_CASE 20: values

TEST(Reconstruct, HardImagesAreFinite) {
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
      // Nothing beyond the largest value that came in.
      EXPECT_LE(test::max_magnitude(result.beauty),
                1.5 * std::max(test::max_magnitude(frame.beauty.half_a), test::max_magnitude(frame.beauty.half_b)));
    }
}

// ---- HARD_CASE 21: symmetries

TEST(Reconstruct, ExposureByAPowerOfTwoIsExact) {
  const Scene scene = make_scene(48, 40, 0.3, 19);
  const Result plain = run(scene.frame);
  for (const int k : {-12, -1, 3, 12}) {
    const double factor = std::exp2(k);
    const Result result = run(exposed(scene.frame, factor));
    EXPECT_TRUE(test::same_bits(result.beauty, test::times(plain.beauty, factor))) << k;
  }
}

TEST(Reconstruct, ExposureByAnyFactorFollowsToRounding) {
  const Scene scene = make_scene(48, 40, 0.3, 20);
  const Result plain = run(scene.frame);
  const Image expected = test::times(plain.beauty, 3.7);
  EXPECT_LT(test::max_difference(run(exposed(scene.frame, 3.7)).beauty, expected),
            1e-5 * test::max_magnitude(expected));
}

TEST(Reconstruct, ColoursPermute) {
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

/// Every pixel a centre, and sizes divisible by the coarsest level's pixels: nothing tells left from right.
Params symmetric() {
  Params params = quick();
  params.stride = 1;
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

TEST(Reconstruct, FlipsFollow) {
  const Scene scene = make_scene(36, 32, 0.3, 22);
  const Image plain = run(scene.frame, symmetric()).beauty;
  EXPECT_LT(test::max_difference(run(mapped(scene.frame, flipped_x), symmetric()).beauty, flipped_x(plain)),
            1e-5 * test::max_magnitude(plain));
  EXPECT_LT(test::max_difference(run(mapped(scene.frame, flipped_y), symmetric()).beauty, flipped_y(plain)),
            1e-5 * test::max_magnitude(plain));
}

TEST(Reconstruct, TranspositionFollows) {
  const Scene scene = make_scene(36, 32, 0.3, 23);
  const Image plain = run(scene.frame, symmetric()).beauty;
  EXPECT_LT(test::max_difference(run(mapped(scene.frame, transposed), symmetric()).beauty, transposed(plain)),
            1e-5 * test::max_magnitude(plain));
}

// ---- HARD_CASE 22: sizes

TEST(Reconstruct, AnySizeWorks) {
  for (const auto& [w, h] :
       {std::pair{1, 1}, std::pair{1, 23}, std::pair{31, 1}, std::pair{2, 2}, std::pair{3, 5}, std::pair{7, 11},
        std::pair{37, 41}, std::pair{63, 5}, std::pair{64, 5}, std::pair{65, 5}, std::pair{129, 33}}) {
    SCOPED_TRACE(testing::Message() << w << " x " << h);
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

// ---- HARD_CASE 23: the same bits

TEST(Reconstruct, HasTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = make_scene(150, 90, 0.3, 25);
  const Result once = test::with_threads(1, [&] { return run(scene.frame); });
  for (const int threads : {2, 3, 8, 16}) {
    const Result again = test::with_threads(threads, [&] { return run(scene.frame); });
    EXPECT_TRUE(test::same_bits(again.beauty, once.beauty)) << threads;
    EXPECT_TRUE(test::same_bits(again.error.mse, once.error.mse)) << threads;
    EXPECT_TRUE(test::same_bits(again.order, once.order)) << threads;
    EXPECT_EQ(again.error.cross_validated, once.error.cross_validated) << threads;
  }
}

/// The whole method under the least limit that is accepted: its stages work in tiles.
TEST(Reconstruct, HasTheSameBitsUnderTheLeastMemory) {
  const Scene scene = make_scene(700, 260, 0.3, 27);
  Params params = quick();
  params.stages = 1;  // the frame is larger than a tile: keep the rest small
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

/// A stage in tiles of any size; a strip of 5 rows keeps it quick and is wider than three tiles with their margins.
TEST(Reconstruct, HasTheSameBitsForAnyMemory) {
  const Scene scene = make_scene(900, 6, 0.3, 26);
  Progress silent;
  for (const auto& [radius, stride] : {std::pair{4, 4}, std::pair{3, 3}, std::pair{9, 8}}) {
    Params params = quick();
    params.radius = radius;
    params.stride = stride;
    const Preparation look = look_at(scene.frame);
    Frame frame = scene.frame;
    const HalfPair pair = prepare(frame, look, scene.frame.beauty.variance, PrefilterParams{}, false, silent).pair;
    const auto work = [&](std::size_t bytes) {
      FitCounters counters;
      const Candidate first = run_stage(pair, nullptr, params, bytes, counters, silent);
      return run_stage(pair, &first, params, bytes, counters, silent);
    };
    const Candidate whole = work(std::size_t{1} << 40);
    for (const std::size_t pixels : {std::size_t{1}, std::size_t{2000}, std::size_t{400 * 400}}) {
      const Candidate tiled = work(pixels * stage_bytes_per_pixel(3, pair.features[0].channels(), params));
      for (std::size_t h = 0; h < 2; ++h)
        EXPECT_TRUE(test::same_bits(tiled.half[h], whole.half[h])) << stride << " " << pixels;
      EXPECT_TRUE(test::same_bits(tiled.error, whole.error)) << stride << " " << pixels;
      EXPECT_TRUE(test::same_bits(tiled.order, whole.order)) << stride << " " << pixels;
    }
  }
}

}  // namespace
}  // namespace polyrecon
