#pragma once

#include <array>
#include <vector>

#include "core/half_pair.h"
#include "polyrecon/image.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"
#include "temporal/geometry.h"
#include "temporal/neighbour.h"

namespace polyrecon {

/// Result figures of join_neighbours.
struct JoinCounts {
  std::size_t neighbours = 0;  ///< Frames that were followed to.
  double weight = 0;           ///< Mean sum of the neighbours' weights at noisy pixels; the pixel itself has weight 1.
  double shared_noise = 0;     ///< Share of the noisy pixels whose noise the neighbours repeat.
};

/// Averages each half of the current frame with the same half of its neighbours, pixel by pixel, along the motion:
///     A'(i) = (A(i) + sum_g w_g(i) A_g(i)) / (1 + sum_g w_g(i))
/// There is an estimate g for each distance k in time: the mean of the frames k before and k after, in which steady
/// changes cancel, or one of them where the point is not seen in the other. The weights come from the other half,
///     w_g = Var(B) / (Var(B_g) + e^2 + K r^2) x exp(-(change - accept) / softness) x (1 - s).
/// e^2 is the part of (B - B_g)^2 around the pixel that noise does not explain. r^2 is the squared change of radiance
/// to expect from the change of albedo, normal and depth. It is known almost without noise, so it is compared with the
/// noise variance of the fitted image, which is K times smaller than the pixel's. The change is
///     z^2 = sum_rgb (G_s * (B - B_g))^2 / sum_rgb (G_s^2 * (Var(B) + Var(B_g)))
/// at single pixels and under Gaussians G_s of several sizes: large ones find a small change of radiance that no single
/// pixel shows, small ones find a moving edge. The weights depend smoothly on the noise and are the same for all
/// layers, so that layers that add up to the beauty still do. The variance becomes that of the average.
///
/// Frames that are rendered with one random seed repeat their noise where nothing moves. Their average has the same
/// noise again; halves that were split from one image would even hide it, as the noise of the split does average out. s
/// is 1 where the means of the halves differ by far less than their noise, and 0 where they differ as independent ones
/// do.
///
/// noise: surface_noise of the current frame.
JoinCounts join_neighbours(const Geometry& geometry, const std::array<Image, surfaces>& noise,
                           const std::vector<TimedNeighbour>& neighbours, const TemporalParams& params, HalfPair& pair,
                           Progress& progress);

}  // namespace polyrecon
