#pragma once

#include <cstddef>

#include "polyrecon/image.h"

namespace polyrecon {

/// How far an image is from a converged reference.
struct Score {
  double relative_mse = 0;  ///< Mean over pixels and channels of ((x - r)^2 - Var(r)) / (r^2 + 0.01).
  double trimmed = 0;   ///< The same without the 0.1 % worst pixels: tells fireflies from blur. NaN below two pixels.
  double energy = 0;    ///< mean(x) / mean(r) - 1; NaN where the reference is black.
  std::size_t bad = 0;  ///< Pixels with a channel that is not finite; such samples count as 0 above.
};

/// reference_variance is the variance of the reference's own mean, so that a noisy reference puts no floor under the
/// figure; empty: 0. All images have one shape. Throws Error{BadInput} where they do not.
Score score(const Image& image, const Image& reference, const Image& reference_variance);

/// Where the error is: per pixel the mean over channels of (x - r)^2 / (r^2 + 0.01), 1 channel. Not finite where a
/// sample of the image is not.
Image relative_error(const Image& image, const Image& reference);

}  // namespace polyrecon
