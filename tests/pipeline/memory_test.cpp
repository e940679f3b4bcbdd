#include "pipeline/memory.h"

#include <gtest/gtest.h>

#include "pipeline/stage.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

// Four feature passes and half buffers: beauty 4 x 3, features 4 x (3 + 3 + 1 + 1), sample count.
constexpr FrameShape usual{std::size_t{1920} * 1080, 45, 3, 8};
// The same with a denoised layer.
constexpr FrameShape with_prior{std::size_t{1920} * 1080, 48, 3, 8, 3};

// What lies unused between images of unequal sizes is counted too: 8 % of all.
std::size_t with_gaps(std::size_t bytes) { return static_cast<std::size_t>(1.08 * static_cast<double>(bytes)); }

TEST(MemoryNeeds, CountsTheImagesThatLiveAtOnce) {
  const Params params;
  const MemoryNeeds needs = memory_needs(usual, params);
  const std::size_t plane = usual.pixels * sizeof(Real), program = std::size_t{128} << 20;
  // Preparing: 45 read, 3 of noise, pair 2 x 3 + 3 + 2 x 8 = 25, 12 of the feature in work.
  EXPECT_EQ(needs.prepare, with_gaps(program + plane * 85));
  // Fitting: 5 + 3 kept; pair 25 and two results of 13, a third more for the coarser levels.
  EXPECT_EQ(needs.held, with_gaps(program + plane * 11 + plane * 51 * 4 / 3));
  EXPECT_EQ(needs.tile, with_gaps(smallest_tile_pixels(params) * stage_bytes_per_pixel(3, 8, params)));
}

TEST(MemoryNeeds, CountsAPriorToItsTurn) {
  const Params params;
  const MemoryNeeds needs = memory_needs(with_prior, params), without = memory_needs(usual, params);
  const double layer = 1.08 * 3 * static_cast<double>(with_prior.pixels * sizeof(Real));
  EXPECT_NEAR(static_cast<double>(needs.prepare), static_cast<double>(without.prepare) + layer, 2);
  EXPECT_NEAR(static_cast<double>(needs.held), static_cast<double>(without.held) + layer, 2);
  EXPECT_EQ(needs.tile, without.tile);
}

TEST(MemoryNeeds, AFrameSmallerThanATileNeedsNoWholeOne) {
  const Params params;
  EXPECT_EQ(memory_needs({100, 45, 3, 8}, params).tile, with_gaps(100 * stage_bytes_per_pixel(3, 8, params)));
}

TEST(RequireMemory, NamesTheLimitThatDoes) {
  Params params;
  params.max_memory = 200 << 20;
  try {
    require_memory("shot.exr", usual, params);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::OutOfMemory);
    const std::string text = error.what(), option = "--max-memory ";
    EXPECT_EQ(text.rfind("shot.exr: ", 0), 0u) << text;
    params.max_memory = std::stoul(text.substr(text.find(option) + option.size())) << 20;
  }
  EXPECT_NO_THROW(require_memory("shot.exr", usual, params));
  EXPECT_GT(tile_memory(usual, params), 0u);
  params.max_memory -= 2 << 20;
  EXPECT_THROW(require_memory("shot.exr", usual, params), Error);
}

}  // namespace
}  // namespace polyrecon
