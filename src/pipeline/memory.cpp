#include "pipeline/memory.h"

#include <algorithm>

#include "noise/variance.h"
#include "pipeline/stage.h"
#include "polyrecon/error.h"

namespace polyrecon {
namespace {

constexpr std::size_t program_bytes = std::size_t{128} << 20;  // code, libraries, scratch of the threads
constexpr std::size_t in_preparation = 12;                     // channels of the feature being cleaned
constexpr double allocator = 1.08;  // what lies unused between images of unequal sizes: up to 6 % was seen

std::size_t count(int channels) { return static_cast<std::size_t>(channels); }

/// The pair of halves: colours, variance, features.
std::size_t pair_channels(const FrameShape& shape) {
  return 2 * count(shape.color_channels) + 3 + 2 * count(std::min(shape.feature_channels, max_feature_channels));
}

}  // namespace

FrameShape shape_of(const Frame& frame) {
  FrameShape shape{frame.beauty.mean.pixels(), 0, 3 + 3 * static_cast<int>(frame.aovs.size())};
  const auto add = [&](const Pass& pass) {
    for (const Image* image : {&pass.mean, &pass.variance, &pass.half_a, &pass.half_b})
      shape.channels += image->channels();
  };
  add(frame.prior);
  shape.prior_channels = shape.channels;
  add(frame.beauty);
  shape.channels += frame.motion.channels();
  for (const Pass& aov : frame.aovs) add(aov);
  for (const Feature& feature : frame.features) {
    add(feature.pass);
    const int channels = feature.pass.mean.channels();
    shape.feature_channels += channels;
    if (variance_is_estimated(feature.kind, feature.pass.noise_is_told())) shape.channels += channels;
  }
  return shape;
}

int neighbour_channels(const FrameShape& shape, int neighbours) {
  return neighbours * (2 * shape.color_channels + 3 + 4);
}

int channels_ahead(const FrameShape& shape, const Params& params) {
  return shape.channels + (params.temporal.radius > 0 ? neighbour_channels(shape, 2) : 0);
}

MemoryNeeds memory_needs(const FrameShape& shape, const Params& params) {
  const std::size_t plane = shape.pixels * sizeof(Real), noise = 3, reach = 3;
  // The frame's means of colours, alpha and sample count stay to the end.
  const std::size_t kept = count(shape.color_channels) + 2;
  const std::size_t candidate = 2 * count(shape.color_channels) + 7;  // halves, error, variance, order
  const auto with_gaps = [](std::size_t bytes) {
    return static_cast<std::size_t>(allocator * static_cast<double>(bytes));
  };
  MemoryNeeds needs;
  needs.prepare = with_gaps(
      program_bytes + plane * (count(shape.channels + shape.beside) + noise + pair_channels(shape) + in_preparation));
  // The pair and the results of this stage and the one before, with their coarser levels.
  needs.held = with_gaps(program_bytes + plane * (kept + noise + reach + count(shape.prior_channels + shape.beside)) +
                         plane * (pair_channels(shape) + 2 * candidate) * 4 / 3);
  needs.tile = with_gaps(
      std::min(smallest_tile_pixels(params), shape.pixels) *
      stage_bytes_per_pixel(shape.color_channels, std::min(shape.feature_channels, max_feature_channels), params));
  return needs;
}

void require_memory(const std::string& name, const FrameShape& shape, const Params& params) {
  const std::size_t least = memory_needs(shape, params).least();
  if (params.max_memory >= least) return;
  throw Error(ExitCode::OutOfMemory, name + ": " + std::to_string(shape.pixels) + " pixels with " +
                                         std::to_string(shape.channels) + " channels in use needs --max-memory " +
                                         std::to_string((least >> 20) + 1) + "M, or fewer passes");
}

std::size_t tile_memory(const FrameShape& shape, const Params& params) {
  const std::size_t held = memory_needs(shape, params).held;
  return held < params.max_memory ? static_cast<std::size_t>(static_cast<double>(params.max_memory - held) / allocator)
                                  : 0;
}

}  // namespace polyrecon
