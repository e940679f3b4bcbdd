#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// The variance of white noise as the corner of the spectrum shows it. A renderer's pixel filter limits the picture to
/// lower frequencies, and noise of samples that count for one pixel only is white. With k = [1 -3 3 -1], the
/// convolution of y with k along x and along y, over sum k^2 = 20, has the variance of the noise. Its square is
/// averaged over 7 x 7 places, and a pixel gets the median of such means (noise/estimate_grid.h). Aliased edges and
/// specks add to it. y: finite, any channels. mask: the pixels that take part (core/mask.h). Returns y's shape, y's
/// unit squared; 0 where the mask is too narrow for k.
Image corner_variance(const Image& y, const Image& mask = {});

/// About the highest variance of the mean v of n samples that fall on things as dark as the darkest (lo) or as bright
/// as the brightest (hi) of the 3 x 3 pixels around. Independent samples have at most (hi - v)(v - lo) / n (Bhatia and
/// Davis 2000). Renderers stratify a pixel's samples, so that at the rim of a lamp it falls as n^-3/2: the result is
///     (hi - v)(v - lo) / n min(1, 4 / sqrt(n)).
/// samples: n, 1 channel; the result is 0 where it is not positive.
Image two_value_variance(const Image& y, const Image& samples);

/// 1.4 min(corner_variance, two_value_variance). Fits to features take the noise of edges for texture, above all that
/// of bright things; the corner shows it, and the second term holds where it shows aliased edges instead. Both are read
/// off noisy pixels, hence the margin (docs/lab/2026-12-01-single-renders.md).
Image edge_variance(const Image& y, const Image& samples, const Image& mask = {});

}  // namespace polyrecon
