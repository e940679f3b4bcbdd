#include "prior/sharpen.h"

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "core/real.h"

namespace polyrecon {
namespace {

/// The prior is fully sharpened where k1 for L1 alone is below this, and in proportion to k1 between this and 0, so
/// that rounding does not decide whether it is sharpened.
constexpr double clear_slope = -0.01;

/// The Laplacian L_d at a pixel; see sharpen.h.
double laplacian(const Image& image, int x, int y, int c, int d) {
  const auto at = [&](int u, int v) {
    return static_cast<double>(image.at(std::clamp(u, 0, image.width() - 1), std::clamp(v, 0, image.height() - 1), c));
  };
  return at(x - d, y) + at(x + d, y) + at(x, y - d) + at(x, y + d) - 4 * at(x, y);
}

/// Normal equations of f = g p + k1 L1 p + k2 L2 p, where g absorbs the difference in brightness.
struct NormalEquations {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();

  void add_row(const Image& prior, const Image& reconstruction, int y, double epsilon) {
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < prior.width(); ++x) {
        const double p = prior.at(x, y, c), f = reconstruction.at(x, y, c),
                     weight = 1 / (std::max(p * p, f * f) + epsilon);
        const Eigen::Vector3d column(p, laplacian(prior, x, y, c, 1), laplacian(prior, x, y, c, 2));
        gram += weight * column * column.transpose();
        right += weight * f * column;
      }
  }

  /// Coefficients of the first columns alone; not finite where these depend on each other.
  Eigen::VectorXd solve(int columns) const {
    return gram.topLeftCorner(columns, columns).ldlt().solve(right.head(columns));
  }
};

NormalEquations normal_equations(const Image& prior, const Image& reconstruction, double epsilon) {
  std::vector<NormalEquations> rows(static_cast<std::size_t>(prior.height()));
  for_rows(prior.height(),
           [&](int y) { rows[static_cast<std::size_t>(y)].add_row(prior, reconstruction, y, epsilon); });
  NormalEquations sum;
  for (const NormalEquations& row : rows) {
    sum.gram += row.gram;
    sum.right += row.right;
  }
  return sum;
}

}  // namespace

Image sharpen_to(Image prior, const Image& reconstruction, double epsilon) {
  const NormalEquations equations = normal_equations(prior, reconstruction, epsilon);
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
