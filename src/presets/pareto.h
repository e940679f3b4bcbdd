#pragma once

#include <cstddef>
#include <vector>

namespace polyrecon {

/// Time and error of a setting.
struct CostPoint {
  double seconds = 0;
  double error = 0;  ///< relMSE
};

/// Indices of the points that no other one beats in both time and error, in order of time. Points that are not finite
/// and positive in both are ignored.
std::vector<std::size_t> pareto_front(const std::vector<CostPoint>& points);

/// The factor in time that 10 % less error costs between two points of the front, if the error falls as a power of the
/// time: (t2 / t1)^(log 0.9 / log(e2 / e1)). cheap is the faster point, with the larger error.
double price_of_ten_percent(const CostPoint& cheap, const CostPoint& dear);

}  // namespace polyrecon
