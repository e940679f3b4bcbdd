// The sample map: where a renderer should take its next samples.
#pragma once

#include <cstddef>

#include "polyrecon/error_map.h"
#include "polyrecon/image.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// The limit of the extra samples. Exactly one of budget and target is positive.
struct SampleMapParams {
  double budget = 0;           ///< Mean extra samples per pixel; with a cost image, in samples of mean cost.
  double target = 0;           ///< Mean relative MSE to reach with the fewest samples (or the least cost).
  double max_samples = 1024;   ///< Most extra samples of a pixel.
  double assumed_samples = 8;  ///< Samples per pixel already taken, if sample_count is empty.
  int radius = 7;              ///< Radius of the Gaussian K, pixels; its standard deviation is radius / 2.
};

/// Throws Error{Usage} naming the first value out of its range.
void validate(const SampleMapParams& params);

/// The places of the next samples, and the error that is expected with them.
struct SampleMap {
  Image samples;                       ///< 1 channel: extra samples dn of each pixel, 0 .. max_samples, not rounded.
  Image importance;                    ///< 1 channel: samples divided by their maximum, 0 .. 1.
  double total = 0, min = 0, max = 0;  ///< Sum, minimum and maximum of samples.
  double error_before = 0;             ///< Mean relative MSE now.
  double error_after = 0;              ///< Mean relative MSE predicted with the extra samples.
  std::size_t unknown_pixels = 0;      ///< Pixels whose error was not finite; the mean of the others stands in.
  bool limit_met = false;              ///< Whether the budget is spent or the target reached.
};

/// The error of a reconstruction falls with the number n of samples as n^-convergence_rate. A polynomial of order k
/// over a plane, at its best bandwidth h, has bias^2 ~ h^(2(k+1)) and variance ~ 1 / (n h^2), so both fall as
/// n^(-(k+1)/(k+2)): 3/4 at order 2. At order 0 or 1 with symmetric windows it is 2/3, with which Moon, Carr and Yoon,
/// Adaptive Rendering Based on Weighted Local Regression, 2014, predict. Measured in
/// docs/lab/2026-11-26-where-samples-go.md.
inline constexpr double convergence_rate = 0.75;

/// Distributes extra samples where they reduce the relative MSE most (Delta(eps_i) in the paper), until the
/// budget is spent or the target reached. A sample helps every pixel whose window contains it. V_i is the part that the
/// noise of pixel i has in the error: with v = relative_variance, u = relative_noise and a Gaussian K, sum_i K_ij = 1,
///
///     V_i = sqrt(sum_j K_ij v_j * sum_j K_ij u_j),   or sum_j K_ij v_j if relative_noise is empty.
///
/// After few samples v and u are themselves noisy, but their errors differ; the geometric mean did better than either
/// (docs/lab/2026-11-26-where-samples-go.md). The minimum of sum_i V_i n_i / (n_i + dn_i) under sum_i c_i dn_i = C is
/// the water-filling
///
///     dn_i = clamp(sqrt(V_i n_i / (lambda c_i)) - n_i, 0, max_samples),
///
/// which is the limit of adding single samples wherever the sum falls most for their cost. Lambda is found to double
/// precision in O(pixels). With more samples the bias falls too, as bandwidths and orders are chosen anew, so the error
/// is predicted as
///
///     error_after = error_before * sum_i V_i (n_i / (n_i + dn_i))^convergence_rate / sum_i V_i.
///
/// sample_count: 1 channel, n_i; empty if unknown. cost: 1 channel, c_i, seconds per sample up to a common factor;
/// empty if all samples cost the same. A count that is not positive is taken as 1, such a cost as the mean cost. If no
/// pixel has a finite error, a budget is spread evenly. Throws Error{Usage} if a parameter is out of its range,
/// Error{BadInput} if shapes differ or if a target is given and no pixel's error is finite, and Error{Interrupted} when
/// progress asks to stop.
SampleMap make_sample_map(const ErrorMap& error, const Image& sample_count, const Image& cost,
                          const SampleMapParams& params, Progress& progress);

}  // namespace polyrecon
