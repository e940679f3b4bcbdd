#pragma once

#include <cstddef>
#include <string>

#include "polyrecon/image.h"
#include "polyrecon/layers.h"

namespace polyrecon {

constexpr float largest_half = 65504;

/// The meaning of samples beyond the range of a channel.
enum class BeyondRange {
  AsStored,
  LargestHalf,  ///< Half floats hold radiance above largest_half as +Inf.
  Sky           ///< Depths of rays that hit nothing: renderers write 1e10, the largest float, or +Inf.
};

/// layer: a layer of the part, which is used in this role. channel: one of the layer's, whole name.
BeyondRange beyond_range(const PartInfo& part, const Layer& layer, Role role, const std::string& channel);

/// Replaces +Inf by largest_half, or depths beyond the sky's by the sky's. Returns the number of half samples that were
/// replaced.
template <typename Sample>
std::size_t bring_into_range(BeyondRange beyond, Sample* samples, std::size_t count);

/// Sets single pixels and pairs of +Inf to NaN and returns their number. Three and more that touch are lamps, for which
/// the largest half is a fair value. One or two are fireflies: their value is unknown, and their energy would be spread
/// over the picture. If bring_into_range makes +Inf the largest half, call this before it. Pixels further than
/// lone_reach away do not matter.
template <typename Sample>
std::size_t drop_lone_overflows(Sample* plane, int width, int height);

constexpr int lone_reach = 2;

/// The number of samples of +Inf in the half-float channels of a layer, whose channels the image holds.
std::size_t half_overflows(const PartInfo& part, const Layer& layer, const Image& image);

/// The note on a layer in which so many half samples were dropped.
std::string lone_overflow_note(const std::string& layer, std::size_t samples);

/// The note on a layer in which so many half samples are +Inf.
std::string overflow_note(const std::string& layer, std::size_t samples);

}  // namespace polyrecon
