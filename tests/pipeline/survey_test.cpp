#include "pipeline/survey.h"

#include <gtest/gtest.h>

#include <limits>

#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

TEST(Survey, DecidesAsTheReconstructionDoes) {
  Frame frame = test::make_scene(48, 32, 0.1, 1).frame, same = frame;
  const Survey survey = survey_frame(frame, Steps(), silent_progress());
  const Report report = reconstruct(same, Params(), silent_progress()).report;
  EXPECT_EQ(survey.noise.source, report.variance_source);
  ASSERT_FALSE(survey.preparation.decisions.empty());
  ASSERT_GE(report.decisions.size(), survey.preparation.decisions.size());
  for (std::size_t k = 0; k < survey.preparation.decisions.size(); ++k) {
    EXPECT_EQ(survey.preparation.decisions[k].step, report.decisions[k].step);
    EXPECT_EQ(survey.preparation.decisions[k].run, report.decisions[k].run);
    EXPECT_EQ(survey.preparation.decisions[k].reason, report.decisions[k].reason);
  }
}

TEST(Survey, EstimatesTheNoiseOfFeaturesForThePrefilterAlone) {
  const Frame frame = test::make_scene(48, 32, 0.1, 1).frame;
  const auto has_estimate = [&](bool prefilter) {
    Frame taken = frame;
    for (Feature& feature : taken.features) feature.pass.variance = feature.pass.half_a = feature.pass.half_b = Image();
    Steps steps;
    steps.prefilter = prefilter;
    survey_frame(taken, steps, silent_progress());
    for (const Feature& feature : taken.features)
      if (feature.pass.variance_is_estimated) return true;
    return false;
  };
  EXPECT_TRUE(has_estimate(true));
  EXPECT_FALSE(has_estimate(false));
}

TEST(Survey, SaysThatTheNoiseAtEdgesNeedsTheSampleCount) {
  const auto says_so = [](Frame frame) {
    const Survey survey = survey_frame(frame, Steps(), silent_progress());
    for (const Decision& decision : survey.preparation.decisions)
      if (decision.step == "noise at edges") return !decision.run;
    return false;
  };
  Frame frame = test::make_scene(48, 32, 0.1, 1).frame;
  EXPECT_FALSE(says_so(frame)) << "its noise is measured";
  frame.beauty.variance = frame.beauty.half_a = frame.beauty.half_b = Image();
  frame.sample_count = Image();
  EXPECT_TRUE(says_so(frame));
  frame.sample_count = Image(48, 32, 1, Real(16));
  EXPECT_FALSE(says_so(frame));
}

TEST(Survey, RefusesAFrameWithoutAUsablePixel) {
  Frame frame = test::make_scene(16, 16, 0.1, 1).frame;
  frame.beauty.mean = Image(16, 16, 3, std::numeric_limits<Real>::quiet_NaN());
  try {
    survey_frame(frame, Steps(), silent_progress());
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::CheckFailed);
  }
}

}  // namespace
}  // namespace polyrecon
