#include "polyrecon/params.h"

#include <gtest/gtest.h>

#include "blend/blend_windows.h"
#include "pipeline/stage.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

TEST(Params, EveryQualityIsValid) {
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::Best})
    EXPECT_NO_THROW(validate(params_for(quality)));
}

TEST(Params, OnlyAFirstStageThatOthersFollowTakesFewerWindows) {
  Params params;
  const FitParams later = fit_params(params, params.first_bandwidths);
  EXPECT_GT(first_fit_params(params).stride, later.stride);
  EXPECT_LT(first_fit_params(params).coverage, later.coverage);
  params.stride = params.radius;
  EXPECT_EQ(first_fit_params(params).stride, params.radius);  // or there would be pixels in no window
  params.stages = 1;
  EXPECT_EQ(first_fit_params(params).coverage, later.coverage);
}

TEST(Params, ValuesOutOfRangeAreErrorsOfUse) {
  void (*const spoil[])(Params&) = {
      [](Params& p) { p.stages = 0; },
      [](Params& p) { p.stages = 5; },
      [](Params& p) { p.levels = 0; },
      [](Params& p) { p.levels = 6; },
      [](Params& p) { p.radius = 0; },
      [](Params& p) { p.radius = 21; },
      [](Params& p) { p.stride = 0; },
      [](Params& p) { p.stride = 10; },
      [](Params& p) { p.patch.radius = -1; },
      [](Params& p) { p.patch.radius = 5; },
      [](Params& p) { p.estimated_patch.radius = 5; },
      [](Params& p) { p.max_order = -1; },
      [](Params& p) { p.max_order = 5; },
      [](Params& p) { p.outliers.neighbourhood = 0; },
      [](Params& p) { p.outliers.neighbourhood = 11; },
      [](Params& p) { p.outliers.density_radius = 0; },
      [](Params& p) { p.first_bandwidths.clear(); },
      [](Params& p) { p.later_bandwidths.clear(); },
      [](Params& p) { p.guided_bandwidths = {Real(0)}; },
      [](Params& p) {
        p.guided_bandwidths = {Real(1), Real(0.5)};
      },
  };
  for (std::size_t k = 0; k < std::size(spoil); ++k) {
    Params params;
    params.radius = 9;
    spoil[k](params);
    try {
      validate(params);
      FAIL() << k;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::Usage);
    }
  }
}

}  // namespace
}  // namespace polyrecon
