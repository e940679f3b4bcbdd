#include "support/oidn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "denoisers/denoisers.h"
#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"
#include "support/images.h"
#include "support/scene.h"

namespace polyrecon {
namespace {

using test::image_of;
using ::testing::HasSubstr;

constexpr std::size_t plenty = std::size_t{2} << 30;

/// Mean squared difference over all channels.
double mse(const Image& a, const Image& b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < a.pixels(); ++i) {
      const double d = static_cast<double>(a.plane(c)[i]) - static_cast<double>(b.plane(c)[i]);
      sum += d * d;
    }
  return sum / (3 * static_cast<double>(a.pixels()));
}

TEST(Oidn, RemovesTheNoiseOfASceneOfKnownTruth) {
  SKIP_WITHOUT_OIDN();
  const auto denoiser = make_oidn({});
  const test::Scene scene = test::make_scene(160, 120, 0.3, 5);
  const DenoiserFeatures features = denoiser->prefilter(
      {scene.frame.features[0].pass.mean, scene.frame.features[1].pass.mean}, plenty, silent_progress());
  const Image out = denoiser->denoise(scene.frame.beauty.mean, features, plenty, silent_progress());
  EXPECT_LT(mse(out, scene.truth), 0.05 * mse(scene.frame.beauty.mean, scene.truth));
  EXPECT_LT(mse(features.albedo, scene.frame.features[0].pass.mean), 1e-3) << "there is no noise to remove";
}

TEST(Oidn, LittleMemoryMeansTilesOfTheSamePicture) {
  SKIP_WITHOUT_OIDN();
  const auto denoiser = make_oidn({});
  const test::Scene scene = test::make_scene(900, 700, 0.3, 6);
  const Image whole = denoiser->denoise(scene.frame.beauty.mean, {}, plenty, silent_progress());
  const Image tiles = denoiser->denoise(scene.frame.beauty.mean, {}, 1, silent_progress());
  EXPECT_LT(std::sqrt(mse(whole, tiles)), 1e-3);
}

class Stopping final : public Progress {
 public:
  void advance(std::size_t steps) override { done += steps; }
  bool cancelled() const override { return done > 0; }
  std::size_t done = 0;
};

class Counting final : public Progress {
 public:
  void advance(std::size_t steps) override { done += steps; }
  std::size_t done = 0;
};

TEST(Oidn, ReportsItsStepsAndStops) {
  SKIP_WITHOUT_OIDN();
  const auto denoiser = make_oidn({});
  const Image noisy = test::make_scene(160, 120, 0.3, 7).frame.beauty.mean;
  Counting counting;
  denoiser->denoise(noisy, {}, plenty, counting);
  EXPECT_NEAR(static_cast<double>(counting.done), Denoiser::units, 1);
  Stopping stopping;
  try {
    denoiser->denoise(noisy, {}, plenty, stopping);
    denoiser->denoise(noisy, {}, plenty, stopping);
    FAIL() << "went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::Interrupted);
  }
}

TEST(Oidn, IsNotFoundUnderAWrongName) {
  for (const char* path : {"/no/such/folder/libOpenImageDenoise.so.2", "/usr/lib/x86_64-linux-gnu/libm.so.6"}) try {
      make_oidn({{path, "auto"}});
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::Missing);
      EXPECT_THAT(error.what(), HasSubstr("--oidn"));
      EXPECT_THAT(error.what(), HasSubstr(path));
    }
}

TEST(Oidn, SaysWhatRunsIt) {
  SKIP_WITHOUT_OIDN();
  EXPECT_THAT(make_oidn({{"", "cpu"}})->name(), ::testing::MatchesRegex("Open Image Denoise 2\\..*\\(cpu\\)"));
  EXPECT_THAT(make_oidn({})->place(), HasSubstr("OpenImageDenoise"));
}

TEST(Oidn, MakesThePriorOfAReconstruction) {
  SKIP_WITHOUT_OIDN();
  const auto denoiser = make_oidn({});
  test::Scene alone = test::make_scene(160, 120, 0.5, 8), with = alone;
  with.frame.aovs = {{"part", alone.frame.beauty.mean, {}, {}, {}}, {"rest", alone.frame.beauty.mean, {}, {}, {}}};
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < with.frame.beauty.mean.pixels(); ++i) {
      const Real share = i % 7 < 3 ? Real(0.25) : Real(0.75);
      with.frame.aovs[0].mean.plane(c)[i] *= share;
      with.frame.aovs[1].mean.plane(c)[i] *= 1 - share;
    }
  const Result plain = reconstruct(alone.frame, Params(), silent_progress());
  const Result result = reconstruct(with.frame, {}, Params(), silent_progress(), denoiser.get());
  EXPECT_LT(mse(result.beauty, with.truth), mse(plain.beauty, alone.truth));
  EXPECT_LE(result.error.mean_relative_mse, plain.error.mean_relative_mse);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < result.beauty.pixels(); ++i) {
      const auto sum =
          static_cast<double>(result.aovs[0].plane(c)[i]) + static_cast<double>(result.aovs[1].plane(c)[i]);
      ASSERT_NEAR(sum, static_cast<double>(result.beauty.plane(c)[i]), 1e-3 * (1 + std::abs(sum)));
    }
}

}  // namespace
}  // namespace polyrecon
