#include "core/color_layout.h"

#include <gtest/gtest.h>

namespace polyrecon {
namespace {

TEST(ColorLayout, PutsBeautyAovsAndAlphaOneAfterAnother) {
  const ColorLayout layout(2, true);
  EXPECT_EQ(layout.layers(), 3);
  EXPECT_EQ(layout.layer_channels(), 9);
  EXPECT_EQ(layout.alpha_channel(), 9);
  EXPECT_EQ(layout.channels(), 10);
  EXPECT_EQ(ColorLayout::first_channel(2), 6);
  EXPECT_EQ(ColorLayout::channel(1, 2), 5);
  for (int layer = 0; layer < layout.layers(); ++layer)
    for (int primary = 0; primary < 3; ++primary)
      EXPECT_EQ(ColorLayout::beauty_channel(ColorLayout::channel(layer, primary)), primary);
}

TEST(ColorLayout, IsKnownFromTheNumberOfChannels) {
  for (int aovs = 0; aovs < 4; ++aovs)
    for (const bool alpha : {false, true}) {
      const ColorLayout layout(ColorLayout(aovs, alpha).channels());
      EXPECT_EQ(layout.layers(), 1 + aovs);
      EXPECT_EQ(layout.has_alpha(), alpha);
    }
}

}  // namespace
}  // namespace polyrecon
