#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// How far the local variation of a feature is its own noise, 0 to 1. With b the blur of the feature f by a Gaussian G
/// of 2.5 pixels and g_0 the middle of G's kernel,
///     r = (1 - 2 g_0 + sum g^2) G[variance] / G[(f - b)^2],
/// whose expectation is 1 where f is smooth but for white noise. The result rises from 0 at r = 0.5 to 1 at r = 0.8.
/// G covers some 80 pixels, so r of noise alone has a standard deviation of about 0.16 and is rarely below 0.7.
/// feature: finite, any channels. variance: of its noise, >= 0, same shape. mask: the pixels that take part
/// (core/mask.h). Returns feature's shape; 0 outside the mask.
Image noise_in_variation(const Image& feature, const Image& variance, const Image& mask = {});

/// The image where `part` is 0, its blur by G where it is 1, and a mixture between. part: as of noise_in_variation.
Image flattened(Image image, const Image& part, const Image& mask = {});

}  // namespace polyrecon
