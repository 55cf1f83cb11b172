#include "precompute/press/coupling_modes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace palpate {
namespace {

constexpr int kRounds = 40;         // of filling in what is near
constexpr int kPowers = 4;          // of subspace iteration in a round
constexpr Eigen::Index kSpare = 8;  // columns more than modes

struct Modes {
  Eigen::VectorXd value;   // (m) [m/N] by size, the largest first
  Eigen::MatrixXd vector;  // (n x m) orthonormal
};

// The largest eigenpairs by subspace iteration with Rayleigh-Ritz steps.
// @param Q (n x m) start.
Modes largest_modes(const Eigen::MatrixXd& E, Eigen::MatrixXd Q) {
  Modes modes;
  for (int power = 0; power < kPowers; ++power) {
    Q = E * Q;
    Q = Eigen::HouseholderQR<Eigen::MatrixXd>(Q).householderQ() *
        Eigen::MatrixXd::Identity(Q.rows(), Q.cols());
  }
  // Rayleigh-Ritz: eigenpairs of E within the span of Q.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(Q.transpose() * (E * Q));
  std::vector<Eigen::Index> order(static_cast<std::size_t>(Q.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(ritz.eigenvalues()[a]) > std::abs(ritz.eigenvalues()[b]);
  });
  modes.value = ritz.eigenvalues()(order);
  modes.vector = Q * ritz.eigenvectors()(Eigen::all, order);
  return modes;
}

// Added ones first.
void keep(const Modes& modes, Eigen::Index count, std::span<const std::int32_t> node,
          ComplianceTable& table) {
  table.mode.setZero(table.value.rows(), count);
  table.added_modes = (modes.value.head(count).array() > 0.0).count();
  Eigen::Index added = 0;
  Eigen::Index subtracted = table.added_modes;
  for (Eigen::Index m = 0; m < count; ++m) {
    const Eigen::Index column = modes.value[m] > 0.0 ? added++ : subtracted++;
    const double scale = std::sqrt(std::abs(modes.value[m]));
    for (std::size_t i = 0; i < node.size(); ++i) {
      table.mode(node[i], column) =
          static_cast<float>(scale * modes.vector(static_cast<Eigen::Index>(i), m));
    }
  }
}

}  // namespace

void add_modes(const Eigen::MatrixXd& compliance_m_per_n,
               std::span<const std::int32_t> node, const Points& position_m,
               ComplianceTable& table) {
  const auto n = std::ssize(node);
  const Eigen::Index count = std::min<Eigen::Index>(kMostModes, n);
  const ComplianceKnots knots = knots_of(table);
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(n, n);
  std::vector<std::pair<Eigen::Index, Eigen::Index>> near;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const std::int32_t v = node[static_cast<std::size_t>(i)];
      const std::int32_t w = node[static_cast<std::size_t>(j)];
      const double r = (position_m.row(v) - position_m.row(w)).norm();
      if (r < knots.first_m) {
        near.emplace_back(i, j);
        continue;
      }
      const double missed =
          0.5 * (compliance_m_per_n(i, j) + compliance_m_per_n(j, i)) -
          node_coupling_m_per_n(table, knots, v, w, r);
      E(i, j) = missed;
      E(j, i) = missed;
    }
  }
  // Columns of the matrix itself span what its modes do; a few more find them sooner.
  const Eigen::Index width = std::min(count + kSpare, n);
  Eigen::MatrixXd start(n, width);
  for (Eigen::Index k = 0; k < width; ++k) {
    start.col(k) = E.col(k * n / width);
    start(k * n / width, k) += 1e-3 * E.cwiseAbs().maxCoeff();
  }
  Modes modes;
  // Entries nearer than the first distance are not the table's and shall not shape the
  // modes. Each round fills them with what the modes have there.
  for (int round = 0; round < kRounds; ++round) {
    modes = largest_modes(E, start);
    start = modes.vector;
    for (const auto& [i, j] : near) {
      const double filled = (modes.vector.row(i).head(count).array() *
                             modes.value.head(count).transpose().array() *
                             modes.vector.row(j).head(count).array())
                                .sum();
      E(i, j) = filled;
      E(j, i) = filled;
    }
  }
  keep(modes, count, node, table);
}

}  // namespace palpate
