#pragma once

#include <cstddef>
#include <vector>

namespace polyrecon {

/// What something cost and what error is left.
struct CostPoint {
  double seconds = 0;
  double error = 0;  ///< relMSE
};

/// Indices of the points that no other one beats in both seconds and error, by growing seconds. Points that are not
/// finite and positive in both take no part.
std::vector<std::size_t> pareto_front(const std::vector<CostPoint>& points);

/// Factor in seconds that 10 % less error costs between two points of the front, if error falls as a power of the time
/// between them: (t2 / t1)^(log 0.9 / log(e2 / e1)). cheap is faster and has the larger error.
double price_of_ten_percent(const CostPoint& cheap, const CostPoint& dear);

}  // namespace polyrecon
