#pragma once

#include <array>
#include <cstdint>

#include "polyrecon/image.h"

namespace polyrecon {

/// Splits an image of known noise into two halves, mean + s xi and mean - s xi, where s^2 is the variance of the mean
/// and xi is standard normal ("data fission": Rasines and Young 2023, Leiner et al. 2023). Where the noise is Gaussian,
/// the noise of the halves is independent. Each half has twice the variance of the mean, and their average is the mean.
/// xi depends on stream, position and channel only. variance: of the mean, same shape; pixels where it is not positive
/// stay unchanged in both halves. correlation: of the noise of pixels next to each other, 0 to 0.5; xi gets the same,
/// or the halves would share the noise of each other's neighbours.
std::array<Image, 2> split_halves(const Image& mean, const Image& variance, std::uint64_t stream,
                                  double correlation = 0);

}  // namespace polyrecon
