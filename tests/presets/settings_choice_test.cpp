#include "presets/settings_choice.h"

#include <gtest/gtest.h>

#include <limits>

#include "denoisers/denoisers.h"
#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"
#include "support/oidn.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

/// Time doubles and error falls by a tenth from preset to preset.
std::array<PresetFigures, preset_count> even_figures() {
  std::array<PresetFigures, preset_count> figures;
  double seconds = 0.25, error = 1.5;
  for (PresetFigures& preset : figures) {
    preset = {seconds, error};
    seconds *= 2;
    error *= 0.9;
  }
  return figures;
}

/// The pilot that predicts so much of "draft", the second preset. It ran the third one itself.
Pilot draft_takes(double seconds, double relative_mse) { return {2 * seconds, 0.9 * relative_mse, 0.1, 0.1}; }

TEST(SettingsChoice, TakesTheMostAccuratePresetWithinTheSeconds) {
  const SettingsChoice choice =
      choose_settings(draft_takes(1, 0.01), {5, 0}, even_figures());  // seconds: .5 1 2 4 8 ...
  EXPECT_EQ(choice.chosen.name, presets()[3].name);
  EXPECT_DOUBLE_EQ(choice.chosen.seconds, 4);
  EXPECT_NEAR(choice.chosen.relative_mse, 0.01 * 0.9 * 0.9, 1e-15);
  EXPECT_TRUE(choice.met);
  ASSERT_TRUE(choice.next);
  EXPECT_EQ(choice.next->name, presets()[4].name);
  EXPECT_DOUBLE_EQ(choice.next->seconds, 8);
  EXPECT_EQ(choice.preset, 3u);
}

/// The third preset takes 2 s and its prior 4 s; the fourth takes 4 s and its prior 1 s, so that the third never pays.
TEST(SettingsChoice, CountsTheTimeOfThePrior) {
  Pilot pilot = draft_takes(1, 0.01);
  pilot.prior_seconds = {1, 1, 4, 1, 4, 4, 4, 4};
  const SettingsChoice choice = choose_settings(pilot, {5, 0}, even_figures());
  EXPECT_EQ(choice.chosen.name, presets()[3].name);
  EXPECT_DOUBLE_EQ(choice.chosen.seconds, 5);
  EXPECT_TRUE(choice.met);
  ASSERT_TRUE(choice.next);
  EXPECT_DOUBLE_EQ(choice.next->seconds, 12);
  const SettingsChoice sooner = choose_settings(pilot, {4.9, 0}, even_figures());
  EXPECT_EQ(sooner.chosen.name, presets()[1].name);
  EXPECT_EQ(sooner.next->name, presets()[3].name);
}

TEST(SettingsChoice, TakesTheFastestPresetThatReachesTheError) {
  const SettingsChoice choice =
      choose_settings(draft_takes(1, 0.01), {0, 0.0082}, even_figures());  // errors: .0111 .01 .009 .0081
  EXPECT_EQ(choice.chosen.name, presets()[3].name);
  EXPECT_TRUE(choice.met);
}

TEST(SettingsChoice, TheLimitOfTimeCountsMoreThanTheError) {
  const SettingsChoice choice = choose_settings(draft_takes(1, 0.01), {2.5, 0.0082}, even_figures());
  EXPECT_EQ(choice.chosen.name, presets()[2].name);
  EXPECT_FALSE(choice.met);
}

TEST(SettingsChoice, TakesTheClosestWhereNothingFits) {
  const SettingsChoice fastest = choose_settings(draft_takes(100, 0.01), {1, 0}, even_figures());
  EXPECT_EQ(fastest.chosen.name, presets().front().name);
  EXPECT_FALSE(fastest.met);
  const SettingsChoice best = choose_settings(draft_takes(1, 0.01), {0, 1e-9}, even_figures());
  EXPECT_EQ(best.chosen.name, presets().back().name);
  EXPECT_FALSE(best.met);
  EXPECT_FALSE(best.next);
}

TEST(SettingsChoice, LeavesOutPresetsThatAnotherOneBeats) {
  auto figures = even_figures();
  figures[3].error = 2;  // slower than preset 2, and worse
  const SettingsChoice choice = choose_settings(draft_takes(1, 0.01), {5, 0}, figures);
  EXPECT_EQ(choice.chosen.name, presets()[2].name);
  ASSERT_TRUE(choice.next);
  EXPECT_EQ(choice.next->name, presets()[4].name);
}

TEST(SettingsChoice, TheMeasuredFiguresRunFromFastToAccurate) {
  const auto& figures = measured_figures();
  const auto all = presets();
  for (std::size_t k = 0; k < preset_count; ++k) {
    EXPECT_GT(figures[k].seconds, 0) << all[k].name;
    EXPECT_GT(figures[k].error, 0) << all[k].name;
    if (all[k].name == "standard") {
      EXPECT_DOUBLE_EQ(figures[k].seconds, 1);
      EXPECT_DOUBLE_EQ(figures[k].error, 1);
    }
    EXPECT_NO_THROW(validate(all[k].params)) << all[k].name;
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
  const double whole = reconstruct(frame, presets()[2].params, silent_progress()).report.estimated_relative_mse;
  EXPECT_GT(pilot.relative_mse, whole / 2);
  EXPECT_LT(pilot.relative_mse, whole * 2);
}

/// Draft calls the denoiser for both halves, standard also twice for the mean and once for the features; the validation
/// takes as long as two pilots on the whole frame.
TEST(Pilot, TimesTheDenoiser) {
  SKIP_WITHOUT_OIDN();
  const auto oidn = make_oidn({});
  const Frame frame = test::make_scene(300, 280, 0.1, 3).frame;
  const Pilot without = run_pilot(frame, silent_progress()), with = run_pilot(frame, silent_progress(), oidn.get());
  const auto all = presets();
  for (std::size_t k = 0; k < preset_count; ++k) {
    EXPECT_EQ(without.prior_seconds[k], 0) << all[k].name;
    EXPECT_GT(with.prior_seconds[k], 2 * with.seconds) << all[k].name;
  }
  EXPECT_GT(with.prior_seconds[4], with.prior_seconds[1]);
  EXPECT_GT(with.prior_seconds[7], with.prior_seconds[4]);
  EXPECT_GT(with.spent, without.spent);
  EXPECT_DOUBLE_EQ(with.relative_mse, without.relative_mse);
}

TEST(Pilot, SkipsTilesWithoutAUsablePixel) {
  Frame frame = test::make_scene(128, 64, 0.1, 3).frame;  // two tiles
  constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
  for (Image* image : {&frame.beauty.mean, &frame.beauty.half_a, &frame.beauty.half_b})
    paste(Image(64, 64, 3, nan), {0, 0, 64, 64}, *image, 0, 0);
  EXPECT_DOUBLE_EQ(run_pilot(frame, silent_progress()).share, 0.5);
  paste(Image(64, 64, 3, nan), {0, 0, 64, 64}, frame.beauty.mean, 64, 0);
  EXPECT_THROW(run_pilot(frame, silent_progress()), Error);
}

TEST(Pilot, WorksOnFramesSmallerThanATile) {
  EXPECT_DOUBLE_EQ(run_pilot(test::make_scene(20, 9, 0.1, 3).frame, silent_progress()).share, 1);
  EXPECT_GT(run_pilot(test::make_scene(200, 9, 0.1, 3).frame, silent_progress()).relative_mse,
            0);  // nothing but low tiles
}

}  // namespace
}  // namespace polyrecon
