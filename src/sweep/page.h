#pragma once

#include <string>

#include "sweep/sweep.h"

namespace polyrecon {

/// The report on a sweep as an HTML page in a single file: plots are inline SVG, pictures data URIs, and there is no
/// script. Sections: time and error of each setting with their Pareto front, the cost of accuracy along the front, the
/// error over the samples (with several inputs), the time of each phase, pictures of some settings, all figures.
/// version: of the program.
std::string page_of(const Sweep& sweep, const std::string& version);

}  // namespace polyrecon
