#pragma once

#include <vector>

#include "core/half_pair.h"
#include "core/progress.h"
#include "outliers/outlier.h"

namespace polyrecon {

struct OutlierParams {
  int neighbourhood = 2;             ///< Radius of the neighbourhood that an outlier stands out of, pixels.
  bool variance_is_measured = true;  ///< Otherwise the variance says nothing of single pixels and is not asked.
  double height = 3;  ///< How far above the median it stands, in units of (upper end of the neighbourhood - median).
  /// How far above the other half's pixel it stands, in units of the third largest difference of the halves around.
  double height_over_other_half = 8;
  double reliability = 4;  ///< It is unreliable: its excess is below this many of its own standard deviations.
  int density_radius = 9;  ///< Where outliers are common within this radius they are the light itself and stay.
  double density = 0.01;   ///< Part of the pixels around that may be outliers, beside the pixel itself.
};

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
