#include "precompute/contact/complementarity.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>

namespace palpate {
namespace {

// Forces that close the gap exactly on the active nodes, zero elsewhere.
Eigen::VectorXd forces_of(const Eigen::MatrixXd& A, const Eigen::VectorXd& t,
                          const std::vector<char>& active) {
  std::vector<Eigen::Index> in;
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (active[i] != 0) {
      in.push_back(static_cast<Eigen::Index>(i));
    }
  }
  Eigen::VectorXd f = Eigen::VectorXd::Zero(t.size());
  if (!in.empty()) {
    const Eigen::MatrixXd Aii = A(in, in);
    const Eigen::VectorXd ti = t(in);
    const Eigen::VectorXd closing = Aii.ldlt().solve(-ti);
    f(in) = closing;
  }
  return f;
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
    f = forces_of(A, t, active);
    const Eigen::VectorXd w = A * f + t;
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
