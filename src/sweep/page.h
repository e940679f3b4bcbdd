#pragma once

#include <string>

#include "sweep/sweep.h"

namespace polyrecon {

/// The report on a sweep as one HTML page that needs nothing beside it: plots as inline SVG, pictures as data URIs, no
/// script. Sections: the points and their Pareto front, what accuracy costs along it, samples (with several inputs),
/// time by stage, pictures of some points of the front, all figures. version: of the program.
std::string page_of(const Sweep& sweep, const std::string& version);

}  // namespace polyrecon
