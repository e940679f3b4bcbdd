#include "polyrecon/image.h"

#include <gtest/gtest.h>

#include "core/rect.h"
#include "support/images.h"

namespace polyrecon {
namespace {

using test::image_of;

Image numbered(int width, int height, int channels) {
  return image_of(width, height, channels, [](int x, int y, int c) { return 100 * c + 10 * y + x; });
}

TEST(Image, PlanesFollowEachOtherRowByRow) {
  const Image image = numbered(4, 3, 2);
  EXPECT_EQ(image.plane(0)[image.index(3, 2)], Real(23));
  EXPECT_EQ(image.plane(1) - image.plane(0), 12);
  EXPECT_EQ(image.row(1, 2)[0], Real(120));
}

TEST(Image, CropTakesTheRectangleOfEveryChannel) {
  const Image part = crop(numbered(5, 4, 2), {1, 2, 4, 4});
  ASSERT_TRUE(part.same_shape(Image(3, 2, 2)));
  EXPECT_EQ(part.at(0, 0, 0), Real(21));
  EXPECT_EQ(part.at(2, 1, 1), Real(133));
}

TEST(Image, CropTakesSomeChannels) {
  const Image part = crop(numbered(5, 4, 4), {1, 2, 4, 4}, 1, 2);
  ASSERT_TRUE(part.same_shape(Image(3, 2, 2)));
  EXPECT_EQ(part.at(0, 0, 0), Real(121));
  EXPECT_EQ(part.at(2, 1, 1), Real(233));
}

TEST(Image, CropOfAnEmptyImageIsEmpty) { EXPECT_TRUE(crop(Image(), {0, 0, 3, 3}).empty()); }

TEST(Image, CropsPastedBackMakeTheImage) {
  const Image image = numbered(5, 4, 3);
  Image out(5, 4, 3, Real(-1));
  for (const Rect& r : aligned_blocks(image.bounds(), 3)) {
    const Image part = crop(image, r);
    paste(part, part.bounds(), out, r.x0, r.y0);
  }
  EXPECT_TRUE(test::same_bits(out, image));
}

TEST(Image, PasteTouchesNothingElse) {
  Image out(4, 4, 1, Real(7));
  paste(Image(2, 2, 1, Real(1)), {0, 0, 2, 1}, out, 1, 3);
  EXPECT_EQ(test::sum_of(out, 0), 14 * 7 + 2);
  EXPECT_EQ(out.at(1, 3, 0), Real(1));
  EXPECT_EQ(out.at(2, 3, 0), Real(1));
}

}  // namespace
}  // namespace polyrecon
