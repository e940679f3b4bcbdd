// Figures of an image against a converged reference: relative MSE and energy.
#pragma once

#include <cstddef>

#include "polyrecon/image.h"

namespace polyrecon {

/// The distance of an image x from a reference r.
struct Score {
  double relative_mse = 0;  ///< Mean over pixels and channels of ((x - r)^2 - Var(r)) / (r^2 + 0.01).
  double trimmed = 0;   ///< The same without the worst 0.1 % of the pixels, to distinguish fireflies from blur. NaN if
                        ///< there is only one pixel.
  double energy = 0;    ///< mean(x) / mean(r) - 1; NaN if the reference is black.
  std::size_t bad = 0;  ///< Pixels with a sample that is not finite; such samples count as 0 in all figures.
};

/// Compares an image with a reference. reference_variance: variance Var(r) of the reference's mean, or empty if that is
/// 0; it is subtracted, so that the noise of the reference does not count as error. Throws Error{BadInput} if the
/// images differ in shape.
Score score(const Image& image, const Image& reference, const Image& reference_variance);

/// The error of each pixel: mean over channels of (x - r)^2 / (r^2 + 0.01), 1 channel, not finite where x is not. Both
/// images must have the same shape.
Image relative_error(const Image& image, const Image& reference);

}  // namespace polyrecon
