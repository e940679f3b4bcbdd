#pragma once

#include <array>
#include <vector>

#include "core/image.h"
#include "outliers/outlier.h"

namespace polyrecon {

/// Gives back what remove_outliers took: as equations (10) and (11), but with Omega the whole image and each pixel's
/// gain proportional to its brightness, yhat(i) += e yhat(i)^2 / sum yhat^2, e the sum of the outliers' e_o. For a
/// given e that is what costs the least relative squared error, sum (d / yhat)^2 (docs/accuracy.md); the sum of every
/// channel is what it was to double rounding. Layers beyond the first three channels (AOVs, three channels each)
/// receive their energy in the shape of the beauty, so that layers that add up still do; a last single channel (alpha)
/// is left alone. On a channel that is all black each outlier gives its energy back where it was taken.
void restore_energy(const std::vector<Outlier>& outliers, Image& image);

/// The same for what the fit itself gained or lost: every channel's sum becomes `totals` (one value a channel, as many
/// as are to be restored). Only where that is at most max_gain of the channel; a larger difference is not rounding or
/// the pull of the weights but content (an input of both signs, a hole that was mended), and stays. Returns the gain of
/// each of the first three channels.
std::array<double, 3> restore_totals(const std::vector<double>& totals, double max_gain, Image& image);

/// Sum of every channel over the usable pixels.
std::vector<double> channel_sums(const Image& image);

}  // namespace polyrecon
