#pragma once

#include <vector>

#include "core/half_pair.h"
#include "outliers/outlier.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// Finds the pixels of each half that stand far above what both halves say of their neighbourhood, or far above the
/// other half's own pixel as nothing around does (a spike beside an edge), and whose own variance says that they cannot
/// be trusted; replaces them by the neighbour of median brightness (in the second case among those that the other half
/// finds alike), with all its colour channels (so that layers that add up still do), and its variance; alpha stays. A
/// spike that both halves saw is a feature of the scene and stays; with independent_halves false the other half's own
/// pixel is no witness.
/// Returned in order of rows, half 0 first within a pixel.
std::vector<Outlier> remove_outliers(HalfPair& pair, bool independent_halves, const OutlierParams& params,
                                     Progress& progress);

}  // namespace polyrecon
