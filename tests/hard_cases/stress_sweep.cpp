// Reconstructs random frames on one thread and on four. Size, dynamic range and parameters are random, and any pass may
// hold NaN, infinity, negative values, zeros, or a copy of another. Each result must be finite and have the same bits.
//   stress_sweep [FRAMES [SEED]]
// Frame n is made from SEED + n, so `stress_sweep 1 SEED` repeats a single frame.

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "core/halves.h"
#include "polyrecon/error.h"
#include "polyrecon/reconstruct.h"
#include "support/images.h"
#include "support/random.h"
#include "support/threads.h"

namespace polyrecon {
namespace {

using test::Random;

constexpr double unusable[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(), 1e30, -1e30};
constexpr double awkward[] = {0, -0.0, -1, 1e-45, 1e-38, 65504, 1e6, 1e10};

/// Puts wrong values into random pixels of an image, sometimes into a whole row or everywhere.
void spoil(Image& image, Random& random) {
  if (image.empty() || random.uniform() < 0.5) return;
  const auto value = [&] { return random.uniform() < 0.5 ? unusable[random.below(5)] : awkward[random.below(8)]; };
  const double extent = random.uniform();
  const int c = random.below(image.channels());
  if (extent < 0.05) {
    image = Image(image.width(), image.height(), image.channels(), static_cast<Real>(value()));
  } else if (extent < 0.15) {
    std::fill_n(image.row(c, random.below(image.height())), image.width(), static_cast<Real>(value()));
  } else {
    for (int k = random.below(8); k >= 0; --k)
      image.at(random.below(image.width()), random.below(image.height()), c) = static_cast<Real>(value());
  }
}

/// Radiance over up to 14 powers of ten: smooth, with an edge and with single random pixels.
Image random_radiance(int width, int height, int channels, Random& random) {
  const double low = random.uniform(-8, 2), range = random.uniform(0, 6 - low), single = random.uniform() * 0.3;
  const double slope_x = random.normal() * 0.2, slope_y = random.normal() * 0.2;
  const int edge = random.below(width + 1);
  return test::image_of(width, height, channels, [&](int x, int y, int) {
    const double smooth = 0.5 + 0.5 * std::sin(slope_x * x + slope_y * y + (x < edge ? 0 : 2));
    return std::pow(10, low + range * (random.uniform() < single ? random.uniform() : smooth));
  });
}

/// A noisy pass around truth; its variance and its halves may be missing.
Pass noisy_pass(const std::string& name, const Image& truth, double noise, Random& random) {
  Pass pass;
  pass.name = name;
  const auto half = [&](int x, int y, int c) {
    return static_cast<double>(truth.at(x, y, c)) * (1 + noise * random.normal());
  };
  pass.half_a = test::image_of(truth.width(), truth.height(), truth.channels(), half);
  pass.half_b = test::image_of(truth.width(), truth.height(), truth.channels(), half);
  pass.mean = test::mean_of(pass.half_a, pass.half_b);
  if (random.uniform() < 0.5) {
    const double wrong = std::pow(10, random.uniform(-2, 2));
    pass.variance = test::image_of(truth.width(), truth.height(), truth.channels(), [&](int x, int y, int c) {
      return wrong * std::pow(noise * static_cast<double>(truth.at(x, y, c)), 2) / 2;
    });
  }
  if (random.uniform() < 0.4) pass.half_a = pass.half_b = Image();
  for (Image* image : {&pass.mean, &pass.variance, &pass.half_a, &pass.half_b}) spoil(*image, random);
  // As read_frame does; a picture that is made of the halves of another one fails its own check.
  if (pass.has_halves() && contradict(pass.mean, pass.half_a, pass.half_b)) pass.half_a = pass.half_b = Image();
  return pass;
}

Frame random_frame(Random& random) {
  const auto side = [&] { return 1 + random.below(random.uniform() < 0.5 ? 9 : random.uniform() < 0.9 ? 25 : 70); };
  const int width = side(), height = side();
  const auto noise = [&] { return random.uniform() < 0.15 ? 0 : std::pow(10, random.uniform(-3, 0.5)); };
  Frame frame;
  frame.data_window = {0, 0, width, height};
  frame.beauty = noisy_pass("Combined", random_radiance(width, height, 3, random), noise(), random);
  std::vector<RoleInfo> kinds;
  for (const RoleInfo& info : role_table())
    if (info.feature) kinds.push_back(info);
  for (int k = random.below(6); k > 0; --k) {
    const RoleInfo& kind = kinds[static_cast<std::size_t>(random.below(static_cast<int>(kinds.size())))];
    const bool clean = random.uniform() < 0.5;
    frame.features.push_back({kind.role, noisy_pass("feature", random_radiance(width, height, kind.channels, random),
                                                    clean ? 0 : noise(), random)});
    if (random.uniform() < 0.2) frame.features.push_back(frame.features.back());
  }
  for (int k = random.below(3); k > 0; --k) {
    const double share = random.uniform();
    frame.aovs.push_back(random.uniform() < 0.5
                             ? noisy_pass("aov", random_radiance(width, height, 3, random), noise(), random)
                             : Pass{"share", test::times(frame.beauty.mean, share), {}, {}, {}});
  }
  if (random.uniform() < 0.3) {
    frame.alpha = test::image_of(width, height, 1, [&](int, int, int) { return random.uniform(); });
    spoil(frame.alpha, random);
  }
  return frame;
}

Params random_params(Random& random) {
  Params params;
  params.stages = 1 + random.below(3);
  params.levels = 1 + random.below(3);
  params.radius = 1 + random.below(9);
  params.stride = 1 + random.below(std::min(params.radius, 4));
  params.patch.radius = params.estimated_patch.radius = random.below(3);
  params.max_order = random.below(5);
  if (random.uniform() < 0.3) params.guided_bandwidths.clear();
  params.reconstruct_alpha = random.uniform() < 0.5;
  return params;
}

/// A result, or the exit code of the Error that was thrown.
struct Answer {
  int code = 0;
  Result result;
};

Answer answer(const Frame& frame, const Params& params, int threads) {
  return test::with_threads(threads, [&] {
    try {
      Frame taken = frame;
      return Answer{0, reconstruct(taken, params, silent_progress())};
    } catch (const Error& error) {
      return Answer{static_cast<int>(error.code()), {}};
    }
  });
}

std::vector<const Image*> images_of(const Result& result, bool with_alpha) {
  std::vector<const Image*> images{&result.beauty,
                                   &result.order,
                                   &result.error.mse,
                                   &result.error.relative_mse,
                                   &result.error.relative_variance,
                                   &result.error.relative_noise};
  for (const Image& aov : result.aovs) images.push_back(&aov);
  if (with_alpha) images.push_back(&result.alpha);
  return images;
}

/// Sums over all frames.
struct Totals {
  std::size_t refused = 0, windows = 0, rank_deficient = 0, dropped = 0, fallen_back = 0, repaired = 0, outliers = 0;
};

/// What is wrong with the result of a frame; empty if nothing is.
std::string fault_of(std::uint64_t seed, Totals& totals) {
  Random random(seed);
  const Frame frame = random_frame(random);
  const Params params = random_params(random);
  const Answer one = answer(frame, params, 1), many = answer(frame, params, 4);
  if (one.code != many.code) return "4 threads give another exit code";
  if (one.code != 0) {
    ++totals.refused;
    return one.code == static_cast<int>(ExitCode::CheckFailed) ? "" : "exit code " + std::to_string(one.code);
  }
  // An alpha that is not reconstructed may hold NaN, as the input's does.
  const auto a = images_of(one.result, params.reconstruct_alpha), b = images_of(many.result, params.reconstruct_alpha);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!test::all_finite(*a[i])) return "image " + std::to_string(i) + " is not finite";
    if (!test::same_bits(*a[i], *b[i])) return "image " + std::to_string(i) + " differs with 4 threads";
  }
  const Report& report = one.result.report;
  totals.windows += report.windows;
  totals.rank_deficient += report.rank_deficient_windows;
  totals.dropped += report.windows_not_finite;
  totals.fallen_back += report.pixels_kept_noisy;
  totals.repaired += report.repaired_pixels;
  totals.outliers += report.outliers;
  return {};
}

}  // namespace
}  // namespace polyrecon

int main(int argc, char** argv) {
  const std::uint64_t frames = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 5000;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  polyrecon::Totals totals;
  std::size_t bad = 0;
  for (std::uint64_t seed = first; seed < first + frames; ++seed) {
    const std::string fault = polyrecon::fault_of(seed, totals);
    if (!fault.empty()) std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), fault.c_str()), ++bad;
    if ((seed - first + 1) % 100 == 0)
      std::printf("%llu frames, %zu bad\n", static_cast<unsigned long long>(seed - first + 1), bad);
    std::fflush(stdout);
  }
  std::printf(
      "%llu frames from seed %llu: %zu bad, %zu refused because no pixel is finite; %zu windows, %zu of lower rank, "
      "%zu "
      "dropped, %zu pixels fallen back, %zu repaired, %zu outliers\n",
      static_cast<unsigned long long>(frames), static_cast<unsigned long long>(first), bad, totals.refused,
      totals.windows, totals.rank_deficient, totals.dropped, totals.fallen_back, totals.repaired, totals.outliers);
  return bad == 0 ? 0 : 1;
}
