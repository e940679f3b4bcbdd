#include "core/rect.h"

#include <gtest/gtest.h>

namespace polyrecon {
namespace {

TEST(AlignedBlocks, CoverNegativeOriginsOnceAndOnTheSameGrid) {
  // x: [-5, 3) on a grid of 4 gives [-5, -4) [-4, 0) [0, 3); y: [1, 6) gives [1, 4) [4, 6).
  const auto blocks = aligned_blocks({-5, 1, 3, 6}, 4);
  ASSERT_EQ(blocks.size(), 6u);
  EXPECT_EQ(blocks[0], (Rect{-5, 1, -4, 4}));
  EXPECT_EQ(blocks[1], (Rect{-4, 1, 0, 4}));
  EXPECT_EQ(blocks[5], (Rect{0, 4, 3, 6}));
  std::size_t area = 0;
  for (const Rect& b : blocks) area += b.area();
  EXPECT_EQ(area, 8u * 5u);
}

TEST(AlignedBlocks, AnEmptyAreaHasNone) { EXPECT_TRUE(aligned_blocks({3, 3, 3, 9}, 4).empty()); }

}  // namespace
}  // namespace polyrecon
