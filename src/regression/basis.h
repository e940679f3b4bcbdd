#pragma once

#include <cassert>

namespace polyrecon {

/// The columns of the local model (2), in nested groups, so that every prefix of whole groups is a model by itself:
///     constant | features minus their value at the centre | order 1 | order 2 | ...
/// Model 0 is the constant alone; model m >= 1 has the features and all Taylor terms up to order m - 1.
class BasisLayout {
 public:
  static constexpr int max_order = 4;
  static constexpr int max_features = 16;                    ///< Feature channels.
  static constexpr int max_columns = 1 + max_features + 14;  // 2 + 3 + 4 + 5 Taylor terms of orders 1 to 4
  static constexpr int max_models = max_order + 2;

  BasisLayout(int features, int order) : features_(features), order_(order) {
    assert(features >= 0 && features <= max_features && order >= 0 && order <= max_order);
  }

  int features() const { return features_; }
  int order() const { return order_; }
  int models() const { return order_ + 2; }
  /// Number of columns of a model.
  int columns(int model) const { return model == 0 ? 1 : 1 + features_ + taylor_terms(model - 1); }
  int columns() const { return columns(models() - 1); }
  /// Taylor order k of a model; 0 for the constant alone.
  static int order_of(int model) { return model == 0 ? 0 : model - 1; }
  /// Terms of orders 1 to k in two variables: 2 + 3 + ... + (k + 1).
  static int taylor_terms(int k) { return k * (k + 3) / 2; }

 private:
  int features_, order_;
};

}  // namespace polyrecon
