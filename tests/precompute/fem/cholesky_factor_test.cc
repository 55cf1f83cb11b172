// Solves of near unknowns against solves of all.
#include "precompute/fem/cholesky_factor.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "formats/base/error.h"
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
void expect_same(const CholeskyFactor& factor, const CholeskyFactor& plain,
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
  const Eigen::MatrixXd expected = plain.solve(whole);
  const Eigen::MatrixXd again = factor.solve(whole);
  Eigen::VectorXd one = some.col(1);
  part.solve(some);
  part.solve(one);
  EXPECT_LT((again - expected).norm(), 1e-12 * expected.norm());
  for (const std::int64_t i : unknowns) {
    const std::int64_t row = part.row()[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(some(row, k), again(i, k));
    }
    EXPECT_NEAR(one[row], again(i, 1), 1e-13 * expected.cwiseAbs().maxCoeff());
  }
}

constexpr int kSide = 12;

TEST(CholeskyFactor, APartSolvesForItsUnknownsAsTheWholeDoes) {
  const Stiffness K = lattice(kSide);
  const CholeskyFactor plain(K);
  expect_same(plain, plain, corner(kSide, 4, 5));
  expect_same(plain, plain, {0});
  expect_same(plain, plain, {K.rows() - 1, 0, 700});
  expect_same(plain, plain, corner(kSide, kSide, kSide));
  EXPECT_LT(plain.part(std::vector<std::int64_t>{0}).size(), K.rows());
  EXPECT_EQ(plain.part(corner(kSide, kSide, kSide)).nonzeros(),
            plain.factor_nonzeros());
}

TEST(CholeskyFactor, NearUnknownsHaveASmallPartAndMoreOfThemALargerOne) {
  const Stiffness K = lattice(kSide);
  const auto near = corner(kSide, 4, 5);
  const CholeskyFactor plain(K);
  const CholeskyFactor factor(K, near);
  const FactorPart part = factor.part(near);
  EXPECT_LT(part.size(), K.rows() / 2);
  EXPECT_LT(part.nonzeros(), plain.part(near).nonzeros());
  expect_same(factor, plain, near);
  auto more = near;
  more.push_back(K.rows() - 1);
  EXPECT_GT(factor.part(more).size(), part.size());
  EXPECT_LT(factor.part(more).size(), K.rows());
  expect_same(factor, plain, more);
}

TEST(CholeskyFactor, WhatSingleSolvesReadPastTheLastRowIsFinite) {
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

TEST(CholeskyFactor, ARoundedPartSolvesWithinItsRounding) {
  const auto near = corner(kSide, 4, 5);
  const CholeskyFactor factor(lattice(kSide), near);
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

TEST(CholeskyFactor, SolvesWhatTheMatrixMultiplied) {
  for (const Stiffness& K : {lattice(7), in_blocks(lattice(7))}) {
    const CholeskyFactor factor(K);
    for (const int columns : {1, 2, 8, 70}) {
      const Eigen::MatrixXd X = Eigen::MatrixXd::Random(K.rows(), columns);
      const Eigen::MatrixXd B = K.selfadjointView<Eigen::Lower>() * X;
      EXPECT_LT((factor.solve(B) - X).norm(), 1e-13 * X.norm()) << columns;
    }
  }
}

// A column's answer does not depend on those that are solved beside it.
TEST(CholeskyFactor, ColumnsAreByThemselves) {
  const Stiffness K = in_blocks(lattice(6));
  const CholeskyFactor factor(K, std::vector<std::int64_t>{0, 1, 2, 30, 31, 32});
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(K.rows(), 70);
  const Eigen::MatrixXd X = factor.solve(B);
  for (const int first : {0, 13, 61}) {
    EXPECT_EQ(factor.solve(B.middleCols(first, 9)), X.middleCols(first, 9));
  }
}

TEST(CholeskyFactor, RefusesWhatIsNotDefinite) {
  Stiffness K = in_blocks(lattice(4));
  K.coeffRef(30, 30) = -1.0;
  EXPECT_THROW(CholeskyFactor{K}, NumericalError);
}

TEST(CholeskyFactor, HeldUnknownsArePassedOver) {
  const CholeskyFactor factor(lattice(4));
  EXPECT_EQ(factor.part(std::vector<std::int64_t>{-1}).size(), 0);
}

}  // namespace
}  // namespace palpate
