#pragma once

#include "polyrecon/image.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// HDR-FLIP: the difference that a viewer notices when two pictures alternate on a display, per pixel, from 0 (none) to
/// 1. It is the largest difference over the exposures at which the reference can be viewed, from a distance with 67.02
/// pixels per degree: 0.7 m in front of a 0.7 m wide display of 3840 pixels.
///     Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom, Fairchild: FLIP: A Difference Evaluator for Alternating
///     Images. Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020.
///     Andersson, Nilsson, Shirley, Akenine-Moeller: Visualizing Errors in Rendered High Dynamic Range Images.
///     Eurographics Short Papers, 2021.
/// image, reference: linear radiance of any range, 3 channels, Rec. 709 primaries. Samples that are not finite, and
/// negative ones, count as 0. Returns one channel. Throws Error{BadInput} where the shapes differ and
/// Error{Interrupted} when progress asks to stop.
Image flip(const Image& image, const Image& reference, Progress& progress);

}  // namespace polyrecon
