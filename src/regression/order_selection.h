#pragma once

#include <array>

#include "regression/basis.h"

namespace polyrecon {

/// Sums of one channel of a window for each column a of its factorisation (least_squares.h).
struct ColumnStatistics {
  using Columns = std::array<double, BasisLayout::max_columns>;
  Columns z{};              ///< Coefficient of the noisy response.
  Columns variance{};       ///< s_a^2, variance of z_a: the terms of equations (6) and (9).
  Columns guess{};          ///< Coefficient m_a of the guess of mu by the previous stage; unused in stage 1.
  double guess_energy = 0;  ///< |S m|^2 = sum_i w_i m(i)^2 for the guess m of mu (in stage 1 y is the guess).
  double noise_energy = 0;  ///< sum_i w_i sigma^2(i).
};

/// The model average chosen for a window, and its estimated error.
struct OrderChoice {
  int model = 0;     ///< The model of the largest share: index into BasisLayout's models, the lowest of equals.
  double order = 0;  ///< Taylor order, mean over the models by their shares.
  std::array<double, BasisLayout::max_columns> factor{};  ///< g_a: column a enters the fit as g_a z_a q_a.
  /// Equation (4) per channel: weighted mean of bias^2 + variance; >= 0. In later stages mu_a^2 is estimated by
  /// 9/10 z_a m_a + 1/10 m_a^2 here, since the factors g_a are chosen by z_a m_a.
  std::array<double, 3> error{};
  std::array<double, 3> variance{};  ///< Equation (6) per channel; part of error.
};

/// Change of the window's estimated error, per channel, when a column enters with factor g:
///     g^2 n - (2g - g^2) e,   n = s_a^2,
/// where e estimates the column's share mu_a^2 of |S mu|^2:
///     stage 1       (y is the guess of mu, its noise is subtracted):    e = z_a^2 - n
///     later stages  (the result of the previous stage is the guess):    e = z_a m_a
/// For g = 1, stage 1 is the identity of Mallows' Cp: one factorisation gives the errors of all nested models. The
/// paper has m_a^2 in later stages. This code departs from it because z_a m_a is unbiased where the errors of y and of
/// the guess are independent, and m_a^2 is not. The formula assumes that q_a has length 1; a column that fades out
/// (least_squares.h) is shorter, which is neglected.
double error_change(const ColumnStatistics& channel, int column, double g, bool first_stage);

/// Factor that minimises the error_change of the columns [begin, end) summed over the channels, max(0, e / (e + n)):
/// the positive-part James-Stein factor in stage 1, Wiener's in later stages. 1 for the constant (begin = 0). Departure
/// from Moon et al. 2016, where the factor of a column is 0 or 1.
double shrinkage_factor(const std::array<ColumnStatistics, 3>& channels, int begin, int end, bool first_stage);

/// Equation (7), k_opt = argmin_k of bias^2 + variance, over the nested models of layout, with the error summed over
/// the channels. Models about as good as the best one are averaged, so that rounding never decides between two: the
/// share of a model is in proportion to
///     max(0, 1 - (error - least) / (tolerance (max(least, 0) + s_0^2)))
/// with s_0^2 the variance of the constant. With tolerance 0 only the best model counts.
///
/// Each feature has its own shrinkage factor. The Taylor terms of one order share a factor: sums over them do not
/// depend on the axes that span them, so the result for a rotated or transposed image is the rotated result.
/// weight_sum is sum_i w_i > 0. With shrinkage false all factors are 1, as in the paper.
OrderChoice select_order(const std::array<ColumnStatistics, 3>& channels, const BasisLayout& layout, double weight_sum,
                         bool first_stage, double tolerance, bool shrinkage = true);

}  // namespace polyrecon
