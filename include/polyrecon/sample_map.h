#pragma once

#include <cstddef>

#include "polyrecon/error_map.h"
#include "polyrecon/image.h"
#include "polyrecon/progress.h"

namespace polyrecon {

/// How the extra samples are limited; exactly one of budget and target is positive.
struct SampleMapParams {
  double budget = 0;           ///< Extra samples per pixel on average; with a cost image: of samples of average cost.
  double target = 0;           ///< Mean relative MSE to reach with as few samples (or as little cost) as possible.
  double max_samples = 1024;   ///< Most extra samples of one pixel.
  double assumed_samples = 8;  ///< Samples per pixel already taken, where sample_count is empty.
  int radius = 7;  ///< Of the Gaussian K that a sample's help is spread with; pixels, standard deviation radius / 2.
};

/// Throws Error{Usage} naming the first value out of its range.
void validate(const SampleMapParams& params);

/// Where the next samples go, and what they are predicted to bring.
struct SampleMap {
  Image samples;                       ///< 1 channel: extra samples dn of each pixel, 0 .. max_samples, not rounded.
  Image importance;                    ///< 1 channel: samples divided by their maximum, 0 .. 1.
  double total = 0, min = 0, max = 0;  ///< Of samples.
  double error_before = 0;             ///< Mean relative MSE now,
  double error_after = 0;              ///< and as predicted with the extra samples.
  std::size_t unknown_pixels = 0;      ///< Pixels whose error was not finite: treated as the mean of the others.
  bool limit_met = false;              ///< Budget spent, or target reached.
};

/// How fast the error of a reconstruction falls: with n^-rate. A polynomial of order k over a plane, at its best
/// bandwidth h, has bias^2 ~ h^(2(k+1)) and variance ~ 1 / (n h^2), so that both fall with n^(-(k+1)/(k+2)): 3/4 at
/// order 2 (2/3 at order 0 or 1 with symmetric windows; Moon, Carr and Yoon, Adaptive Rendering Based on Weighted Local
/// Regression, 2014, predict with this). docs/lab/2026-11-26-where-samples-go.md has what was measured.
inline constexpr double convergence_rate = 0.75;

/// The adaptive sampling of the report's section 3: extra samples go where they reduce the relative MSE most, until the
/// budget is spent or the target reached. A sample helps every pixel of its window: with v_j = relative_variance and
/// sum_i K_ij = 1, V_i = sum_j K_ij v_j is what the noise of pixel i does. After few samples v is as noisy as they are;
/// so is the noise u_j = relative_noise of the input, but its errors are others: where it is known, V_i is sqrt(sum_j
/// K_ij v_j sum_j K_ij u_j) (measured on the same page). The minimum of sum_i V_i n_i / (n_i + dn_i)
/// under sum_i c_i dn_i = C is the water-filling
///
///     dn_i = clamp(sqrt(V_i n_i / (lambda c_i)) - n_i, 0, max_samples),
///
/// the end of adding samples greedily where the sum falls most for its cost. Lambda is found to double precision in
/// O(pixels). The bias falls as well, since bandwidths and orders are chosen anew, so the error is predicted as
///
///     error_after = error_before * sum_i V_i (n_i / (n_i + dn_i))^convergence_rate / sum_i V_i.
///
/// sample_count: 1 channel, n_i; empty where unknown. cost: 1 channel, seconds per sample up to a common factor; empty
/// where all samples cost the same. Counts that are not positive are taken as 1, costs that are not as the mean cost.
/// Throws Error{BadInput} where shapes differ, or where a target is asked for and no pixel's error is finite (with a
/// budget, all pixels then get the same), Error{Interrupted} when progress asks to stop.
SampleMap make_sample_map(const ErrorMap& error, const Image& sample_count, const Image& cost,
                          const SampleMapParams& params, Progress& progress);

}  // namespace polyrecon
