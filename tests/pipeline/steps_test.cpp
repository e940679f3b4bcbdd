#include <gtest/gtest.h>

#include <algorithm>

#include "polyrecon/reconstruct.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

/// A simple scene: the upper half is sky without noise, the features have no noise and a variance of 0, and there are
/// no outliers.
test::Scene simple_scene(int width, int height) {
  test::Scene scene = test::make_scene(width, height, 0.1, 7);
  Pass& beauty = scene.frame.beauty;
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < height / 2; ++y)
      for (int x = 0; x < width; ++x) {
        const Real sky = static_cast<Real>(0.5 + 0.3 * y / height + 0.1 * c);
        scene.truth.at(x, y, c) = sky;
        for (Image* image : {&beauty.mean, &beauty.half_a, &beauty.half_b}) image->at(x, y, c) = sky;
        beauty.variance.at(x, y, c) = 0;
      }
  for (Feature& feature : scene.frame.features) {
    feature.pass.variance = Image(width, height, feature.pass.mean.channels());
    for (int c = 0; c < feature.pass.mean.channels(); ++c)
      for (int y = 0; y < height / 2; ++y)
        for (int x = 0; x < width; ++x) feature.pass.mean.at(x, y, c) = 0;
  }
  return scene;
}

struct Outcome {
  double relative_mse = 0;
  Report report;
};

Outcome run(const test::Scene& scene, bool decide) {
  Params params = params_for(Quality::Standard);
  params.steps.decide = decide;
  Frame frame = scene.frame;  // reconstruct takes its passes
  const Result result = reconstruct(frame, params, silent_progress());
  return {test::relative_mse(result.beauty, scene.truth), result.report};
}

const Decision& decision(const Report& report, const std::string& step) {
  for (const Decision& d : report.decisions)
    if (d.step == step) return d;
  throw std::runtime_error("no decision on " + step);
}

TEST(Steps, ASimpleSceneTakesLessWorkThanAllSteps) {
  const test::Scene scene = simple_scene(256, 192);
  const Outcome all = run(scene, false), decided = run(scene, true);
  // Windows are counted, not seconds: the count is the same on any machine and under any load.
  EXPECT_LE(2 * decided.report.windows, all.report.windows);
  for (const char* step : {"feature albedo prefilter", "feature normal prefilter", "feature depth prefilter"}) {
    EXPECT_TRUE(decision(all.report, step).run) << step;
    EXPECT_FALSE(decision(decided.report, step).run) << step;
  }
  EXPECT_NEAR(decided.relative_mse, all.relative_mse, 0.01 * all.relative_mse);
}

TEST(Steps, EachDecisionHasAReasonAndWhatItSaves) {
  const Outcome decided = run(simple_scene(96, 64), true);
  const Decision& sky = decision(decided.report, "noise-free pixels skipped");
  EXPECT_TRUE(sky.run);
  // 32 of 64 rows: those next to the noisy ones get a variance from them (noise/variance_floor.h), but no fit is within
  // their noise bound.
  EXPECT_EQ(sky.reason, "50.0 % of the frame has no noise");
  const auto& phases = decided.report.phases;
  const auto fits = std::find_if(phases.begin(), phases.end(), [](const PhaseTime& p) { return p.phase == fit_phase; });
  ASSERT_NE(fits, phases.end());
  EXPECT_GT(sky.saved_seconds, 0.1 * fits->seconds);  // of the fits' time, not of another phase's
  const Decision& prefilter = decision(decided.report, "feature albedo prefilter");
  EXPECT_FALSE(prefilter.run);
  EXPECT_EQ(prefilter.reason, "the pass has no noise");
  EXPECT_GT(prefilter.saved_seconds, 0);
  EXPECT_EQ(decision(decided.report, "feature albedo").saved_seconds, 0);  // it runs
}

TEST(Steps, AConstantFeatureIsUsedOnlyWhereItIsRequested) {
  test::Scene scene = test::make_scene(48, 32, 0.1, 3);
  scene.frame.features[0].pass.mean = Image(48, 32, 3, Real(0));
  const Outcome decided = run(scene, true), all = run(scene, false);
  EXPECT_FALSE(decision(decided.report, "feature albedo").run);
  EXPECT_GT(decision(decided.report, "feature albedo").saved_seconds, 0);
  EXPECT_TRUE(decision(all.report, "feature albedo").run);
  EXPECT_TRUE(std::isfinite(all.relative_mse));
  EXPECT_NEAR(decided.relative_mse, all.relative_mse, 0.01 * all.relative_mse);
}

TEST(Steps, WhatIsNotAllowedDoesNotRun) {
  const test::Scene scene = test::make_scene(48, 32, 0.1, 3);
  Params params = params_for(Quality::Draft);
  params.steps.fireflies = params.steps.prefilter = false;
  params.steps.features.erase(Role::Normal);
  Frame frame = scene.frame;
  const Report report = reconstruct(frame, params, silent_progress()).report;
  for (const char* step : {"firefly removal", "feature normal", "feature albedo prefilter"}) {
    EXPECT_FALSE(decision(report, step).run) << step;
    EXPECT_EQ(decision(report, step).reason, "not requested") << step;
  }
}

}  // namespace
}  // namespace polyrecon
