#include "fitting/numerics/bounded_linear.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace palpate {
namespace {

std::vector<int> members(const std::vector<bool>& in) {
  std::vector<int> list;
  for (int j = 0; j < static_cast<int>(in.size()); ++j) {
    if (in[static_cast<std::size_t>(j)]) {
      list.push_back(j);
    }
  }
  return list;
}

}  // namespace

Eigen::VectorXd solve_not_negative(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                   const std::vector<bool>& not_negative) {
  // N x = A^T b (Lawson, Hanson 1974) of `passive` columns; the others stay at zero.
  const Eigen::Index p = A.cols();
  Eigen::MatrixXd N = A.transpose() * A;
  const Eigen::VectorXd right = A.transpose() * b;
  const double touch = 1e-12 * N.diagonal().maxCoeff();
  N.diagonal().array() += touch;  // columns that nothing tells apart share
  std::vector<bool> passive(static_cast<std::size_t>(p));
  for (std::size_t j = 0; j < passive.size(); ++j) {
    passive[j] = !not_negative[j];
  }
  const auto solve = [&](const std::vector<int>& free) {
    Eigen::VectorXd z = Eigen::VectorXd::Zero(p);
    const Eigen::MatrixXd part = N(free, free);
    const Eigen::VectorXd of_free = part.ldlt().solve(Eigen::VectorXd(right(free)));
    z(free) = of_free;
    return z;
  };
  Eigen::VectorXd x = solve(members(passive));
  for (Eigen::Index step = 0; step < 6 * p; ++step) {
    // 1. The column with the steepest descent b - N x joins, if it descends.
    const Eigen::VectorXd descent = right - N * x;
    Eigen::Index best = -1;
    double most = 1e-10 * right.cwiseAbs().maxCoeff();
    for (Eigen::Index j = 0; j < p; ++j) {
      if (!passive[static_cast<std::size_t>(j)] && descent[j] > most) {
        most = descent[j];
        best = j;
      }
    }
    if (best < 0) {
      break;
    }
    passive[static_cast<std::size_t>(best)] = true;
    // 2. The solution z of the joined set is taken, or as much of the way to z as
    //    leaves no value negative. Columns that reach zero leave the set.
    for (Eigen::Index inner = 0; inner <= p; ++inner) {
      const Eigen::VectorXd z = solve(members(passive));
      double share = 1.0;
      for (Eigen::Index j = 0; j < p; ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (passive[k] && not_negative[k] && z[j] <= 0.0) {
          share = std::min(share, x[j] / (x[j] - z[j]));
        }
      }
      x += share * (z - x);
      if (share >= 1.0) {
        break;
      }
      for (Eigen::Index j = 0; j < p; ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (passive[k] && not_negative[k] && x[j] <= 1e-14) {
          passive[k] = false;
          x[j] = 0.0;
        }
      }
    }
  }
  return x;
}

std::vector<double> isotonic(const std::vector<double>& values,
                             const std::vector<double>& weights) {
  // Pools of neighbours: a value that does not exceed the pool before joins that pool,
  // which takes the weighted mean.
  struct Pool {
    double value, weight;
    std::size_t members;
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < values.size(); ++i) {
    pools.push_back({values[i], weights[i], 1});
    while (pools.size() > 1 && pools[pools.size() - 2].value >= pools.back().value) {
      const Pool last = pools.back();
      pools.pop_back();
      Pool& before = pools.back();
      const double weight = before.weight + last.weight;
      before.value = (before.value * before.weight + last.value * last.weight) / weight;
      before.weight = weight;
      before.members += last.members;
    }
  }
  std::vector<double> rising;
  for (const Pool& pool : pools) {
    rising.insert(rising.end(), pool.members, pool.value);
  }
  return rising;
}

}  // namespace palpate
