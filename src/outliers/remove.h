#pragma once

#include <vector>

#include "core/half_pair.h"
#include "outliers/outlier.h"
#include "polyrecon/params.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// How far the noise of a pair is known.
struct PairNoise {
  bool independent_halves = true;  ///< False if the halves were made from one image (noise/fission.h).
  bool variance_is_measured =
      true;  ///< False if it was estimated from the image, which is not exact for single pixels.
};

/// Finds and replaces outliers, equation (10). A pixel of a half is an outlier if its excess is within what its noise
/// variance allows (OutlierParams::reliability; ignored for an estimated variance), and either
/// - it is far brighter than its neighbourhood in both halves, or
/// - it is far brighter than the same pixel of the other half, while the halves differ much less around it. This test
///   finds a spike next to an edge, which the bright side of the edge hides from the first test.
/// An outlier gets the values of the neighbour of median brightness, in the second case of the neighbours that are
/// alike in the other half: its variance and all colour channels but alpha, so that layers that add up to the beauty
/// still do.
///
/// A spike that both halves have is a feature of the scene and stays. Without independent halves, the same pixel of
/// the other half is no evidence for that, and the second test is not made. Returns the outliers in the order of rows,
/// half 0 before half 1.
std::vector<Outlier> remove_outliers(HalfPair& pair, const PairNoise& known, const OutlierParams& params,
                                     Progress& progress);

}  // namespace polyrecon
