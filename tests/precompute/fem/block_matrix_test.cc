#include "precompute/fem/block_matrix.h"

#include <array>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Groups of three nodes, one of which has its nodes in falling order.
NodeGroups three_groups() {
  NodeGroups groups(3, 3);
  groups << 0, 1, 2, 4, 2, 1, 3, 5, 0;
  return groups;
}
constexpr std::int32_t kBlockNodes = 6;

Eigen::MatrixXd symmetric_by_chance(Eigen::Index size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Eigen::MatrixXd K(size, size);
  for (double& value : K.reshaped()) {
    value = unit(random);
  }
  return 0.5 * (K + K.transpose());
}

void add_dense(const NodeGroups& groups, Eigen::Index group, const Eigen::MatrixXd& K,
               Eigen::MatrixXd& sum) {
  for (Eigen::Index i = 0; i < groups.cols(); ++i) {
    for (Eigen::Index j = 0; j < groups.cols(); ++j) {
      sum.block<3, 3>(3 * groups(group, i), 3 * groups(group, j)) +=
          K.block<3, 3>(3 * i, 3 * j);
    }
  }
}

// By its products with unit vectors.
Eigen::MatrixXd dense(const BlockMatrix& matrix) {
  const Eigen::Index size = 3 * Eigen::Index{matrix.nodes()};
  Eigen::MatrixXd full(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(size);
    matrix.multiply_add(Eigen::VectorXd::Unit(size, k), y);
    full.col(k) = y;
  }
  return full;
}

struct FilledMatrix {
  FilledMatrix() : matrix(kBlockNodes, groups) {
    for (Eigen::Index g = 0; g < groups.rows(); ++g) {
      const Eigen::MatrixXd K =
          symmetric_by_chance(9, static_cast<std::uint32_t>(g + 1));
      matrix.add(g, K);
      add_dense(groups, g, K, sum);
    }
  }
  NodeGroups groups = three_groups();
  BlockMatrix matrix;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * kBlockNodes, 3 * kBlockNodes);
};

TEST(BlockMatrix, IsTheSumOfItsGroupsWhateverTheOrderOfTheirNodes) {
  const FilledMatrix filled;
  EXPECT_EQ(filled.matrix.nodes(), kBlockNodes);
  EXPECT_NEAR((dense(filled.matrix) - filled.sum).cwiseAbs().maxCoeff(), 0.0, 1e-15);
}

TEST(BlockMatrix, MultiplyAddsToWhatIsThere) {
  const FilledMatrix filled;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(3 * kBlockNodes, -1.0, 2.0);
  Eigen::VectorXd y = Eigen::VectorXd::Constant(3 * kBlockNodes, 7.0);
  filled.matrix.multiply_add(x, y);
  const Eigen::VectorXd wanted = filled.sum * x;
  EXPECT_NEAR((y.array() - 7.0 - wanted.array()).abs().maxCoeff(), 0.0, 1e-13);
  EXPECT_NEAR(filled.matrix.quadratic_form(x), x.dot(wanted), 1e-12);
}

TEST(BlockMatrix, VisitsEveryLowerBlockOfTheGroupsOnce) {
  const FilledMatrix filled;
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(3 * kBlockNodes, 3 * kBlockNodes);
  int visits = 0;
  filled.matrix.for_each([&](std::int32_t a, std::int32_t b, const double* block) {
    EXPECT_GE(a, b);
    lower.block<3, 3>(3 * a, 3 * b) += Eigen::Map<const Eigen::Matrix3d>(block);
    ++visits;
  });
  // Six on the diagonal; (1,0) (2,0) (2,1) of the first group, (4,2) (4,1) of the
  // second, (3,0) (5,0) (5,3) of the third.
  EXPECT_EQ(visits, 14);
  for (Eigen::Index a = 0; a < kBlockNodes; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b) {
      EXPECT_NEAR(
          (lower.block<3, 3>(3 * a, 3 * b) - filled.sum.block<3, 3>(3 * a, 3 * b))
              .norm(),
          0.0, 1e-15);
    }
  }
}

TEST(BlockMatrix, IsZeroOrTheNegativeOfAnother) {
  FilledMatrix filled;
  BlockMatrix negative(kBlockNodes, filled.groups);
  negative.set_negative(filled.matrix);
  EXPECT_NEAR((dense(negative) + filled.sum).cwiseAbs().maxCoeff(), 0.0, 1e-15);
  filled.matrix.set_zero();
  EXPECT_EQ(dense(filled.matrix).cwiseAbs().maxCoeff(), 0.0);
}

// Batches lay an element's lower blocks out by lane: the same sum as one by one.
TEST(BlockMatrix, TakesBlocksOfABatchAsElementsOneByOne) {
  NodeGroups groups(2, 10);
  groups << 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 3, 9, 0, 10, 2, 7, 1, 8, 4;
  BlockMatrix batched(12, groups);
  BlockMatrix single(12, groups);
  auto blocks = std::make_unique<double[][9][kBatch]>(kElementBlocks);
  const std::array<Eigen::Index, 2> lanes{1, 0};
  for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
    const Eigen::MatrixXd K =
        symmetric_by_chance(30, static_cast<std::uint32_t>(lane + 5));
    single.add(lanes[lane], K);
    for (Eigen::Index a = 0, at = 0; a < 10; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++at) {
        for (Eigen::Index k = 0; k < 9; ++k) {
          blocks[static_cast<std::size_t>(at)][k][lane] =
              K(3 * a + k % 3, 3 * b + k / 3);
        }
      }
    }
  }
  batched.add(lanes, blocks.get());
  EXPECT_GT(dense(single).norm(), 1.0);
  EXPECT_NEAR((dense(batched) - dense(single)).cwiseAbs().maxCoeff(), 0.0, 1e-15);
}

}  // namespace
}  // namespace palpate
