#include "denoisers/denoise_frame.h"

#include <algorithm>
#include <utility>

#include "core/color_layout.h"
#include "core/halves.h"
#include "core/parallel.h"

namespace polyrecon {
namespace {

/// Ways to mirror an image.
enum Turn : unsigned { AsItIs = 0, LeftRight = 1, UpDown = 2, Both = 3 };
constexpr std::array<Turn, 2> half_turns{LeftRight, UpDown};
constexpr std::array<Turn, 4> mean_turns{AsItIs, Both, LeftRight, UpDown};

Image turned(const Image& image, Turn turn) {
  if (turn == AsItIs || image.empty()) return image;
  Image out(image.width(), image.height(), image.channels());
  for_rows(image.height(), [&](int y) {
    for (int c = 0; c < image.channels(); ++c) {
      const Real* from = image.row(c, (turn & UpDown) != 0 ? image.height() - 1 - y : y);
      if ((turn & LeftRight) != 0)
        std::reverse_copy(from, from + image.width(), out.row(c, y));
      else
        std::copy_n(from, image.width(), out.row(c, y));
    }
  });
  return out;
}

void add(const Image& image, Real factor, Image& to) {
  for_rows(to.height(), [&](int y) {
    for (int c = 0; c < ColorLayout::primaries; ++c)
      for (int x = 0; x < to.width(); ++x) to.at(x, y, c) += factor * image.at(x, y, c);
  });
}

int mean_runs(bool independent_halves, const DenoiserParams& params) {
  return independent_halves ? params.mean_runs : std::max(params.mean_runs, 1);
}

}  // namespace

Pass denoise_frame(const Denoiser& denoiser, DenoiserInput input, const DenoiserParams& params, std::size_t max_bytes,
                   Progress& progress) {
  const DenoiserFeatures features = input.noise_free_features
                                        ? std::move(input.features)
                                        : denoiser.prefilter(std::move(input.features), max_bytes, progress);
  const auto denoised = [&](const Image& noisy, Turn turn) {
    const DenoiserFeatures f{turned(features.albedo, turn), turned(features.normal, turn)};
    return turned(denoiser.denoise(turned(noisy, turn), f, max_bytes, progress), turn);
  };
  Pass out;
  out.name = denoiser.name();
  if (input.independent_halves) {
    out.half_a = denoised(input.halves[0], half_turns[0]);
    out.half_b = denoised(input.halves[1], half_turns[1]);
  }
  const int runs = mean_runs(input.independent_halves, params);
  if (runs == 0) {
    out.mean = mean_of_halves({out.half_a, out.half_b}, ColorLayout::primaries);
    return out;
  }
  const Image noisy = mean_of_halves(input.halves, ColorLayout::primaries);
  input.halves = {};
  out.mean = Image(noisy.width(), noisy.height(), ColorLayout::primaries);
  for (int k = 0; k < runs; ++k)
    add(denoised(noisy, mean_turns.at(static_cast<std::size_t>(k))), Real(1) / static_cast<Real>(runs), out.mean);
  return out;
}

std::size_t denoiser_calls(bool independent_halves, bool noise_free_features, const DenoiserParams& params) {
  return static_cast<std::size_t>(mean_runs(independent_halves, params)) + (independent_halves ? 2 : 0) +
         (noise_free_features ? 0 : 1);
}

}  // namespace polyrecon
