#include "presets/pareto.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace polyrecon {

std::vector<std::size_t> pareto_front(const std::vector<CostPoint>& points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].seconds) && std::isfinite(points[i].error) && points[i].seconds > 0 &&
        points[i].error > 0)
      order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (points[a].seconds != points[b].seconds) return points[a].seconds < points[b].seconds;
    if (points[a].error != points[b].error) return points[a].error < points[b].error;
    return a < b;
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order)
    if (front.empty() || points[i].error < points[front.back()].error) front.push_back(i);
  return front;
}

double price_of_ten_percent(const CostPoint& cheap, const CostPoint& dear) {
  assert(cheap.seconds <= dear.seconds && cheap.error > dear.error);
  return std::pow(dear.seconds / cheap.seconds, std::log(0.9) / std::log(dear.error / cheap.error));
}

}  // namespace polyrecon
