// Y'Y of forward elimination against solves.
#include "precompute/fem/load_compliance.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/precompute/fem/lattice.h"

namespace palpate {
namespace {

using Unknowns = std::vector<std::int64_t>;

// Loads of random numbers, each on some of the unknowns, in no order; every seventh is
// empty.
LoadColumns random_loads(std::int64_t size, const Unknowns& unknowns, int count,
                         std::size_t on_each) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (int j = 0; j < count; ++j) {
    for (std::size_t i = 0; i < on_each && j % 7 != 6; ++i) {
      entries.emplace_back(unknowns[random() % unknowns.size()], j, uniform(random));
    }
  }
  LoadColumns A(size, count);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

LoadColumns on_part(const FactorPart& part, const LoadColumns& A) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (std::int64_t j = 0; j < A.cols(); ++j) {
    for (LoadColumns::InnerIterator entry(A, j); entry; ++entry) {
      entries.emplace_back(part.row()[static_cast<std::size_t>(entry.row())], j,
                           entry.value());
    }
  }
  LoadColumns some(part.size(), A.cols());
  some.setFromTriplets(entries.begin(), entries.end());
  return some;
}

// Both sum up some thousand products in other orders.
void expect_as_solved(const CholeskyFactor& factor, const Unknowns& unknowns,
                      const LoadColumns& A) {
  const FactorPart part = factor.part(unknowns);
  const Eigen::MatrixXd expected = A.transpose() * factor.solve(A.toDense());
  const Eigen::MatrixXd C = load_compliance(part, on_part(part, A));
  ASSERT_EQ(C.rows(), A.cols());
  EXPECT_LT((C - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.norm());
  EXPECT_EQ(C, C.transpose());
}

Unknowns all_of(const Stiffness& K) {
  Unknowns all;
  for (std::int64_t i = 0; i < K.cols(); ++i) {
    all.push_back(i);
  }
  return all;
}

// Loads that meet in one unknown, or that lie in branches far from one another.
TEST(LoadCompliance, IsThatOfSolves) {
  for (const Stiffness& K : {lattice(11), in_blocks(lattice(7))}) {
    const CholeskyFactor factor(K);
    ASSERT_GT(factor.part(all_of(K)).supernodes().count, 10);
    for (const std::size_t on_each : {1, 4, 60}) {
      expect_as_solved(factor, all_of(K),
                       random_loads(K.cols(), all_of(K), 190, on_each));
    }
  }
}

TEST(LoadCompliance, OfAPartNeedsNoOtherColumns) {
  const Stiffness K = in_blocks(lattice(7));
  Unknowns near;
  for (std::int64_t i = 0; i < 60; ++i) {
    near.push_back(i);
  }
  const CholeskyFactor factor(K);
  EXPECT_LT(factor.part(near).size(), K.cols() / 2);
  expect_as_solved(factor, near, random_loads(K.cols(), near, 50, 6));
  expect_as_solved(factor, near, random_loads(K.cols(), near, 1, 2));
}

// A dense matrix: a supernode of more columns than are eliminated at a time.
TEST(LoadCompliance, OfASingleSupernode) {
  constexpr int kSize = 150;
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(kSize, kSize);
  const Eigen::MatrixXd K = B * B.transpose() + Eigen::MatrixXd::Identity(kSize, kSize);
  const Stiffness lower = K.triangularView<Eigen::Lower>().toDenseMatrix().sparseView();
  const CholeskyFactor factor(lower);
  ASSERT_EQ(factor.part(all_of(lower)).supernodes().count, 1);
  expect_as_solved(factor, all_of(lower), random_loads(kSize, all_of(lower), 40, 2));
}

TEST(LoadCompliance, OfNothing) {
  const Stiffness K = lattice(4);
  const CholeskyFactor factor(K);
  const FactorPart none = factor.part({});
  EXPECT_EQ(load_compliance(none, LoadColumns(0, 3)), Eigen::MatrixXd::Zero(3, 3));
  const FactorPart part = factor.part(all_of(K));
  EXPECT_EQ(load_compliance(part, LoadColumns(part.size(), 0)).size(), 0);
}

// A load's numbers do not depend on those beside it, nor on their order.
TEST(LoadCompliance, PairsAreByThemselves) {
  const Stiffness K = lattice(9);
  const CholeskyFactor factor(K);
  const FactorPart part = factor.part(all_of(K));
  const LoadColumns A = on_part(part, random_loads(K.cols(), all_of(K), 120, 4));
  const Eigen::MatrixXd C = load_compliance(part, A);
  LoadColumns reversed(A.rows(), A.cols());
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    reversed.col(j) = A.col(A.cols() - 1 - j);
  }
  const LoadColumns some = A.middleCols(13, 30);
  EXPECT_EQ(load_compliance(part, reversed), C.reverse());
  EXPECT_EQ(load_compliance(part, some), C.block(13, 13, 30, 30));
}

}  // namespace
}  // namespace palpate
