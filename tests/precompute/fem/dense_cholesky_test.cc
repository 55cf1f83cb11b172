// Dense Cholesky factors against what they are made of.
#include "precompute/fem/dense_cholesky.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Definite: its diagonal is larger than the sum of the rest of its row.
Eigen::MatrixXd some_matrix(Eigen::Index n) {
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      A(i, j) = i == j ? 2.0 : 1.0 / (1.0 + static_cast<double>((i - j) * (i - j)));
    }
    A(j, j) += 4.0;
  }
  return A;
}

TEST(DenseCholesky, SolvesAndReadsTheLowerTriangleAlone) {
  for (const Eigen::Index n :
       {1, 2, 3, 7, 8, 9, 16, 17, 28, 31, 33, 64, 65, 100, 200}) {
    const Eigen::MatrixXd A = some_matrix(n);
    Eigen::MatrixXd lower = A;
    lower.triangularView<Eigen::StrictlyUpper>().setConstant(
        std::numeric_limits<double>::quiet_NaN());
    const DenseCholesky factor(lower);
    ASSERT_TRUE(factor.is_definite()) << n;
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(n, -1.0, 2.0);
    EXPECT_LT((factor.solve(A * x) - x).norm(), 1e-13 * x.norm()) << n;
  }
}

TEST(DenseCholesky, SaysWhatIsNotDefinite) {
  for (const Eigen::Index n : {1, 9, 28, 65}) {
    Eigen::MatrixXd A = some_matrix(n);
    A(n - 1, n - 1) = -1.0;
    EXPECT_FALSE(DenseCholesky(A).is_definite()) << n;
    A(n - 1, n - 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(DenseCholesky(A).is_definite()) << n;
  }
}

}  // namespace
}  // namespace palpate
