// Solves of some unknowns against solves of all.
#include "precompute/fem/factor_part.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "precompute/fem/cholesky_factor.h"
#include "tests/precompute/fem/lattice.h"

namespace palpate {
namespace {

// Unknowns of a corner of the lattice.
std::vector<std::int64_t> corner(int side, int x, int y) {
  std::vector<std::int64_t> unknowns;
  for (std::int64_t i = 0; i < std::int64_t{side} * side * side; ++i) {
    if (i % side < x && (i / side) % side < y) {
      unknowns.push_back(i);
    }
  }
  return unknowns;
}

// Solves for random loads on the unknowns, by the part and by the whole factor.
void expect_same(const CholeskyFactor& factor,
                 const std::vector<std::int64_t>& unknowns) {
  const FactorPart part = factor.part(unknowns);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(factor.size(), 3);
  SolveRows some = SolveRows::Zero(part.size(), solve_width(3));
  for (const std::int64_t i : unknowns) {
    const std::int64_t row = part.row()[static_cast<std::size_t>(i)];
    ASSERT_GE(row, 0);
    for (int k = 0; k < 3; ++k) {
      whole(i, k) = uniform(random);
      some(row, k) = whole(i, k);
    }
  }
  const Eigen::MatrixXd again = factor.solve(whole);
  Eigen::VectorXd one = some.col(1);
  part.solve(some);
  part.solve(one);
  for (const std::int64_t i : unknowns) {
    const std::int64_t row = part.row()[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(some(row, k), again(i, k));
    }
    EXPECT_NEAR(one[row], again(i, 1), 1e-13 * again.cwiseAbs().maxCoeff());
  }
}

constexpr int kSide = 12;

TEST(FactorPart, SolvesForItsUnknownsAsTheWholeDoes) {
  const Stiffness K = lattice(kSide);
  const CholeskyFactor factor(K);
  expect_same(factor, corner(kSide, 4, 5));
  expect_same(factor, {0});
  expect_same(factor, {K.rows() - 1, 0, 700});
  expect_same(factor, corner(kSide, kSide, kSide));
}

TEST(FactorPart, GrowsWithItsUnknowns) {
  const Stiffness K = lattice(kSide);
  const CholeskyFactor factor(K);
  auto unknowns = corner(kSide, 4, 5);
  const FactorPart part = factor.part(unknowns);
  EXPECT_LT(part.size(), K.rows() / 2);
  unknowns.push_back(K.rows() - 1);
  EXPECT_GT(factor.part(unknowns).size(), part.size());
  EXPECT_LT(factor.part(unknowns).size(), K.rows());
  EXPECT_EQ(factor.part(corner(kSide, kSide, kSide)).nonzeros(),
            factor.factor_nonzeros());
}

TEST(FactorPart, WhatSingleSolvesReadPastTheLastRowIsFinite) {
  const CholeskyFactor factor(in_blocks(lattice(6)));
  const FactorPart part = factor.part(std::vector<std::int64_t>{0, 100, 400});
  const SupernodeView all = part.supernodes();
  for (std::ptrdiff_t s = 0; s < all.count; ++s) {
    const std::int64_t count =
        (all.row_begin[s + 1] - all.row_begin[s]) * (all.begin[s + 1] - all.begin[s]);
    for (std::int64_t i = 0; i < count + kSolveWidth; ++i) {
      ASSERT_TRUE(std::isfinite(all.number[s][i])) << s << " " << i;
    }
  }
}

TEST(FactorPart, RoundedSolvesWithinItsRounding) {
  const auto near = corner(kSide, 4, 5);
  const CholeskyFactor factor(lattice(kSide));
  const FactorPart part = factor.part(near);
  const FactorPart rounded = part.rounded();
  EXPECT_EQ(rounded.row(), part.row());
  Eigen::VectorXd exact = Eigen::VectorXd::Random(part.size());
  Eigen::VectorXd rough = exact;
  part.solve(exact);
  rounded.solve(rough);
  // 6e-8, the rounding of a float, times what the matrix makes of it.
  EXPECT_LT((rough - exact).norm(), 1e-6 * exact.norm());
  EXPECT_GT((rough - exact).norm(), 1e-9 * exact.norm());
}

TEST(FactorPart, PassesOverHeldUnknowns) {
  const CholeskyFactor factor(lattice(4));
  EXPECT_EQ(factor.part(std::vector<std::int64_t>{-1}).size(), 0);
}

}  // namespace
}  // namespace palpate
