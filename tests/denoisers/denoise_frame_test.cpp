#include "denoisers/denoise_frame.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/images.h"

namespace polyrecon {
namespace {

using test::image_of;

constexpr int width = 8, height = 6;

/// Moves a picture by a pixel to the right, so that it shows which way up it was given; adds the albedo.
class Shifting final : public Denoiser {
 public:
  std::string name() const override { return "shifting"; }
  DenoiserFeatures prefilter(DenoiserFeatures noisy, std::size_t, Progress&) const override {
    ++prefiltered;
    return noisy;
  }
  Image denoise(const Image& noisy, const DenoiserFeatures& features, std::size_t, Progress&) const override {
    ++denoised;
    return image_of(noisy.width(), noisy.height(), 3, [&](int x, int y, int c) {
      return static_cast<double>(x > 0 ? noisy.at(x - 1, y, c) : 0) + static_cast<double>(features.albedo.at(x, y, c));
    });
  }
  mutable int prefiltered = 0, denoised = 0;
};

DenoiserInput input(bool independent) {
  const auto column = [](int x, int, int) { return x; };
  DenoiserInput out;
  out.halves = {image_of(width, height, 3, column), image_of(width, height, 3, column)};
  for (int y = 0; y < height; ++y) out.halves[1].at(3, y, 1) += 10;
  out.independent_halves = independent;
  out.features.albedo = image_of(width, height, 3, [](int x, int, int) { return 100 * x; });
  return out;
}

TEST(DenoiseFrame, AHalfIsMadeOfItselfAndTurnedBack) {
  const Shifting denoiser;
  const Pass pass = denoise_frame(denoiser, input(true), {0, true}, 0, silent_progress());
  EXPECT_EQ(pass.name, "shifting");
  // A goes in turned left to right, so it moves to the left; B goes in upside down and moves to the right.
  EXPECT_EQ(pass.half_a.at(3, 2, 1), 4 + 300);
  EXPECT_EQ(pass.half_b.at(4, 2, 1), 3 + 10 + 400);
  EXPECT_EQ(pass.half_a.at(3, 2, 0), pass.half_a.at(3, 2, 1)) << "B must not be seen in A";
  EXPECT_EQ(pass.mean.at(4, 2, 1), (5 + 3 + 10) / 2.0 + 400);
  EXPECT_EQ(denoiser.prefiltered, 1);
  EXPECT_EQ(denoiser.denoised, 2);
}

TEST(DenoiseFrame, TheMeanIsThatOfItsTurns) {
  const Shifting denoiser;
  const Pass pass = denoise_frame(denoiser, input(true), {2, true}, 0, silent_progress());
  EXPECT_EQ(pass.mean.at(3, 2, 0), (2 + 4) / 2.0 + 300);  // as it is, and turned both ways
  EXPECT_EQ(denoiser.denoised, 4);
}

TEST(DenoiseFrame, HalvesOfOnePictureAreNotDenoised) {
  const Shifting denoiser;
  const Pass pass = denoise_frame(denoiser, input(false), {0, true}, 0, silent_progress());
  EXPECT_FALSE(pass.has_halves());
  EXPECT_EQ(pass.mean.at(4, 2, 1), 3 + 5 + 400);
  EXPECT_EQ(denoiser.denoised, 1);
}

TEST(DenoiseFrame, CleanFeaturesStayAsTheyAre) {
  const Shifting denoiser;
  DenoiserInput noise_free = input(true);
  noise_free.noise_free_features = true;
  denoise_frame(denoiser, noise_free, {1, false}, 0, silent_progress());
  EXPECT_EQ(denoiser.prefiltered, 0);
  EXPECT_EQ(denoiser_calls(true, true, {1, false}), 3);
  EXPECT_EQ(denoiser_calls(true, false, {1, true}), 4);
  EXPECT_EQ(denoiser_calls(false, false, {0, true}), 2);
}

}  // namespace
}  // namespace polyrecon
