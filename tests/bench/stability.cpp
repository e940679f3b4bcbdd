// Measures how well the windows of real renders are conditioned, and the effect of the limits in
// regression/least_squares.h: stability FOLDER RENDER REFERENCE [RENDER REFERENCE]... writes into FOLDER
//   windows.csv  one row per window: its condition number and the residual ratio of each solver
//   columns.csv  one row per column: its remainder, and its largest inner product with the columns before it
//   limits.csv   one row per setting of the limits: the error of the fits against the reference
// The windows are those of stage 1 around every 8th pixel in both directions, with the bandwidths of both stages.
// tests/bench/stability.py runs this program and draws the figures of docs/dev/stability.md.
#include <Eigen/Dense>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

#include "blend/blend_windows.h"
#include "core/rect.h"
#include "core/relmse.h"
#include "features/prepare.h"
#include "noise/variance.h"
#include "polyrecon/params.h"
#include "polyrecon/read_frame.h"
#include "regression/least_squares.h"
#include "regression/order_selection.h"
#include "regression/weights.h"
#include "support/regression.h"

namespace polyrecon {
namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

constexpr int step = 8;
constexpr double eps = std::numeric_limits<Real>::epsilon();
const Params params;

/// A window with its weights, and S X and S y in double.
struct Weighed {
  Window window;
  std::vector<Real> weight;
  double weight_sum = 0;
  MatrixXd sx;
  VectorXd s, sy;
};

MatrixXd columns_of(const std::vector<Real>& values, int columns, const Window& window) {
  MatrixXd m(window.count, columns);
  for (int a = 0; a < columns; ++a)
    for (int j = 0; j < window.count; ++j)
      m(j, a) = static_cast<double>(values[static_cast<std::size_t>(a * window.stride + j)]);
  return m;
}

/// Calls use(window) for windows all over the image, for each half and each bandwidth.
void each_window(const HalfPair& pair, const std::function<void(Weighed&)>& use) {
  const BasisLayout layout(pair.features[0].channels(), params.max_order);
  Weighed w;
  w.window.reserve(params.radius, layout.columns(), 3);
  w.weight.resize(static_cast<std::size_t>(w.window.stride));
  PatchDistances distances;
  for (std::size_t h = 0; h < 2; ++h) {
    const WindowSource source{&pair.color[h], &pair.variance, &pair.features[1 - h], nullptr};
    for (const Rect& block : aligned_blocks(pair.variance.bounds(), block_size)) {
      distances.load(pair.color[1 - h], pair.variance, block, params.radius, params.patch);
      for (int y = block.y0; y < block.y1; y += step)
        for (int x = block.x0; x < block.x1; x += step)
          for (const Real bandwidth : params.later_bandwidths) {
            distances.window_of(x, y, {cut_exponent * bandwidth * bandwidth}, w.window);
            if (w.window.count == 0) continue;
            gather(source, layout, x, y, params.radius, w.window);
            w.weight_sum = kernel_weights(w.window, bandwidth, w.weight.data());
            w.s = columns_of(w.weight, 1, w.window).col(0).cwiseSqrt();
            w.sx = w.s.asDiagonal() * test::rows_of(w.window.design, w.window.layout.columns(), w.window);
            w.sy = w.s.asDiagonal() * columns_of(w.window.response, 3, w.window).col(1);
            use(w);
          }
    }
  }
}

/// Largest over smallest singular value of S X with its columns scaled to length 1.
double condition_of(const MatrixXd& sx) {
  MatrixXd scaled = sx;
  for (int a = 0; a < sx.cols(); ++a) scaled.col(a) /= std::max(sx.col(a).norm(), std::numeric_limits<double>::min());
  const VectorXd values = Eigen::JacobiSVD<MatrixXd>(scaled).singularValues();
  return scaled.rows() < scaled.cols() ? HUGE_VAL : values(0) / values(values.size() - 1);
}

/// LAPACK's ratio for a least squares solution (xQRT17). A value below 30 is as good as the arithmetic allows.
double residual_ratio(const Weighed& w, const MatrixXd& sx, const VectorXd& residual) {
  const double scale = sx.norm() * w.sy.norm() * static_cast<double>(sx.rows()) * eps;
  return scale > 0 ? (sx.transpose() * residual).norm() / scale : 0;
}

/// The problem that factorise solves, with rows for the penalties.
test::Penalised problem_of(const Weighed& w, const DependenceLimits& limits) {
  const auto columns = static_cast<int>(w.sx.cols());
  return test::penalised(test::rows_of(w.window.design, columns, w.window), w.s.cwiseAbs2(), limits,
                         w.window.layout.features());
}

double ours(const Weighed& w, const DependenceLimits& limits, NestedFactor& factor) {
  const int columns = static_cast<int>(w.sx.cols());
  factorise(w.window, columns, w.weight.data(), factor, limits);
  VectorXd z(columns);
  project(factor, w.window, w.weight.data(), w.window.response.data() + w.window.stride, z.data());
  const test::Penalised problem = problem_of(w, limits);
  VectorXd residual(problem.augmented.rows());
  residual << w.sy - w.s.asDiagonal() * (test::q_of(factor, w.window) * z), -problem.tail * z;
  return residual_ratio(w, problem.augmented, residual);
}

template <typename Scalar>
double normal_equations(const Weighed& w) {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix sx = w.sx.cast<Scalar>(), gram = sx.transpose() * sx, right = sx.transpose() * w.sy.cast<Scalar>();
  const VectorXd c = gram.llt().solve(right).template cast<double>();
  return residual_ratio(w, w.sx, w.sy - w.sx * c);
}

double householder(const Weighed& w) {
  const MatrixXf sx = w.sx.cast<float>(), sy = w.sy.cast<float>();
  const VectorXd c = sx.householderQr().solve(sy).cast<double>();
  return residual_ratio(w, w.sx, w.sy - w.sx * c);
}

/// For each column of Q, penalty rows included, the largest inner product with a column before it.
VectorXd overlaps(const Weighed& w, const NestedFactor& factor, const DependenceLimits& limits) {
  const MatrixXd q = w.s.asDiagonal() * test::q_of(factor, w.window), tail = problem_of(w, limits).tail;
  const MatrixXd gram = q.transpose() * q + tail.transpose() * tail;
  VectorXd out = VectorXd::Zero(factor.columns);
  for (int a = 1; a < factor.columns; ++a) out(a) = gram.row(a).head(a).cwiseAbs().maxCoeff();
  return out;
}

/// The fit of stage 1, pixels x 3 channels.
MatrixXd fit_of(Weighed& w, NestedFactor& factor) {
  std::array<ColumnStatistics, 3> channels;
  double* z[3] = {channels[0].z.data(), channels[1].z.data(), channels[2].z.data()};
  double* s2[3] = {channels[0].variance.data(), channels[1].variance.data(), channels[2].variance.data()};
  project_beauty(factor, w.window, w.weight.data(), false, z, nullptr, s2);
  const VectorXd weight = w.s.cwiseAbs2();
  const MatrixXd y = columns_of(w.window.response, 3, w.window), v = columns_of(w.window.noise_variance, 3, w.window);
  for (int c = 0; c < 3; ++c) {
    channels[static_cast<std::size_t>(c)].guess_energy = weight.dot(y.col(c).cwiseAbs2());
    channels[static_cast<std::size_t>(c)].noise_energy = weight.dot(v.col(c));
  }
  const OrderChoice choice =
      select_order(channels, w.window.layout, w.weight_sum, true, params.order_tolerance, params.components.shrinkage);
  MatrixXd coefficients(factor.columns, 3);
  for (int c = 0; c < 3; ++c)
    for (int a = 0; a < factor.columns; ++a) coefficients(a, c) = choice.factor[static_cast<std::size_t>(a)] * z[c][a];
  return test::q_of(factor, w.window) * coefficients;
}

/// Sums over all windows for one setting of the limits.
struct LimitSums {
  DependenceLimits limits;
  double error = 0, weight = 0, overlap = 0;
  std::size_t columns = 0, dropped = 0;

