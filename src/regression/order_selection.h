#pragma once

#include <array>

#include "regression/basis.h"

namespace polyrecon {

/// What one channel of a window knows of each column a of its factorisation (least_squares.h).
struct ColumnStatistics {
  using Columns = std::array<double, BasisLayout::max_columns>;
  Columns z{};              ///< Coefficient of the noisy response.
  Columns variance{};       ///< s_a^2, variance of z_a: the terms of equations (6) and (9).
  Columns guess{};          ///< Coefficient of the guess of mu of the stage before; unused in stage 1.
  double guess_energy = 0;  ///< |S m|^2 = sum_i w_i m(i)^2 for the stage's guess m of mu (stage 1: of y).
  double noise_energy = 0;  ///< sum_i w_i sigma^2(i).
};

/// The models that a window settles on, and their estimated error.
struct OrderChoice {
  int model = 0;     ///< The one that counts most: index into BasisLayout's models, the lowest of equals.
  double order = 0;  ///< Taylor order, mean over the models.
  std::array<double, BasisLayout::max_columns> factor{};  ///< g_a: column a enters the fit as g_a z_a q_a.
  /// Equation (4) per channel: weighted mean of bias^2 + variance; >= 0. In later stages its bias^2 is by 9/10 z_a m_a
  /// + 1/10 m_a^2, since the factors were chosen by the former alone.
  std::array<double, 3> error{};
  std::array<double, 3> variance{};  ///< Equation (6) per channel, its part of error.
};

/// Change of the window's estimated error, per channel, when a column enters with factor g:
///     g^2 n - (2g - g^2) e,   n = s_a^2,
/// e an estimate of the column's share mu_a^2 of |S mu|^2:
///     stage 1 (mu guessed by y, the noise inside it subtracted):   e = z_a^2 - n
///     later   (mu guessed by the result of the stage before):      e = z_a m_a
/// For g = 1 stage 1 is the identity of Mallows' Cp: all nested models from one factorisation. Departure from the
/// paper, which has m_a^2 in later stages: where y and the guess err independently the product is unbiased, the square
/// is not. A column that fades out (least_squares.h) is shorter than 1 and reckoned as if it were not.
double error_change(const ColumnStatistics& channel, int column, double g, bool first_stage);

/// Factor that minimises the error_change of the columns [begin, end) summed over the channels, max(0, e / (e + n)):
/// in stage 1 the positive-part James-Stein factor, later Wiener's. The constant always enters whole. Departure from
/// Moon et al. 2016, who let a column in whole or not at all.
double shrinkage_factor(const std::array<ColumnStatistics, 3>& channels, int begin, int end, bool first_stage);

/// Features have a factor each. The Taylor terms of one order share theirs: their sums do not depend on the axes that
/// span them, so that a turned or transposed image gives a turned result.
///
/// Equation (7), k_opt = argmin_k of bias^2 + variance, over the nested models of layout, the error summed over
/// channels. Models as good as the best are averaged: each counts
///     max(0, 1 - (error - least) / (tolerance (max(least, 0) + s_0^2)))
/// with s_0^2 the variance of the constant, so that no rounding decides between two. tolerance 0: the best alone.
/// weight_sum is sum_i w_i > 0. shrinkage: false lets every column in whole, as the paper does.
OrderChoice select_order(const std::array<ColumnStatistics, 3>& channels, const BasisLayout& layout, double weight_sum,
                         bool first_stage, double tolerance, bool shrinkage = true);

}  // namespace polyrecon
