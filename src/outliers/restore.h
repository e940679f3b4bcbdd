#pragma once

#include <array>
#include <vector>

#include "outliers/outlier.h"
#include "polyrecon/image.h"

namespace polyrecon {

/// Gives back what remove_outliers took: equations (10) and (11) with a gain that is proportional to the pixel's
/// brightness, yhat(i) += e_o kappa yhat(i)^2 / sum over Omega_o of kappa yhat^2, which of all ways to add e_o costs
/// the least relative squared error, sum (d / yhat)^2 / kappa (docs/lab/2026-11-28-fireflies.md);
/// the sum of every channel is what it
/// was to double rounding. kappa = min(1, sigma / (max_gain yhat)), sigma being the standard deviation of the input's
/// noise: a pixel that carries less noise than the gain would show (a sky of one colour) is known better than to take
/// part in full. Omega_o is a square around o that grows until the root mean square of the gain, weighed by kappa, is
/// at most max_gain, so that light stays where it fell as far as that cannot be seen. Layers beyond the first three
/// channels (AOVs, three channels each) receive their e_o in the shape of the beauty, so that layers that add up still
/// do; a last single channel (alpha) is left alone. Where Omega_o is the whole image, gains are bounded: see
/// restore_everywhere. An outlier on an image that is all black, or free of noise, gives its energy back where it was
/// taken. variance: of the noise of one half of the input, 3 channels (HalfPair::variance).
void restore_energy(const std::vector<Outlier>& outliers, const Image& variance, double max_gain, Image& image);

/// The same with Omega the whole image, for energy that has no place of its own (blend/noise_bound.h): one value per
/// colour channel. No pixel changes by more than a half: those that would, the brightest, change by that, the others
/// still by squares, which is the least relative squared error under this bound; where it cannot be kept all gain
/// alike. Here, too, a pixel takes part by kappa: quiet is the relative noise below which it does less. Nothing where
/// no pixel of the colour takes part.
void restore_everywhere(const std::vector<double>& energy, const Image& variance, double quiet, Image& image);

/// The same for what the fit itself gained or lost: every channel's sum becomes `totals` (one value a channel, as many
/// as are to be restored). Only where that is at most max_gain of the channel; a larger difference is not rounding or
/// the pull of the weights but content (an input of both signs, a hole that was repaired), and stays.
/// Returns the gain of each of the first three channels.
std::array<double, 3> restore_totals(const std::vector<double>& totals, const Image& variance, double quiet,
                                     double max_gain, Image& image);

/// Channels that restore_energy holds, the image that it works on included.
std::size_t restore_channels(std::size_t color_channels);

/// Sum of every channel over the usable pixels.
std::vector<double> channel_sums(const Image& image);

}  // namespace polyrecon
