#include "blend/sharpen.h"

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "core/real.h"

namespace polyrecon {
namespace {

/// From here on the slope on L1 counts whole; less sharpens in proportion, so that no rounding decides.
constexpr double clear_slope = -0.01;

/// L_d at a pixel.
double laplacian(const Image& image, int x, int y, int c, int d) {
  const auto at = [&](int u, int v) {
    return static_cast<double>(image.at(std::clamp(u, 0, image.width() - 1), std::clamp(v, 0, image.height() - 1), c));
  };
  return at(x - d, y) + at(x + d, y) + at(x, y - d) + at(x, y + d) - 4 * at(x, y);
}

/// Normal equations of own ~ g p + k1 L1 p + k2 L2 p. g takes up what the two differ by in brightness.
struct NormalEquations {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();

  void add_row(const Image& prior, const Image& own, int y, double epsilon) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < prior.width(); ++x) {
        const double p = prior.at(x, y, c), f = own.at(x, y, c), weight = 1 / (std::max(p * p, f * f) + epsilon);
        const Eigen::Vector3d column(p, laplacian(prior, x, y, c, 1), laplacian(prior, x, y, c, 2));
        gram += weight * column * column.transpose();
        right += weight * f * column;
      }
  }

  /// Coefficients of the first columns; not finite where these depend on each other.
  Eigen::VectorXd solve(int columns) const {
    return gram.topLeftCorner(columns, columns).ldlt().solve(right.head(columns));
  }
};

NormalEquations normal_equations(const Image& prior, const Image& own, double epsilon) {
  std::vector<NormalEquations> rows(static_cast<std::size_t>(prior.height()));
  for_rows(prior.height(), [&](int y) { rows[static_cast<std::size_t>(y)].add_row(prior, own, y, epsilon); });
  NormalEquations sum;
  for (const NormalEquations& row : rows) {
    sum.gram += row.gram;
    sum.right += row.right;
  }
  return sum;
}

}  // namespace

Image sharpen_to(Image prior, const Image& own, double epsilon) {
  const NormalEquations equations = normal_equations(prior, own, epsilon);
  const double slope = equations.solve(2)(1);
  const Eigen::VectorXd k = std::min(slope / clear_slope, 1.0) * equations.solve(3);
  if (!(slope < 0) || !k.allFinite()) return prior;
  Image out(prior.width(), prior.height(), 3);
  for_rows(prior.height(), [&](int y) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < prior.width(); ++x) {
        const double p = prior.at(x, y, c);
        const double sharp = p + k(1) * laplacian(prior, x, y, c, 1) + k(2) * laplacian(prior, x, y, c, 2);
        out.at(x, y, c) = storable(std::max(sharp, std::min(p, 0.0)));
      }
  });
  return out;
}

}  // namespace polyrecon
