#include "pipeline/memory.h"

#include <gtest/gtest.h>

#include "blend/levels.h"
#include "core/candidate.h"
#include "pipeline/stage.h"
#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"
#include "prior/prior_candidate.h"
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

HalfPair noisy_pair(int channels) {
  const auto value = [](int x, int y, int c) { return 1 + 0.01 * (x + y + c); };
  return test::pair_of(test::image_of(128, 96, channels, value), 0.3, 1);
}

/// Every part of the pipeline in little time.
Params small_windows() {
  Params params = test::quick();
  params.radius = params.stride = 3;
  params.max_order = 1;
  return params;
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
    const std::size_t inputs =
        half_pair_channels(static_cast<std::size_t>(colors), 0) + candidate_channels(static_cast<std::size_t>(colors));
    for (const bool guided : {true, false}) {
      Params params = small_windows();
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
  const Candidate coarse = make_candidate(64, 48, 3);
  Candidate fine;
  const double used = peak_of([&] {
    fine = make_candidate(pair.width(), pair.height(), 3);
    fine = add_coarse(pair, std::move(fine), coarse, SelectParams{}, unlimited);
  });
  // The result, its remainder and its corrected halves are held in addition to the tile.
  const std::size_t held = sizeof(Real) * 3 * 2 * 3;
  expect_stated((correction_bytes_per_pixel(3, 2) + held) * pair.variance.pixels(), used, 0.3);
}

/// Bytes that a reconstruction holds at most in addition to its frame, in tiles of the smallest size.
std::size_t peak_of_reconstruction(Frame frame, Params params) {
  params.max_memory = memory_needs(shape_of(frame), params).least();
  const test::PeakAllocation peak;
  reconstruct(frame, params, silent_progress());
  return peak.bytes();
}

/// A scene with noise in a single pixel, a firefly: images take the same memory, but hardly any window is fitted.
Frame nearly_noise_free_frame(int width, int height) {
  Frame frame = test::make_scene(width, height, 0, 26).frame;
  for (int c = 0; c < 3; ++c) {
    frame.beauty.half_a.at(20, 20, c) += 60;
    frame.beauty.mean.at(20, 20, c) += 30;
    frame.beauty.variance.at(20, 20, c) = 900;
  }
  for (Feature& feature : frame.features)
    feature.pass.variance = Image(width, height, feature.pass.mean.channels(), Real(1e-4));
  return frame;
}

TEST_F(StatedMemory, OfAReconstructionIsWhatItAllocates) {
  const Params params = small_windows();
  peak_of_reconstruction(nearly_noise_free_frame(80, 60), params);  // leaves the threads their windows and sums
  for (const int prior : {0, 1, 2}) {                               // none, without halves, with halves
    SCOPED_TRACE(prior);
    Frame frame = nearly_noise_free_frame(448, 384);
    if (prior > 0) frame.prior = {"Denoised", frame.beauty.mean, {}, {}, {}};
    if (prior > 1) frame.prior.half_a = frame.prior.half_b = frame.beauty.mean;
    const FrameShape shape = shape_of(frame);
    ASSERT_LT(smallest_tile_pixels(params), shape.pixels);
    const std::size_t passes = shape.pixels * static_cast<std::size_t>(shape.channels) * sizeof(Real);
    const auto used = static_cast<double>(passes + peak_of_reconstruction(std::move(frame), params));
    expect_stated(memory_needs(shape, params).least() - program_bytes, used, 0.3);
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

TEST(MemoryNeeds, CountsADenoiserAndItsLibrary) {
  FrameShape shape = usual;
  add_denoiser(shape);
  Params params;
  const MemoryNeeds needs = memory_needs(shape, params);
  EXPECT_EQ(memory_needs(usual, params).denoiser, 0u);
  EXPECT_GT(needs.denoiser, needs.least() / 2);
  params.max_memory = needs.denoiser + (std::size_t{100} << 20);
  EXPECT_GT(denoiser_memory(shape, params), std::size_t{400} << 20);
  params.max_memory = needs.denoiser / 4;
  EXPECT_EQ(denoiser_memory(shape, params), 0u);
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