  void add(Weighed& w, const Pass& reference, NestedFactor& factor) {
    factorise(w.window, static_cast<int>(w.sx.cols()), w.weight.data(), factor, limits);
    columns += static_cast<std::size_t>(factor.columns);
    dropped += static_cast<std::size_t>(factor.columns - factor.rank);
    overlap = std::max(overlap, overlaps(w, factor, limits).maxCoeff());
    const MatrixXd fit = fit_of(w, factor);
    const auto origin = [&](int c) { return static_cast<double>(w.window.origin[static_cast<std::size_t>(c)]); };
    for (int j = 0; j < w.window.count; ++j)
      for (int c = 0; c < 3; ++c) {
        const std::size_t at = static_cast<std::size_t>(w.window.offset[static_cast<std::size_t>(j)]);
        const double r = reference.mean.plane(c)[at], v = reference.variance.plane(c)[at],
                     d = fit(j, c) + origin(c) - r;
        const double weight_j = static_cast<double>(w.weight[static_cast<std::size_t>(j)]) / 3;
        error += weight_j * (d * d - v) / relmse_denominator(r);
        weight += weight_j;
      }
  }
};

std::vector<LimitSums> all_limits() {
  const DependenceLimits chosen;
  std::vector<LimitSums> out;
  for (const double remainder : {1e-7, 1e-4, 1e-3, 1e-2, 2e-2, 3e-2, 5e-2, 1e-1, 2e-1})
    out.push_back({{remainder, chosen.variation}});
  for (const double variation : {0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) out.push_back({{chosen.remainder, variation}});
  return out;
}

struct Tables {
  std::ofstream windows, columns, limits;
};

void tell_window(const std::string& name, const Weighed& w, Tables& tables) {
  NestedFactor chosen, all;
  const DependenceLimits none{1e-7, 0};
  const double with_hardly_any = ours(w, none, all);
  tables.windows << name << ',' << w.sx.rows() << ',' << w.sx.cols() << ',' << condition_of(w.sx) << ','
                 << ours(w, {}, chosen) << ',' << with_hardly_any << ',' << householder(w) << ','
                 << normal_equations<double>(w) << ',' << normal_equations<float>(w) << ',' << chosen.rank << '\n';
  const VectorXd of_all = overlaps(w, all, none), of_chosen = overlaps(w, chosen, {});
  const MatrixXd r = w.sx.householderQr().matrixQR();
  for (int a = 1; a < std::min(w.sx.rows(), w.sx.cols()); ++a)
    tables.columns << name << ',' << a << ',' << std::abs(r(a, a)) / w.sx.col(a).norm() << ',' << of_all(a) << ','
                   << of_chosen(a) << '\n';
}

void look_at_sample(const std::string& render, const std::string& reference_path, Tables& tables) {
  Frame frame = read_frame(render).frame;
  const Frame reference = read_frame(reference_path).frame;
  const NoiseVariance noise = noise_variance(frame, silent_progress());
  const HalfPair pair =
      prepare(frame, choose_features(frame), noise.variance, params.prefilter, false, silent_progress()).pair;
  const std::string name = render.substr(render.rfind('/') + 1, render.rfind('.') - render.rfind('/') - 1);
  std::vector<LimitSums> sums = all_limits();
  NestedFactor factor;
  each_window(pair, [&](Weighed& w) {
    tell_window(name, w, tables);
    for (LimitSums& s : sums) s.add(w, reference.beauty, factor);
  });
  for (const LimitSums& s : sums)
    tables.limits << name << ',' << s.limits.remainder << ',' << s.limits.variation << ',' << s.error / s.weight << ','
                  << s.overlap << ',' << static_cast<double>(s.dropped) / static_cast<double>(s.columns) << '\n';
}

}  // namespace
}  // namespace polyrecon

int main(int argc, char** argv) {
  if (argc < 4 || argc % 2 != 0) {
    std::fprintf(stderr, "stability FOLDER RENDER REFERENCE [RENDER REFERENCE]...\n");
    return 2;
  }
  try {
    const std::string folder = argv[1];
    polyrecon::Tables tables{std::ofstream(folder + "/windows.csv"), std::ofstream(folder + "/columns.csv"),
                             std::ofstream(folder + "/limits.csv")};
    tables.windows << "sample,rows,columns,condition,chosen,hardly any limits,QR in float,normal equations in double,"
                      "normal equations in float,rank\n";
    tables.columns << "sample,column,left,hardly any limits,limits in use\n";
    tables.limits << "sample,remainder,variation,error,overlap,dropped\n";
    for (int k = 2; k < argc; k += 2) polyrecon::look_at_sample(argv[k], argv[k + 1], tables);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
