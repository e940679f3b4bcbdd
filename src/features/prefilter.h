#pragma once

#include <array>

#include "polyrecon/image.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// Cleans the two halves of one feature pass by cross-filtered non-local means (Rousselle et al. 2013): each half is
/// averaged with weights measured on the other one, so that the noise left in it is not the noise it was weighed by.
/// variance: of one half; a pixel is taken to be at least as noisy as its 3 x 3 neighbourhood. Tiles of 64 x 64
/// pixels without any noise are left as they are.
std::array<Image, 2> prefilter(const std::array<Image, 2>& halves, const Image& variance, const PrefilterParams& params,
                               Progress& progress);

}  // namespace polyrecon
