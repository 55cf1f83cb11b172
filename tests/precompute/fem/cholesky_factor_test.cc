#include "precompute/fem/cholesky_factor.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/precompute/fem/lattice.h"

namespace palpate {
namespace {

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
  const CholeskyFactor factor(K);
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

}  // namespace
}  // namespace palpate
