#pragma once

#include "polyrecon/image.h"

namespace polyrecon {

/// The mean over the pixels of the first channel; NaN for an empty image. The same bits for any number of threads.
double mean_of(const Image& image);

/// Mean number of samples per pixel; 0 if it is unknown (an empty image).
double mean_samples(const Image& counts);

}  // namespace polyrecon
