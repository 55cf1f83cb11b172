#include "precompute/contact/complementarity.h"

#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

struct Problem {
  Eigen::MatrixXd A;
  Eigen::VectorXd t;
};

Problem random_problem(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd M = Eigen::MatrixXd::NullaryExpr(n, n, [&] {
    return normal(random);
  });
  return {M * M.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n),
          Eigen::VectorXd::NullaryExpr(n, [&] {
            return normal(random);
          })};
}

TEST(Complementarity, MeetsItsThreeConditionsOnRandomProblems) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Problem problem = random_problem(1 + static_cast<int>(seed % 60), seed);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(problem.t.size());
    const ComplementarityReport report = solve_complementarity(problem.A, problem.t, f);
    ASSERT_TRUE(report.converged) << "seed " << seed;
    const Eigen::VectorXd w = problem.A * f + problem.t;
    const double scale = problem.t.cwiseAbs().maxCoeff();
    ASSERT_GE(f.minCoeff(), 0.0);
    ASSERT_GE(w.minCoeff(), -1e-9 * scale) << "seed " << seed;
    ASSERT_LE(std::abs(f.dot(w)), 1e-9 * scale * (1 + f.maxCoeff())) << "seed " << seed;
  }
}

TEST(Complementarity, OneNodeIsAClosedForm) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(1);
  solve_complementarity(Eigen::MatrixXd::Constant(1, 1, 2.0),
                        Eigen::VectorXd::Constant(1, -3.0), f);
  EXPECT_DOUBLE_EQ(f[0], 1.5);
  solve_complementarity(Eigen::MatrixXd::Constant(1, 1, 2.0),
                        Eigen::VectorXd::Constant(1, 3.0), f);
  EXPECT_DOUBLE_EQ(f[0], 0.0);
}

// A tool that is nowhere near, and the answer of a warm start from a wrong contact.
TEST(Complementarity, TheStartDoesNotChangeTheAnswer) {
  const Problem problem = random_problem(40, 7);
  Eigen::VectorXd cold = Eigen::VectorXd::Zero(40);
  Eigen::VectorXd warm = Eigen::VectorXd::Ones(40);
  solve_complementarity(problem.A, problem.t, cold);
  solve_complementarity(problem.A, problem.t, warm);
  EXPECT_LT((cold - warm).norm(), 1e-9 * cold.norm());
}

TEST(Complementarity, NoForceWhereAllGapsAreOpen) {
  const Problem problem = random_problem(10, 3);
  Eigen::VectorXd f = Eigen::VectorXd::Ones(10);
  const auto report = solve_complementarity(
      problem.A, problem.t.cwiseAbs() + Eigen::VectorXd::Ones(10), f);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(f.norm(), 0.0);
}

}  // namespace
}  // namespace palpate
