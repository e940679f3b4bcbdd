#pragma once

#include <array>

#include "polyrecon/image.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// Denoises the two halves of one feature pass by cross-filtered non-local means (Rousselle et al. 2013): each half is
/// averaged with weights measured on the other one, so that its noise is independent of its weights. variance: noise
/// variance of one half; it is raised to the mean over 3 x 3 pixels where that is larger. Tiles of 64 x 64 pixels
/// without noise are copied. mask: the pixels that are averaged (core/mask.h).
std::array<Image, 2> prefilter(const std::array<Image, 2>& halves, const Image& variance, const PrefilterParams& params,
                               Progress& progress, const Image& mask = {});

}  // namespace polyrecon
