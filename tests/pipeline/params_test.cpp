#include "pipeline/params.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace polyrecon {
namespace {

TEST(Params, EveryQualityIsValid) {
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::Best})
    EXPECT_NO_THROW(validate(params_for(quality)));
}

TEST(Params, OnlyAFirstStageThatOthersFollowTakesFewerWindows) {
  Params params;
  const FitParams later = params.fit(params.first_bandwidths);
  EXPECT_GT(params.first_fit().stride, later.stride);
  EXPECT_LT(params.first_fit().coverage, later.coverage);
  params.stride = params.radius;
  EXPECT_EQ(params.first_fit().stride, params.radius);  // or pixels between the windows would be in none
  params.stages = 1;
  EXPECT_EQ(params.first_fit().coverage, later.coverage);
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
