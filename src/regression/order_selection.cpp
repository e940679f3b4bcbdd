#include "regression/order_selection.h"

#include <algorithm>
#include <cassert>

#include "core/near_best.h"

namespace polyrecon {
namespace {

using Channels = std::array<ColumnStatistics, 3>;

// Part of z_a m_a in the estimate of mu_a^2 that the error is computed from; the rest is m_a^2. z_a m_a is unbiased
// where the errors of z_a and of the guess are independent, but the factors were chosen by it, which makes the error
// look too small; m_a^2 is too large by the noise of the guess.
constexpr double share_of_product = 0.9;

/// The estimate e of mu_a^2 by which the factors and the order are chosen; see error_change.
double selection_energy(const ColumnStatistics& channel, std::size_t a, bool first_stage) {
  return first_stage ? channel.z[a] * channel.z[a] - channel.variance[a] : channel.z[a] * channel.guess[a];
}

/// The estimate of mu_a^2 by which the error of the choice is computed.
double error_energy(const ColumnStatistics& channel, std::size_t a, bool first_stage) {
  const double chosen = selection_energy(channel, a, first_stage);
  return first_stage ? chosen : chosen + (1 - share_of_product) * (channel.guess[a] * channel.guess[a] - chosen);
}

/// The part of |S mu|^2 that is orthogonal to all columns: every model has this error.
double error_of_all(const ColumnStatistics& channel, const BasisLayout& layout, bool first_stage) {
  double error = first_stage ? channel.guess_energy - channel.noise_energy : channel.guess_energy;
  for (std::size_t a = 0; a < static_cast<std::size_t>(layout.columns()); ++a)
    error -= first_stage ? selection_energy(channel, a, true) : channel.guess[a] * channel.guess[a];
  return error;
}

/// Estimated error of every model, summed over the channels, in one pass over the columns.
std::array<double, BasisLayout::max_models> nested_errors(const Channels& channels, const BasisLayout& layout,
                                                          const double* factor, bool first_stage) {
  std::array<double, BasisLayout::max_models> errors{};
  double error = 0;
  for (const ColumnStatistics& channel : channels) {
    error += error_of_all(channel, layout, first_stage);
    for (std::size_t a = 0; a < static_cast<std::size_t>(layout.columns()); ++a)
      error += selection_energy(channel, a, first_stage);
  }
  int column = 0;
  for (int model = 0; model < layout.models(); ++model) {
    for (; column < layout.columns(model); ++column)
      for (const ColumnStatistics& channel : channels)
        error += error_change(channel, column, factor[column], first_stage);
    errors[static_cast<std::size_t>(model)] = error;
  }
  return errors;
}

}  // namespace

double error_change(const ColumnStatistics& channel, int column, double g, bool first_stage) {
  const auto a = static_cast<std::size_t>(column);
  return g * g * channel.variance[a] - (2 * g - g * g) * selection_energy(channel, a, first_stage);
}

double shrinkage_factor(const Channels& channels, int begin, int end, bool first_stage) {
  if (begin == 0) return 1;
  double energy = 0, noise = 0;
  for (const ColumnStatistics& channel : channels)
    for (auto a = static_cast<std::size_t>(begin); a < static_cast<std::size_t>(end); ++a) {
      energy += selection_energy(channel, a, first_stage);
      noise += channel.variance[a];
    }
  return energy > 0 ? energy / (energy + noise) : 0;
}

namespace {

/// A factor for each feature and one for all Taylor terms of an order; see select_order.
std::array<double, BasisLayout::max_columns> shrinkage_factors(const Channels& channels, const BasisLayout& layout,
                                                               bool first_stage) {
  std::array<double, BasisLayout::max_columns> factors{};
  const int features_end = 1 + layout.features();
  for (int a = 0; a < features_end; ++a)
    factors[static_cast<std::size_t>(a)] = shrinkage_factor(channels, a, a + 1, first_stage);
  for (int order = 1; order <= layout.order(); ++order) {
    const int begin = layout.columns(order), end = layout.columns(order + 1);
    std::fill(factors.begin() + begin, factors.begin() + end, shrinkage_factor(channels, begin, end, first_stage));
  }
  return factors;
}

/// The share of each model in the average, by how far its error lies above the least one. Shares sum to 1.
std::array<double, BasisLayout::max_models> model_shares(const std::array<double, BasisLayout::max_models>& errors,
                                                         const Channels& channels, int models, double tolerance) {
  const double least = *std::min_element(errors.begin(), errors.begin() + models);
  double scale = std::max(least, 0.0);
  for (const ColumnStatistics& channel : channels) scale += channel.variance[0];
  scale *= tolerance;
  std::array<double, BasisLayout::max_models> shares{};
  double total = 0;
  for (std::size_t m = 0; m < static_cast<std::size_t>(models); ++m) {
    shares[m] = share_near_best(errors[m] - least, scale);
    total += shares[m];
  }
  for (double& share : shares) share /= total;
  return shares;
}

/// Multiplies the factor of each column by the shares of the models that have it: those from the model that adds the
/// column on.
void weigh_columns(const std::array<double, BasisLayout::max_models>& shares, const BasisLayout& layout,
                   std::array<double, BasisLayout::max_columns>& factor) {
  double with_column = 0;
  for (int model = layout.models() - 1; model >= 0; --model) {
    with_column = std::min(with_column + shares[static_cast<std::size_t>(model)], 1.0);
    for (int a = model > 0 ? layout.columns(model - 1) : 1; a < layout.columns(model); ++a)
      factor[static_cast<std::size_t>(a)] *= with_column;
  }
}

/// Sets model and order of the choice. A model counts as the one below it where all columns that it adds have the
/// factor 0.
void set_order(const std::array<double, BasisLayout::max_models>& shares, const BasisLayout& layout,
               OrderChoice& choice) {
  double most = 0;
  int effective = 0;
  for (int model = 0; model < layout.models(); ++model) {
    const double share = shares[static_cast<std::size_t>(model)];
    const auto begin = choice.factor.begin() + (model > 0 ? layout.columns(model - 1) : 0);
    if (std::any_of(begin, choice.factor.begin() + layout.columns(model), [](double g) { return g > 0; }))
      effective = model;
    choice.order += share * BasisLayout::order_of(effective);
    if (share <= most) continue;
    most = share;
    choice.model = effective;
  }
}

}  // namespace

OrderChoice select_order(const Channels& channels, const BasisLayout& layout, double weight_sum, bool first_stage,
                         double tolerance, bool shrinkage) {
  assert(weight_sum > 0);
  OrderChoice choice;
  if (shrinkage)
    choice.factor = shrinkage_factors(channels, layout, first_stage);
  else
    choice.factor.fill(1);
  const auto errors = nested_errors(channels, layout, choice.factor.data(), first_stage);
  std::fill(choice.factor.begin() + layout.columns(), choice.factor.end(), 0.0);
  const auto shares = model_shares(errors, channels, layout.models(), tolerance);
  weigh_columns(shares, layout, choice.factor);
  set_order(shares, layout, choice);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    double squared_bias = error_of_all(channels[c], layout, first_stage), variance = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(layout.columns()); ++a) {
      const double g = choice.factor[a];
      squared_bias += (1 - g) * (1 - g) * error_energy(channels[c], a, first_stage);
      variance += g * g * channels[c].variance[a];
    }
    choice.variance[c] = variance / weight_sum;
    choice.error[c] = (std::max(squared_bias, 0.0) + variance) / weight_sum;  // the estimate may be negative
  }
  return choice;
}

}  // namespace polyrecon
