#include "temporal/neighbour.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/color_layout.h"
#include "polyrecon/params.h"
#include "polyrecon/reconstruct.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

std::size_t channels_of(const Neighbour& n) {
  int channels = n.pair.variance.channels() + n.geometry.motion.channels();
  for (std::size_t h = 0; h < 2; ++h) channels += n.pair.color[h].channels() + n.pair.features[h].channels();
  for (const Image& surface : n.geometry.surface) channels += surface.channels();
  return static_cast<std::size_t>(channels);
}

TEST(Neighbour, HoldsTheChannelsThatTheMemoryCounts) {
  Frame frame = test::make_scene(48, 32, 0.3, 1).frame;
  frame.motion = Image(48, 32, 4);
  const auto neighbour = prepare_neighbour(frame, 1, Params(), silent_progress());
  constexpr std::size_t mask = 1;   // of void pixels, which this frame does not have
  constexpr std::size_t bound = 1;  // which a neighbour, that is not fitted, does without
  EXPECT_EQ(channels_of(*neighbour) + mask + bound, neighbour_channels(3));
}

/// The farm's model of memory counts a further colour layer of a neighbour as the program does.
TEST(Neighbour, AnAovHasTheBytesOfTheFarmsModel) {
  std::ifstream file(POLYRECON_SOURCE_DIR "/pipelines/farm/model.json");
  const auto model = nlohmann::json::parse(file);
  const auto channels = [](int aovs) {
    return neighbour_channels(static_cast<std::size_t>(ColorLayout(aovs, false).channels()));
  };
  EXPECT_EQ(model["neighbour"]["bytes_per_aov"].get<double>(),
            static_cast<double>((channels(1) - channels(0)) * sizeof(Real)));
}

}  // namespace
}  // namespace polyrecon
