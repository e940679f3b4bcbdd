#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "polyrecon/reconstruct.h"
#include "support/images.h"
#include "support/reconstruction.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

using ::testing::HasSubstr;

std::string reason_of_prior(const Result& result) {
  for (const Decision& decision : result.report.decisions)
    if (decision.step == "prior") return decision.reason;
  return "";
}

/// Swapped, each half agrees with the samples that validate it, so that the noise would seem to be right.
TEST(UsePrior, HalvesThatAreSwappedValidateNothing) {
  const test::Scene scene = test::make_scene(96, 72, 0.4, 7);
  const Result without = test::run(scene.frame);
  Frame frame = scene.frame;
  frame.prior = frame.beauty;
  std::swap(frame.prior.half_a, frame.prior.half_b);
  const Result result = test::run(frame);
  EXPECT_TRUE(test::same_bits(result.beauty, without.beauty));
  EXPECT_THAT(reason_of_prior(result), HasSubstr("not those of this render"));
}

}  // namespace
}  // namespace polyrecon
