#pragma once

#include <vector>

#include "core/half_pair.h"
#include "polyrecon/image.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "temporal/neighbour.h"

namespace polyrecon {

/// What joined.
struct JoinCounts {
  std::size_t neighbours = 0;  ///< Frames in reach.
  double weight = 0;           ///< Mean weight of all neighbours beside the own pixel's 1.
};

/// Averages each half of the frame in hand with the same half of its neighbours, pixel by pixel, along the motion:
///     A'(i) = (A(i) + sum_g w_g(i) A_g(i)) / (1 + sum_g w_g(i))
/// The estimates g are, for each distance k in time, the mean of the frames k before and k after (in which what changes
/// steadily cancels out), or where the point is seen in only one of them that one. Their weights come from the other
/// half: w_g = Var(B) / (Var(B_g) + e^2) x exp(-change above what is accepted), with e^2 the part of (B - B_g)^2 around
/// the pixel that noise does not explain, and the change
///     z^2 = sum_rgb (G_s * (B - B_g))^2 / sum_rgb (G_s^2 * (Var(B) + Var(B_g)))
/// at single pixels and under Gaussians G_s of several sizes: a small change of light that no pixel shows is seen by
/// the large ones, a moving edge by the small ones. The weights are smooth in the noise and the same for all layers, so
/// that layers that add up still do. The variance becomes that of the average; where the frames share their noise (one
/// random seed for all) it stays what it was.
JoinCounts join_neighbours(const Image& motion, const std::vector<TimedNeighbour>& neighbours,
                           const TemporalParams& params, HalfPair& pair, Progress& progress);

}  // namespace polyrecon
