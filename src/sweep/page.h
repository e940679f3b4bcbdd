#pragma once

#include <cstddef>
#include <string>

#include "sweep/sweep.h"

namespace polyrecon {

/// The report on a sweep as an HTML page in a single file: the viewer with the noisy input, the reference, and the
/// results of settings and other programs; below it time and error of each setting with their Pareto front, whose
/// points show their image in the viewer, the cost of accuracy along the front, the error over the samples (with
/// several inputs), the time of each phase, all figures. version: of the program. max_bytes: of the pictures.
std::string page_of(const Sweep& sweep, const std::string& version, std::size_t max_bytes);

}  // namespace polyrecon
