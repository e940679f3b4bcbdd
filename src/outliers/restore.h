#pragma once

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

}  // namespace polyrecon
