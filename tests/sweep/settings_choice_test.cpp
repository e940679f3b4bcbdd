#include "sweep/settings_choice.h"

#include <gtest/gtest.h>

#include "polyrecon/reconstruct.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

/// Time doubles and error falls by a tenth from step to step; "draft" is the second one.
std::array<StepFigures, step_count> even_figures() {
  std::array<StepFigures, step_count> figures;
  double seconds = 0.25, error = 1.5;
  for (StepFigures& step : figures) {
    step = {seconds, error};
    seconds *= 2;
    error *= 0.9;
  }
  return figures;
}

/// The pilot is made by the third step.
Pilot draft_takes(double seconds, double relative_mse) { return {2 * seconds, 0.9 * relative_mse, 0.1, 0.1}; }

TEST(Plan, TakesTheMostAccurateStepWithinTheSeconds) {
  const Plan plan = make_plan(draft_takes(1, 0.01), {5, 0}, even_figures());  // steps: .5 1 2 4 8 ...
  EXPECT_EQ(plan.step.name, ladder()[3].name);
  EXPECT_DOUBLE_EQ(plan.step.seconds, 4);
  EXPECT_NEAR(plan.step.relative_mse, 0.01 * 0.9 * 0.9, 1e-15);
  EXPECT_TRUE(plan.met);
  ASSERT_TRUE(plan.next);
  EXPECT_EQ(plan.next->name, ladder()[4].name);
  EXPECT_DOUBLE_EQ(plan.next->seconds, 8);
  EXPECT_EQ(plan.params.stages, ladder()[3].params.stages);
}

TEST(Plan, TakesTheCheapestStepThatReachesTheError) {
  const Plan plan = make_plan(draft_takes(1, 0.01), {0, 0.0082}, even_figures());  // .0111 .01 .009 .0081
  EXPECT_EQ(plan.step.name, ladder()[3].name);
  EXPECT_TRUE(plan.met);
}

TEST(Plan, SecondsBoundWhatAnErrorAsksFor) {
  const Plan plan = make_plan(draft_takes(1, 0.01), {2.5, 0.0082}, even_figures());
  EXPECT_EQ(plan.step.name, ladder()[2].name);
  EXPECT_FALSE(plan.met);
}

TEST(Plan, DoesWhatItCanWhereNothingFits) {
  const Plan fastest = make_plan(draft_takes(100, 0.01), {1, 0}, even_figures());
  EXPECT_EQ(fastest.step.name, ladder().front().name);
  EXPECT_FALSE(fastest.met);
  const Plan best = make_plan(draft_takes(1, 0.01), {0, 1e-9}, even_figures());
  EXPECT_EQ(best.step.name, ladder().back().name);
  EXPECT_FALSE(best.met);
  EXPECT_FALSE(best.next);
}

TEST(Plan, LeavesOutStepsThatAnotherOneBeats) {
  auto figures = even_figures();
  figures[3].error = 2;  // dearer than step 2, and worse
  const Plan plan = make_plan(draft_takes(1, 0.01), {5, 0}, figures);
  EXPECT_EQ(plan.step.name, ladder()[2].name);
  ASSERT_TRUE(plan.next);
  EXPECT_EQ(plan.next->name, ladder()[4].name);
}

TEST(Plan, TheMeasuredStepsAreALadder) {
  const auto& figures = measured_steps();
  const auto steps = ladder();
  for (std::size_t k = 0; k < step_count; ++k) {
    EXPECT_GT(figures[k].seconds, 0) << steps[k].name;
    EXPECT_GT(figures[k].error, 0) << steps[k].name;
    if (steps[k].name == "standard") {
      EXPECT_DOUBLE_EQ(figures[k].seconds, 1);
      EXPECT_DOUBLE_EQ(figures[k].error, 1);
    }
    EXPECT_NO_THROW(validate(steps[k].params)) << steps[k].name;
  }
  EXPECT_LT(figures.front().seconds, figures.back().seconds);
  EXPECT_GT(figures.front().error, figures.back().error);
}

TEST(Pilot, SeesAPartOfTheFrameAndTheWholeOfItsError) {
  Frame frame = test::make_scene(384, 256, 0.1, 3).frame;  // 24 tiles
  const Pilot pilot = run_pilot(frame, silent_progress());
  EXPECT_GT(pilot.share, 0.1);
  EXPECT_LT(pilot.share, 0.9);
  EXPECT_GT(pilot.seconds, 0);
  EXPECT_GT(pilot.spent, 0);
  const double whole = reconstruct(frame, ladder()[2].params, silent_progress()).report.estimated_relative_mse;
  EXPECT_GT(pilot.relative_mse, whole / 2);
  EXPECT_LT(pilot.relative_mse, whole * 2);
}

TEST(Pilot, WorksOnFramesSmallerThanATile) {
  EXPECT_DOUBLE_EQ(run_pilot(test::make_scene(20, 9, 0.1, 3).frame, silent_progress()).share, 1);
  EXPECT_GT(run_pilot(test::make_scene(200, 9, 0.1, 3).frame, silent_progress()).relative_mse,
            0);  // nothing but low tiles
}

}  // namespace
}  // namespace polyrecon
