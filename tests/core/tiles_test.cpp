#include "core/tiles.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/rect.h"

namespace polyrecon {
namespace {

TEST(Inside, IsTheCoreSeenFromThePaddedPart) {
  EXPECT_EQ(inside({{8, 16, 24, 20}, {5, 16, 27, 21}}), (Rect{3, 0, 19, 4}));
}

TEST(MakeTiles, CoverEachPixelOnceWithAlignedPaddingOfAtLeastTheHalo) {
  struct Case {
    int width, height, halo, alignment;
    std::size_t max_pixels;
  };
  for (const Case& k : {Case{100, 70, 5, 8, 1000}, Case{8, 8, 3, 8, 10}, Case{9, 17, 20, 8, 100},
                        Case{257, 129, 46, 128, 1}, Case{1, 300, 2, 4, 64}, Case{64, 64, 2, 4, 4095}}) {
    const Rect bounds{0, 0, k.width, k.height};
    std::vector<int> covered(bounds.area(), 0);
    for (const Tile& tile : make_tiles(bounds, k.halo, k.alignment, k.max_pixels)) {
      ASSERT_FALSE(tile.core.empty());
      EXPECT_EQ(tile.padded.x0 % k.alignment, 0);
      EXPECT_EQ(tile.padded.y0 % k.alignment, 0);
      // The padded area extends by the halo on every side, or to the border of the image.
      EXPECT_EQ(intersect(grow(tile.core, k.halo), bounds),
                intersect(intersect(grow(tile.core, k.halo), bounds), tile.padded));
      EXPECT_EQ(intersect(tile.padded, bounds), tile.padded);
      for (int y = tile.core.y0; y < tile.core.y1; ++y)
        for (int x = tile.core.x0; x < tile.core.x1; ++x) ++covered[static_cast<std::size_t>(y * k.width + x)];
    }
    for (const int count : covered) ASSERT_EQ(count, 1);
  }
}

TEST(MakeTiles, OneTileWhereEverythingFits) {
  const auto tiles = make_tiles({0, 0, 64, 64}, 2, 4, 4096);
  ASSERT_EQ(tiles.size(), 1u);
  EXPECT_EQ(tiles[0].core, (Rect{0, 0, 64, 64}));
  EXPECT_EQ(tiles[0].padded, (Rect{0, 0, 64, 64}));
}

TEST(MakeTiles, StayWithinTheBudgetWherePossible) {
  // Margin 8 (halo 5 rounded up to the alignment): side 31 leaves a core of 8 and a padded area of 24 x 24.
  for (const Tile& tile : make_tiles({0, 0, 200, 200}, 5, 8, 1000)) EXPECT_LE(tile.padded.area(), 1000u);
}

}  // namespace
}  // namespace polyrecon
