// Solves of near unknowns against solves of all.
#include "precompute/cholesky_factor.h"

#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// A stiff lattice of n^3 unknowns with a little more on the diagonal.
Stiffness lattice(int n) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  const auto at = [&](int x, int y, int z) {
    return std::int64_t{x} + n * (std::int64_t{y} + n * std::int64_t{z});
  };
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        entries.emplace_back(at(x, y, z), at(x, y, z), 6.1 + 0.1 * x);
        if (x + 1 < n)
          entries.emplace_back(at(x + 1, y, z), at(x, y, z), -1.0);
        if (y + 1 < n)
          entries.emplace_back(at(x, y + 1, z), at(x, y, z), -1.0);
        if (z + 1 < n)
          entries.emplace_back(at(x, y, z + 1), at(x, y, z), -1.0);
      }
    }
  }
  Stiffness lower(n * n * n, n * n * n);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

TEST(CholeskyFactor, NearSolvesAreTheNearRowsOfWholeOnes) {
  constexpr int kSide = 12;
  const Stiffness K = lattice(kSide);
  std::vector<std::int64_t> near;
  for (std::int64_t i = 0; i < K.rows(); ++i) {
    if (i % kSide < 4 && (i / kSide) % kSide < 5) {
      near.push_back(i);
    }
  }
  const CholeskyFactor plain(K);
  const CholeskyFactor factor(K, near);
  ASSERT_GE(factor.near_size(), static_cast<Eigen::Index>(near.size()));
  EXPECT_LT(factor.near_size(), K.rows() / 2);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(K.rows(), 3);
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(factor.near_size(), 3);
  for (const std::int64_t i : near) {
    const std::int64_t row = factor.near_row()[static_cast<std::size_t>(i)];
    ASSERT_GE(row, 0);
    for (int k = 0; k < 3; ++k) {
      whole(i, k) = uniform(random);
      part(row, k) = whole(i, k);
    }
  }
  const Eigen::MatrixXd expected = plain.solve(whole);
  const Eigen::MatrixXd again = factor.solve(whole);
  const Eigen::MatrixXd found = factor.solve_near(part);
  EXPECT_LT((again - expected).norm(), 1e-12 * expected.norm());
  for (const std::int64_t i : near) {
    const std::int64_t row = factor.near_row()[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(found(row, k), expected(i, k), 1e-12);
    }
  }
}

TEST(CholeskyFactor, WithoutNearUnknownsThereIsNoNearSolve) {
  const CholeskyFactor factor(lattice(4));
  EXPECT_TRUE(factor.near_row().empty());
  EXPECT_EQ(factor.near_size(), 0);
}

}  // namespace
}  // namespace palpate
