#pragma once

#include <vector>

#include "blend/select.h"
#include "core/half_pair.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// How far a result may stand from the noisy input: 5 standard deviations of a half's noise, which is at least that of
/// the quietest 7 x 7 pixels (by their mean standard deviation) that hold the pixel. So a pixel beside a glint, which
/// has seen nothing of it in either half and has quiet pixels on one side, does not take the glint's light from the
/// windows that cover both; one among spikes may take theirs, though it has met none yet. variance: of a half's noise
/// as it was measured, before any floor; 3 channels, >= 0. Returns radiance, of variance's shape.
Image noise_reach(const Image& variance);

/// What a result lost where it was bound.
struct BoundEnergy {
  std::size_t pixels = 0;
  std::vector<double> energy;  ///< Of each colour channel (beauty, then each AOV), radiance x pixels.
};

/// Brings both halves of a result nearer to the mean of the noisy ones, all three by the same part of their distance,
/// where their mean is more than reach from it; by colour channel, each of a layer's (AOV) by the beauty's part of that
/// colour, so that layers that add up still do. A last single channel (alpha) is left alone. The bias shrinks with the
/// distance. What is lost has to be given to the whole image (restore_everywhere): where that would be more than
/// max_lost of a colour's light (a frame whose light is one glint), all its pixels are brought nearer by less.
BoundEnergy bind_to_noise(const HalfPair& pair, const Image& reach, double max_lost, Candidate& result);

}  // namespace polyrecon
