#include "core/fast_math.h"

#include <gtest/gtest.h>

#include <cmath>

namespace polyrecon {
namespace {

TEST(ExpMinus, StaysWithinThreeInTenMillionOfTheExponential) {
  double worst = 0;
  for (int i = 0; i <= 800000; ++i) {
    const float x = static_cast<float>(i) * 1e-4f;
    const double exact = std::exp(-static_cast<double>(x));
    worst = std::max(worst, std::abs(static_cast<double>(exp_minus(x)) - exact) / exact);
  }
  EXPECT_LT(worst, 3e-7);
  EXPECT_EQ(exp_minus(0.0f), 1.0f);
}

}  // namespace
}  // namespace polyrecon
