#pragma once

#include <array>
#include <cstdint>

#include "polyrecon/image.h"

namespace polyrecon {

/// Splits an image of known noise into two halves whose noise is independent where it is Gaussian: mean + s xi and mean
/// - s xi with s^2 the variance of the mean and xi standard normal ("data fission": Rasines and Young 2023, Leiner et
/// al. 2023). Each half has twice the variance, their average is the mean again. xi depends on stream, position and
/// channel only.
std::array<Image, 2> split_halves(const Image& mean, const Image& variance, std::uint64_t stream);

}  // namespace polyrecon
