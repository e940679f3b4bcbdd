#include "polyrecon/reconstruct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "polyrecon/error.h"
#include "support/images.h"
#include "support/random.h"
#include "support/reconstruction.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

using test::finite;
using test::image_of;
using test::make_scene;
using test::quick;
using test::run;
using test::Scene;

TEST(Reconstruct, TakesTheNoiseOutOfASceneOfKnownTruth) {
  for (const double noise : {0.1, 0.4, 1.0}) {
    const Scene scene = make_scene(96, 72, noise, 1);
    const Result result = run(scene.frame);
    const double before = test::relative_mse(scene.frame.beauty.mean, scene.truth);
    const double after = test::relative_mse(result.beauty, scene.truth);
    EXPECT_LT(after, 0.2 * before) << noise;
    // The stated error is too large rather than too small: blending cancels biases of opposite sign, and the coarser
    // levels remove some bias, but the estimates of the windows include neither. It is 1.3 to 1.9 times the true one.
    EXPECT_GT(result.report.estimated_relative_mse, 0.7 * after) << noise;
    EXPECT_LT(result.report.estimated_relative_mse, 2.5 * after) << noise;
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

TEST(Reconstruct, TakesWiderPatchesWhereTheNoiseIsEstimated) {
  Scene scene = make_scene(48, 40, 0.4, 9);
  const auto with = [&](int measured, int estimated) {
    Params params = quick();
    params.patch.radius = measured;
    params.estimated_patch.radius = estimated;
    return run(scene.frame, params).beauty;
  };
  EXPECT_TRUE(test::same_bits(with(1, 2), with(1, 1)));
  scene.frame.beauty.variance = scene.frame.beauty.half_a = scene.frame.beauty.half_b = Image();
  EXPECT_TRUE(test::same_bits(with(1, 2), with(2, 2)));
  EXPECT_FALSE(test::same_bits(with(1, 2), with(1, 1)));
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
  for (const Image* image :
       {&result.error.mse, &result.error.relative_mse, &result.error.relative_variance, &result.error.relative_noise})
    for (int c = 0; c < image->channels(); ++c)
      for (std::size_t i = 0; i < image->pixels(); ++i) ASSERT_GE(image->plane(c)[i], Real(0));
}

TEST(Reconstruct, KeepsTheEnergy) {
  const Result result = run(make_scene(96, 72, 0.4, 6).frame);
  // 6912 pixels of relative noise 0.4: the standard error of the input's mean is 0.5 %.
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
  // The report states about the energy of the added fireflies. The sum over the image grows by it, and no pixel is far
  // too bright.
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

/// A layer that is no part of the beauty: an albedo, with a beauty so dark that noise and splitting change its sign.
TEST(Reconstruct, ALayerThatIsNoPartOfADarkBeautyStays) {
  Scene scene = make_scene(48, 40, 0.3, 27);
  Frame& frame = scene.frame;
  test::Random random(27);
  frame.beauty.half_a = frame.beauty.half_b = Image();
  frame.beauty.mean = image_of(48, 40, 3, [&](int, int, int) { return 0.001 + 0.05 * random.normal(); });
  frame.beauty.variance = Image(48, 40, 3, Real(0.0025));
  frame.aovs = {{"Albedo", Image(48, 40, 3, Real(0.8)), {}, {}, {}}};
  const Image layer = run(frame).aovs[0];
  // The mean stays. The difference of the halves averages out but for the noise of a window.
  EXPECT_LT(test::max_difference(layer, frame.aovs[0].mean), 0.2);
}

TEST(Reconstruct, AlphaIsKeptOrReconstructed) {
  Scene scene = make_scene(40, 36, 0.2, 9);
  test::Random random(3);
  scene.frame.alpha = image_of(40, 36, 1, [&](int x, int, int) { return x < 20 ? 0.25 + 0.2 * random.uniform() : 1; });
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

}  // namespace
}  // namespace polyrecon
