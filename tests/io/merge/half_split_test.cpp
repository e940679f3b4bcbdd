#include "io/merge/half_split.h"

#include <gtest/gtest.h>

namespace polyrecon {
namespace {

using Halves = std::vector<bool>;

TEST(SplitRenders, RendersOfSimilarLengthAlternate) {
  EXPECT_EQ(split_renders({8, 8}), Halves({false, true}));
  EXPECT_EQ(split_renders({8, 9, 10, 8}), Halves({false, true, false, true}));
}

TEST(SplitRenders, ALongRenderIsBalancedByTheShortOnes) {
  EXPECT_EQ(split_renders({1, 1, 1, 1, 4}), Halves({true, true, true, true, false}));
  EXPECT_EQ(split_renders({2, 16, 8, 2, 4}), Halves({true, false, true, true, true}));
}

TEST(SplitRenders, EachHalfHasARender) {
  EXPECT_EQ(split_renders({4, 64}), Halves({false, true}));
  EXPECT_EQ(split_renders({8, 8, 8}), Halves({false, true, false}));
  EXPECT_EQ(split_renders({0, 0}), Halves({false, true}));
}

}  // namespace
}  // namespace polyrecon
