#include "precompute/contact/complementarity.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>

#include "precompute/fem/dense_cholesky.h"

namespace palpate {
namespace {

using Indices = std::vector<Eigen::Index>;

// Which nodes bear forces, and which do not; both ascend.
struct Sides {
  Indices in, out;

  explicit Sides(const std::vector<char>& active) {
    for (std::size_t i = 0; i < active.size(); ++i) {
      (active[i] != 0 ? in : out).push_back(static_cast<Eigen::Index>(i));
    }
  }
};

// Forces that close the gap exactly on the active nodes, zero elsewhere.
Eigen::VectorXd closing_forces(const Eigen::MatrixXd& A, const Eigen::VectorXd& t,
                               const Sides& sides) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(t.size());
  if (!sides.in.empty()) {
    const Eigen::MatrixXd Aii = A(sides.in, sides.in);
    const Eigen::VectorXd ti = t(sides.in);
    const DenseCholesky factor(Aii);
    f(sides.in) = factor.is_definite() ? factor.solve(-ti)
                                       : Eigen::VectorXd(Aii.ldlt().solve(-ti));
  }
  return f;
}

// Gaps that are left on the nodes without forces; zero elsewhere.
Eigen::VectorXd gaps_of(const Eigen::MatrixXd& A, const Eigen::VectorXd& t,
                        const Eigen::VectorXd& f, const Sides& sides) {
  Eigen::VectorXd left = t;
  for (const Eigen::Index j : sides.in) {
    left += f[j] * A.col(j);
  }
  left(sides.in).setZero();
  return left;
}

}  // namespace

ComplementarityReport solve_complementarity(const Eigen::MatrixXd& A,
                                            const Eigen::VectorXd& t,
                                            Eigen::VectorXd& f) {
  const Eigen::Index n = t.size();
  constexpr int kBlocksWithoutProgress = 3;
  const int most_iterations = 100 + 20 * static_cast<int>(n);
  // Rounding of w and f: relative to the largest gap, and to the force that closes it.
  const double gap_scale = t.cwiseAbs().maxCoeff();
  const double gap_tolerance = 1e-13 * gap_scale;
  const double force_tolerance = 1e-13 * gap_scale / A.diagonal().maxCoeff();

  std::vector<char> active(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    active[static_cast<std::size_t>(i)] = f[i] > 0.0 ? 1 : 0;
  }
  ComplementarityReport report;
  Eigen::Index fewest = std::numeric_limits<Eigen::Index>::max();
  int blocks_left = kBlocksWithoutProgress;
  while (report.iterations < most_iterations) {
    ++report.iterations;
    const Sides sides(active);
    f = closing_forces(A, t, sides);
    const Eigen::VectorXd w = gaps_of(A, t, f, sides);
    std::vector<std::size_t> infeasible;
    report.residual = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (active[at] != 0 ? f[i] < -force_tolerance : w[i] < -gap_tolerance) {
        infeasible.push_back(at);
        report.residual = std::max(report.residual, -w[i]);
      }
    }
    if (infeasible.empty()) {
      f = f.cwiseMax(0.0);
      report.converged = true;
      return report;
    }
    const auto count = static_cast<Eigen::Index>(infeasible.size());
    if (count < fewest) {
      fewest = count;
      blocks_left = kBlocksWithoutProgress;
    } else {
      --blocks_left;
    }
    if (blocks_left > 0) {
      for (const std::size_t i : infeasible) {
        active[i] ^= 1;
      }
    } else {
      active[infeasible.back()] ^= 1;
    }
  }
  return report;
}

}  // namespace palpate
