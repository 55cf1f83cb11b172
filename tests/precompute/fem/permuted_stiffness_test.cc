#include "precompute/fem/permuted_stiffness.h"

#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Symmetric by blocks of unknowns; block (a, b) is there where the pattern says so.
Eigen::MatrixXd blocked_matrix(std::ptrdiff_t block) {
  constexpr int kPattern[5][5] = {{1, 0, 0, 0, 0},
                                  {1, 1, 0, 0, 0},
                                  {0, 0, 1, 0, 0},
                                  {1, 0, 1, 1, 0},
                                  {0, 1, 0, 1, 1}};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(1.0, 2.0);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(5 * block, 5 * block);
  for (Eigen::Index i = 0; i < K.rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      if (kPattern[i / block][j / block] != 0) {
        K(i, j) = K(j, i) = unit(random);
      }
    }
  }
  return K;
}

Stiffness lower_of(const Eigen::MatrixXd& K) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (Eigen::Index j = 0; j < K.cols(); ++j) {
    for (Eigen::Index i = j; i < K.rows(); ++i) {
      if (K(i, j) != 0.0) {
        entries.emplace_back(i, j, K(i, j));
      }
    }
  }
  Stiffness lower(K.rows(), K.cols());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

const std::vector<std::int32_t> kOrder{3, 0, 4, 2, 1};

TEST(PermutedStiffness, WholeBlocksAreOfThreeElseOfOne) {
  EXPECT_EQ(block_size(lower_of(blocked_matrix(3))), 3);
  EXPECT_EQ(block_size(lower_of(blocked_matrix(1))), 1);
  // A node that is held along one axis alone.
  Eigen::MatrixXd held = blocked_matrix(3);
  held.row(4).setZero();
  held.col(4).setZero();
  held(4, 4) = 1.0;
  EXPECT_EQ(block_size(lower_of(held)), 1);
  // One number that is not there.
  Eigen::MatrixXd gap = blocked_matrix(3);
  gap(5, 0) = 0.0;
  EXPECT_EQ(block_size(lower_of(gap)), 1);
}

TEST(PermutedStiffness, ThePatternIsThatOfTheBlocks) {
  for (const std::ptrdiff_t block : {std::ptrdiff_t{1}, std::ptrdiff_t{3}}) {
    const LowerPattern pattern = pattern_of(lower_of(blocked_matrix(block)), block);
    EXPECT_EQ(pattern.begin, (std::vector<std::int64_t>{0, 3, 5, 7, 9, 10}));
    EXPECT_EQ(pattern.row, (std::vector<std::int64_t>{0, 1, 3, 1, 4, 2, 3, 3, 4, 4}));
  }
}

// Columns [first, last) of P K P', lower triangle, added to what is there.
TEST(PermutedStiffness, ColumnsAreThoseOfTheReorderedMatrix) {
  for (const std::ptrdiff_t block : {std::ptrdiff_t{1}, std::ptrdiff_t{3}}) {
    const Eigen::MatrixXd K = blocked_matrix(block);
    const Stiffness lower = lower_of(K);
    const PermutedStiffness permuted(lower, block, kOrder);
    // Rows of the numbers: two empty blocks first, then rows of the order.
    const std::vector<std::int32_t> local{2, 3, 4, 5, 6};
    const std::ptrdiff_t ld = 7 * block;
    for (const auto& [first, last] :
         {std::pair{0, 5}, std::pair{1, 3}, std::pair{4, 5}}) {
      Eigen::MatrixXd numbers =
          Eigen::MatrixXd::Constant(ld, (last - first) * block, 5.0);
      permuted.add_to(first, last, local, numbers.data(), ld);
      for (Eigen::Index j = 0; j < numbers.cols(); ++j) {
        const Eigen::Index column = first * block + j;
        for (Eigen::Index row = 0; row < 5 * block; ++row) {
          const auto from = [&](Eigen::Index k) {
            return kOrder[static_cast<std::size_t>(k / block)] * block + k % block;
          };
          const double wanted = row >= column ? K(from(row), from(column)) : 0.0;
          const bool above = row < column && row / block == column / block;
          if (!above) {
            EXPECT_EQ(numbers(2 * block + row, j), 5.0 + wanted)
                << block << ' ' << first << ' ' << row << ' ' << column;
          }
        }
        EXPECT_EQ(numbers.col(j).head(2 * block).minCoeff(), 5.0);
        EXPECT_EQ(numbers.col(j).head(2 * block).maxCoeff(), 5.0);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
