#include "pipeline/memory.h"

#include <gtest/gtest.h>

#include "blend/levels.h"
#include "blend/prior.h"
#include "core/candidate.h"
#include "pipeline/stage.h"
#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"
#include "support/allocations.h"
#include "support/reconstruction.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

constexpr std::size_t unlimited = std::size_t{1} << 40;

/// Bytes that the second of two equal runs holds at most: the first leaves the threads their windows and sums, which
/// count as program_bytes.
template <typename Work>
double peak_of(const Work& work) {
  work();
  const test::PeakAllocation peak;
  work();
  return static_cast<double>(peak.bytes());
}

/// What is stated must be enough, and not more than `slack` above what is needed.
void expect_stated(std::size_t stated, double used, double slack) {
  EXPECT_LE(used, 1.01 * static_cast<double>(stated));  // vectors of tiles, centres and the like
  EXPECT_GE(used, (1 - slack) * static_cast<double>(stated));
}

/// A pair without features: what is stated for them is checked by RequireMemory, on a whole frame.
HalfPair noisy_pair(int channels) {
  return test::pair_of(test::image_of(192, 160, channels, [](int x, int y, int c) { return 1 + 0.01 * (x + y + c); }),
                       0.3, 1);
}

class StatedMemory : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::counts_allocations()) GTEST_SKIP() << "allocations are not counted";
  }
};

TEST_F(StatedMemory, OfAStageIsWhatItAllocates) {
  for (const int colors : {3, 6}) {
    const HalfPair pair = noisy_pair(colors);
    const std::size_t pixels = pair.variance.pixels();
    // A single tile is not copied: the pair and the stage before are the caller's.
    const std::size_t inputs = half_pair_channels(static_cast<std::size_t>(colors), 0) +
                               candidate_channels(static_cast<std::size_t>(colors));
    for (const bool guided : {true, false}) {
      Params params = test::quick();
      if (!guided) {
        params.guided_bandwidths.clear();
        params.later_bandwidths = {Real(0.3), Real(0.5), Real(0.7), Real(1)};
      }
      const Candidate before = make_candidate(pair.width(), pair.height(), colors);
      const double used = peak_of([&] {
        FitCounters counters;
        run_stage(pair, &before, params, unlimited, counters, silent_progress());
      });
      const std::size_t stated = stage_bytes_per_pixel(colors, 0, params) - sizeof(Real) * inputs;
      expect_stated(stated * pixels, used, 0.1);
    }
  }
}

TEST_F(StatedMemory, OfACorrectionIsWhatItAllocates) {
  const HalfPair pair = noisy_pair(3);
  const std::size_t pixels = pair.variance.pixels();
  const Candidate fine = make_candidate(pair.width(), pair.height(), 3), coarse = make_candidate(96, 80, 3);
  // The halves of the result, their remainder and the corrected halves stand beside the tile.
  const std::size_t halves = 3 * 2 * 3 * sizeof(Real);
  const double coarser =
      peak_of([&] { add_coarse(pair, fine, coarse, SelectParams{}, unlimited); }) - candidate_channels(3) * pixels * 4.0;
  std::printf("coarse used %f stated %zu halves %zu\n", coarser / pixels, correction_bytes_per_pixel(3, 2), halves);
  expect_stated((correction_bytes_per_pixel(3, 2) + halves) * pixels, coarser, 0.3);
}

TEST_F(StatedMemory, OfAReconstructionIsWhatItAllocates) {
  Params params = test::quick();
  params.stages = 1;
  params.max_order = 1;
  params.stride = 5;
  for (const bool prior : {false, true})
    for (const bool noisy_features : {false, true}) {
      test::Scene scene = test::make_scene(520, 400, 0.3, 26);
      if (prior) scene.frame.prior = {"Denoised", scene.truth, {}, {}, {}};
      if (noisy_features)
        for (Feature& feature : scene.frame.features)
          feature.pass.variance = Image(520, 400, feature.pass.mean.channels(), Real(0.01));
      const FrameShape shape = shape_of(scene.frame);
      const MemoryNeeds needs = memory_needs(shape, params);
      params.max_memory = needs.least();
      ASSERT_LT(smallest_tile_pixels(params), shape.pixels);
      Frame taken = scene.frame;
      test::run(test::make_scene(80, 60, 0.3, 1).frame, params);  // leaves the threads their windows and sums
      const std::size_t frame = shape.pixels * static_cast<std::size_t>(shape.channels) * sizeof(Real);
      const test::PeakAllocation peak;
      reconstruct(taken, params, silent_progress());
      std::printf("prior %d noisy %d: used %.1f frame %.1f stated: prepare %.1f held+tile %.1f (channels)\n", prior, noisy_features, peak.bytes() / 4.0 / shape.pixels, frame/4.0/shape.pixels, (needs.prepare/1.08 - program_bytes)/4.0/shape.pixels, ((needs.held+needs.tile)/1.08 - program_bytes)/4.0/shape.pixels);
      expect_stated(needs.least() - program_bytes, static_cast<double>(peak.bytes() + frame), 0.4);
    }
}

// Four feature passes and half buffers: beauty 4 x 3, features 4 x (3 + 3 + 1 + 1), sample count.
constexpr FrameShape usual{std::size_t{1920} * 1080, 45, 3, 8};

TEST(MemoryNeeds, CountsAPriorToItsTurn) {
  FrameShape with_prior = usual;
  with_prior.channels += 3;
  with_prior.prior_channels = 3;
  const Params params;
  const MemoryNeeds needs = memory_needs(with_prior, params), without = memory_needs(usual, params);
  const double layer = 1.08 * 3 * static_cast<double>(with_prior.pixels * sizeof(Real));
  EXPECT_NEAR(static_cast<double>(needs.prepare), static_cast<double>(without.prepare) + layer, 2);
  EXPECT_NEAR(static_cast<double>(needs.held), static_cast<double>(without.held) + layer, 2);
  EXPECT_EQ(needs.tile, without.tile);
}

TEST(MemoryNeeds, AFrameSmallerThanATileNeedsNoWholeOne) {
  const Params params;
  EXPECT_EQ(memory_needs({100, 45, 3, 8}, params).tile,
            static_cast<std::size_t>(1.08 * static_cast<double>(100 * stage_bytes_per_pixel(3, 8, params))));
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
