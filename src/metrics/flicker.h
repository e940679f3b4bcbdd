#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// A frame of a result and its reference. The images must outlive it.
struct MeasuredFrame {
  const Image& image;
  const Image& reference;
  const Image& reference_variance;  ///< The variance of its mean; empty where it is unknown.
};

/// How much the error changes from one frame to the next: half the mean over pixels and channels of
/// (e(now) - e(before))^2, e being the relative error (x - r) / sqrt(r^2 + relmse_floor). The noise that the references
/// add is subtracted where it is known. Where the errors of frames are independent, this is their variance. Samples
/// that are not finite do not count. All images must have the same shape.
double flicker(const MeasuredFrame& now, const MeasuredFrame& before);

}  // namespace polyrecon
