#pragma once

#include <array>
#include <vector>

#include "core/image.h"
#include "outliers/outlier.h"

namespace polyrecon {

/// Gives back what remove_outliers took: equation (10), yhat(i) += rho_o yhat(i) over Omega_o, with rho_o from equation
/// (11), e_o = sum over Omega_o of rho_o yhat(i), so that the sum of every channel is what it was to double rounding.
/// Omega_o is a square around o that grows until rho_o is at most max_gain: spreading e_o over more pixels costs less
/// error and cannot be seen. Layers beyond the first three channels (AOVs, three channels each) receive their e_o in
/// the shape of the beauty, so that layers that add up still do; a last single channel (alpha) is left alone. An
/// outlier on an image that is all black gives its energy back where it was taken.
void restore_energy(const std::vector<Outlier>& outliers, double max_gain, Image& image);

/// The same for what the fit itself gained or lost: with Omega the whole image, every channel's sum becomes `totals`
/// (one value a channel, as many as are to be restored). Only where the gain is at most max_gain in magnitude; a larger
/// difference is not rounding or the pull of the weights but content (an input of both signs, a hole that was mended),
/// and stays. Returns the gain of each of the first three channels.
std::array<double, 3> restore_totals(const std::vector<double>& totals, double max_gain, Image& image);

/// Sum of every channel over the usable pixels.
std::vector<double> channel_sums(const Image& image);

}  // namespace polyrecon
