#pragma once

#include <cstddef>
#include <vector>

#include "blend/select.h"
#include "core/half_pair.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// How far a result may differ from the noisy input, radiance: 5 standard deviations of a half's noise. The standard
/// deviation is that of the pixel, or if that is larger the least mean standard deviation of all squares of 7 x 7
/// pixels that contain the pixel. So a pixel next to a glint, with little noise on one side and without the glint in
/// either half, does not receive the glint's energy from windows that cover both; a pixel among spikes may receive
/// theirs, though no spike has hit it yet. variance: of a half's noise as measured, before variance_floor.h raises it;
/// 3 channels, >= 0. Returns variance's shape.
Image noise_bound(const Image& variance);

inline constexpr std::size_t noise_bound_channels = 3;

/// The energy that a result lost where it was bound.
struct BoundEnergy {
  std::size_t pixels = 0;      ///< Pixels that were changed.
  std::vector<double> energy;  ///< Lost by each channel of the beauty and the AOVs, radiance x pixels.
};

/// Moves the result toward the noisy input where the means of their halves differ by more than `bound`. Both halves of
/// the result move by the same part of their distance to the mean of the noisy halves. The part is computed for each
/// colour of the beauty and applied to that colour of every layer, so that layers that add up to the beauty still do;
/// alpha stays unchanged. The bias shrinks with the distance. The lost energy has to be returned to the whole image
/// (restore_everywhere). Where it would be more than max_lost of the energy of a colour, as in a frame lit by a single
/// glint, all pixels move by correspondingly less.
BoundEnergy bind_to_noise(const HalfPair& pair, const Image& bound, double max_lost, Candidate& result);

}  // namespace polyrecon
