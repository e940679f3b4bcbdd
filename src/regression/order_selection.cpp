#include "regression/order_selection.h"

#include <algorithm>
#include <cassert>

#include "core/near_best.h"

namespace polyrecon {
namespace {

using Channels = std::array<ColumnStatistics, 3>;

/// The error of the empty model, whose bias is all of mu: |S mu|^2 as the stage guesses it.
double error_of_nothing(const ColumnStatistics& channel, bool first_stage) {
  return first_stage ? channel.guess_energy - channel.noise_energy : channel.guess_energy;
}

/// Estimated error of every model, summed over the channels: one pass over the columns.
std::array<double, BasisLayout::max_models> nested_errors(const Channels& channels, const BasisLayout& layout,
                                                          const double* factor, bool first_stage) {
  std::array<double, BasisLayout::max_models> errors{};
  double error = 0;
  for (const ColumnStatistics& channel : channels) error += error_of_nothing(channel, first_stage);
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
  const double n = channel.variance[a];
  if (first_stage) return 2 * g * n - (2 * g - g * g) * channel.z[a] * channel.z[a];
  return g * g * n - (2 * g - g * g) * channel.guess[a] * channel.guess[a];
}

double shrinkage_factor(const Channels& channels, int begin, int end, bool first_stage) {
  if (begin == 0) return 1;
  double energy = 0, noise = 0;
  for (const ColumnStatistics& channel : channels)
    for (auto a = static_cast<std::size_t>(begin); a < static_cast<std::size_t>(end); ++a) {
      energy += first_stage ? channel.z[a] * channel.z[a] : channel.guess[a] * channel.guess[a];
      noise += channel.variance[a];
    }
  if (!(energy > 0)) return 0;
  return first_stage ? std::max(0.0, 1 - noise / energy) : energy / (energy + noise);
}

namespace {

/// Features have a factor each, the Taylor terms of one order share theirs.
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

/// How much each model counts: by how far its error lies above the least one.
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

/// A column is in every model from the one it comes with on: its factor times what those count for.
void weigh_columns(const std::array<double, BasisLayout::max_models>& shares, const BasisLayout& layout,
                   std::array<double, BasisLayout::max_columns>& factor) {
  double with_column = 0;
  for (int model = layout.models() - 1; model >= 0; --model) {
    with_column = std::min(with_column + shares[static_cast<std::size_t>(model)], 1.0);
    for (int a = model > 0 ? layout.columns(model - 1) : 1; a < layout.columns(model); ++a)
      factor[static_cast<std::size_t>(a)] *= with_column;
  }
}

/// Sets model and order. A model all of whose own columns have the factor 0 is the one below.
void tell_order(const std::array<double, BasisLayout::max_models>& shares, const BasisLayout& layout,
                OrderChoice& choice) {
  double most = 0;
  int same = 0;
  for (int model = 0; model < layout.models(); ++model) {
    const double share = shares[static_cast<std::size_t>(model)];
    const auto begin = choice.factor.begin() + (model > 0 ? layout.columns(model - 1) : 0);
    if (std::any_of(begin, choice.factor.begin() + layout.columns(model), [](double g) { return g > 0; })) same = model;
    choice.order += share * BasisLayout::order_of(same);
    if (share <= most) continue;
    most = share;
    choice.model = same;
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
  tell_order(shares, layout, choice);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    double error = error_of_nothing(channels[c], first_stage), variance = 0;
    for (int a = 0; a < layout.columns(); ++a) {
      const double g = choice.factor[static_cast<std::size_t>(a)];
      error += error_change(channels[c], a, g, first_stage);
      variance += g * g * channels[c].variance[static_cast<std::size_t>(a)];
    }
    choice.variance[c] = variance / weight_sum;
    choice.error[c] = std::max(error, variance) / weight_sum;  // bias^2 is not negative, its estimate may be
  }
  return choice;
}

}  // namespace polyrecon
