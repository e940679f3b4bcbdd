#pragma once

#include "core/half_pair.h"
#include "polyrecon/image.h"
#include "temporal/estimate.h"
#include "temporal/follow.h"

// Frames that are rendered with one random seed repeat their noise where nothing moves.
namespace polyrecon {

/// Takes a neighbour for unseen where it repeats a good part of the noise of the current frame, as all or some of the
/// samples of both have one seed. Returns the share of the noisy pixels that this concerns. It is read off the corner
/// of the spectrum, [1 -3 3 -1] along x and y, where pixel filters leave little of the picture: with the means m and n
/// of both frames there, rho = sum m n / sqrt(sum m^2 sum n^2) is 0 for independent noise, whatever its variance and
/// the exposure of the frames.
double hide_repeated_noise(const HalfPair& pair, Places& neighbour);

/// Whether an estimate repeats the noise of the current frame, 0 to 1, 1 channel: an average around each pixel.
Image shared_noise(const HalfPair& pair, const Estimate& estimate);

/// Standard deviation of the Gaussian of this average, in pixels.
constexpr double shared_sigma = 8;

}  // namespace polyrecon
