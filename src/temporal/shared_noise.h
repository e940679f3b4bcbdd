#pragma once

#include <vector>

#include "core/half_pair.h"
#include "polyrecon/image.h"
#include "temporal/estimate.h"
#include "temporal/follow.h"

// Frames that are rendered with one random seed repeat their noise where nothing moves.
namespace polyrecon {

/// Limits of the squared difference between the means of the halves of two frames, in units of what independent noise
/// makes: from `none` on they share no noise, up to `full` they surely do.
struct Sharing {
  double none, full;
};

/// The limits for a frame: higher ones where a good part of it repeats the noise of its neighbours, since then all
/// frames have one seed, and what moves repeats the noise in part. radius: the largest distance of a neighbour, frames.
const Sharing& sharing_of(const HalfPair& pair, const std::vector<Places>& places, int radius);

/// Whether an estimate repeats the noise of the current frame, 0 to 1, 1 channel: an average around each pixel.
Image shared_noise(const HalfPair& pair, const Estimate& estimate, const Sharing& sharing);

/// Standard deviation of the Gaussian of this average, in pixels.
constexpr double shared_sigma = 8;

}  // namespace polyrecon
