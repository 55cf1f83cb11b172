// Dense kernels against Eigen, and all instruction sets against one another.
#include "precompute/lanes/factor_kernels.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "precompute/lanes/instruction_set.h"

namespace palpate {
namespace {

std::vector<InstructionSet> all_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set :
       {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (set <= instruction_set()) {
      sets.push_back(set);
    }
  }
  return sets;
}

Eigen::MatrixXd product(const FactorKernels& kernels, const Eigen::MatrixXd& A,
                        const Eigen::MatrixXd& B, bool lower) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(kernels.product_rows(A.rows()), B.rows());
  std::vector<double> work(
      static_cast<std::size_t>(kernels.product_work(A.rows(), B.rows(), A.cols())));
  kernels.product(A.rows(), B.rows(), A.cols(), A.data(), A.outerStride(), B.data(),
                  B.outerStride(), C.data(), C.outerStride(), lower, work.data());
  return C.topRows(A.rows());
}

TEST(FactorKernels, MultiplyMatricesOfAnySize) {
  for (const InstructionSet set : all_sets()) {
    for (const auto& [m, n, k] :
         {std::array{1, 1, 1}, std::array{7, 5, 3}, std::array{24, 8, 10},
          std::array{25, 9, 1}, std::array{200, 31, 17}, std::array{97, 97, 50}}) {
      const Eigen::MatrixXd A = Eigen::MatrixXd::Random(m, k);
      const Eigen::MatrixXd B = Eigen::MatrixXd::Random(n, k);
      const Eigen::MatrixXd expected = A * B.transpose();
      const Eigen::MatrixXd whole = product(factor_kernels(set), A, B, false);
      EXPECT_LT((whole - expected).norm(), 1e-14 * k * std::sqrt(m * n))
          << name_of(set);
      const Eigen::MatrixXd lower = product(factor_kernels(set), A, B, true);
      for (int j = 0; j < n; ++j) {
        for (int i = j; i < m; ++i) {
          EXPECT_EQ(lower(i, j), whole(i, j)) << i << " " << j;
        }
      }
    }
  }
}

// A supernode of k columns and m rows whose square is positive definite.
Eigen::MatrixXd supernode(int m, int k) {
  Eigen::MatrixXd block = Eigen::MatrixXd::Random(m, k);
  const Eigen::MatrixXd square = block.topRows(k);
  block.topRows(k) = square * square.transpose();
  block.topRows(k).diagonal().array() += 1.0;
  return block;
}

Eigen::MatrixXd factorised(const FactorKernels& kernels, Eigen::MatrixXd block,
                           std::ptrdiff_t pivots) {
  std::vector<double> work(
      static_cast<std::size_t>(kernels.factorise_work(block.rows(), block.cols())));
  EXPECT_EQ(kernels.factorise(block.rows(), block.cols(), block.data(), block.rows(),
                              work.data()),
            pivots);
  return block.triangularView<Eigen::Lower>();
}

TEST(FactorKernels, FactoriseSupernodesOfAnySize) {
  for (const InstructionSet set : all_sets()) {
    for (const auto& [m, k] : {std::array{1, 1}, std::array{9, 3}, std::array{16, 16},
                               std::array{50, 17}, std::array{130, 70}}) {
      const Eigen::MatrixXd block = supernode(m, k);
      const Eigen::MatrixXd L = factorised(factor_kernels(set), block, k);
      const Eigen::MatrixXd square =
          L.topRows(k).triangularView<Eigen::Lower>().toDenseMatrix();
      EXPECT_LT((square * square.transpose() - block.topRows(k))
                    .triangularView<Eigen::Lower>()
                    .toDenseMatrix()
                    .norm(),
                1e-14 * k * block.norm());
      EXPECT_LT(
          (L.bottomRows(m - k) * square.transpose() - block.bottomRows(m - k)).norm(),
          1e-14 * k * block.norm());
    }
  }
}

// Y' stands below a factorised block as rows of it.
Eigen::MatrixXd eliminated(const FactorKernels& kernels, const Eigen::MatrixXd& L,
                           const Eigen::MatrixXd& Y) {
  const Eigen::Index m = L.rows();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(kernels.product_rows(Y.rows()), m);
  rows.topRows(Y.rows()) = Y;
  std::vector<double> work(
      static_cast<std::size_t>(kernels.product_work(Y.rows(), m, L.cols())));
  kernels.eliminate(Y.rows(), m, L.cols(), L.data(), m, rows.data(), rows.rows(),
                    work.data());
  return rows.topRows(Y.rows());
}

TEST(FactorKernels, EliminateRightHandSidesThatAreRows) {
  for (const InstructionSet set : all_sets()) {
    for (const auto& [m, k, rows] : {std::array{1, 1, 1}, std::array{9, 3, 30},
                                     std::array{40, 40, 5}, std::array{130, 70, 27}}) {
      const Eigen::MatrixXd L = factorised(factor_kernels(set), supernode(m, k), k);
      const Eigen::MatrixXd own = Eigen::MatrixXd::Random(rows, k);
      const Eigen::MatrixXd below = Eigen::MatrixXd::Random(rows, m - k);
      Eigen::MatrixXd Y(rows, m);
      Y << own * L.topRows(k).transpose(),
          below + own * L.bottomRows(m - k).transpose();
      Eigen::MatrixXd expected(rows, m);
      expected << own, below;
      EXPECT_LT((eliminated(factor_kernels(set), L, Y) - expected).norm(),
                1e-12 * expected.norm())
          << name_of(set);
    }
  }
}

TEST(FactorKernels, NameTheFirstPivotThatIsNotPositive) {
  Eigen::MatrixXd block = supernode(40, 30);
  block(20, 20) = -1.0;
  for (const InstructionSet set : all_sets()) {
    factorised(factor_kernels(set), block, 20);
  }
}

// A block as solves read it.
template <typename Number>
std::vector<Number> numbers_of(const Eigen::MatrixXd& block) {
  std::vector<Number> numbers(block.data(), block.data() + block.size());
  numbers.resize(numbers.size() + kSolveWidth, Number{1e3});
  return numbers;
}

// Two supernodes, the second the first one's parent: L of 12 + 5 columns.
struct TwoSupernodes {
  std::vector<std::int32_t> begin{0, 12, 17};
  std::vector<std::int64_t> row_begin{0, 16, 21};
  std::vector<std::int32_t> row;
  Eigen::MatrixXd first, second;
  std::vector<double> first_number, second_number;
  std::vector<const double*> number;

  TwoSupernodes() : first(supernode(16, 12)), second(supernode(5, 5)) {
    for (std::int32_t i = 0; i < 12; ++i) {
      row.push_back(i);
    }
    row.insert(row.end(), {12, 13, 15, 16, 12, 13, 14, 15, 16});
    first = factorised(factor_kernels(InstructionSet::kBaseline), first, 12);
    second = factorised(factor_kernels(InstructionSet::kBaseline), second, 5);
    set_numbers();
  }
  void set_numbers() {
    first_number = numbers_of<double>(first);
    second_number = numbers_of<double>(second);
    number = {first_number.data(), second_number.data()};
  }
  [[nodiscard]] SupernodeView view() const {
    return {2, begin.data(), row_begin.data(), row.data(), number.data(), 16};
  }
  [[nodiscard]] Eigen::MatrixXd L() const {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(17, 17);
    for (int i = 0; i < 16; ++i) {
      whole.row(row[static_cast<std::size_t>(i)]).head(12) = first.row(i);
    }
    whole.bottomRightCorner(5, 5) = second;
    return whole.triangularView<Eigen::Lower>();
  }
};

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Rows solved(const FactorKernels& kernels, const SupernodeView& view, Rows X) {
  std::vector<double> work(
      static_cast<std::size_t>(kernels.solve_work(view, X.cols())));
  kernels.solve(view, X.data(), X.cols(), work.data());
  return X;
}

Eigen::VectorXd solved_one(const FactorKernels& kernels, const SupernodeView& view,
                           Eigen::VectorXd x) {
  std::vector<double> work(
      static_cast<std::size_t>(kernels.solve_work(view, kSolveWidth)));
  kernels.solve_one(view, x.data(), work.data());
  return x;
}

TEST(FactorKernels, SolveForAsManyRightHandSidesAsThereAre) {
  const TwoSupernodes two;
  const Eigen::MatrixXd L = two.L();
  for (const InstructionSet set : all_sets()) {
    const FactorKernels& kernels = factor_kernels(set);
    for (const int width : {8, 16, 24, 32, 64}) {
      const Rows X = Rows::Random(17, width);
      const Rows B = L * (L.transpose() * X);
      EXPECT_LT((solved(kernels, two.view(), B) - X).norm(), 1e-11 * X.norm());
    }
    const Eigen::VectorXd x = Eigen::VectorXd::Random(17);
    const Eigen::VectorXd b = L * (L.transpose() * x);
    EXPECT_LT((solved_one(kernels, two.view(), b) - x).norm(), 1e-11 * x.norm());
  }
}

// The same with numbers that a float holds, as doubles and as floats.
struct RoundedSupernodes : TwoSupernodes {
  std::vector<float> first_rounded, second_rounded;
  std::vector<const float*> rounded;

  RoundedSupernodes() {
    first = first.cast<float>().cast<double>();
    second = second.cast<float>().cast<double>();
    set_numbers();
    first_rounded = numbers_of<float>(first);
    second_rounded = numbers_of<float>(second);
    rounded = {first_rounded.data(), second_rounded.data()};
  }
  [[nodiscard]] SupernodeView rounded_view() const {
    SupernodeView all = view();
    all.number = nullptr;
    all.rounded = rounded.data();
    return all;
  }
};

TEST(FactorKernels, ReadRoundedNumbersAndAddInDoubles) {
  const RoundedSupernodes two;
  const Eigen::VectorXd b = Eigen::VectorXd::Random(17);
  for (const InstructionSet set : all_sets()) {
    const FactorKernels& kernels = factor_kernels(set);
    EXPECT_EQ(solved_one(kernels, two.rounded_view(), b),
              solved_one(kernels, two.view(), b))
        << name_of(set);
  }
}

TEST(FactorKernels, HaveTheSameBitsWithEveryInstructionSet) {
  if (all_sets().size() == 1) {
    GTEST_SKIP() << "this processor has the baseline's instructions alone";
  }
  const FactorKernels& baseline = factor_kernels(InstructionSet::kBaseline);
  const TwoSupernodes two;
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(133, 41);
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(37, 41);
  const Eigen::MatrixXd block = supernode(133, 53);
  const Eigen::MatrixXd L = factorised(baseline, block, 53);
  const Eigen::MatrixXd Y = Eigen::MatrixXd::Random(61, 133);
  const Rows X = Rows::Random(17, 40);
  for (const InstructionSet set : all_sets()) {
    const FactorKernels& kernels = factor_kernels(set);
    EXPECT_EQ(product(kernels, A, B, false), product(baseline, A, B, false));
    EXPECT_EQ(factorised(kernels, block, 53), factorised(baseline, block, 53));
    EXPECT_EQ(eliminated(kernels, L, Y), eliminated(baseline, L, Y));
    EXPECT_EQ(solved(kernels, two.view(), X), solved(baseline, two.view(), X));
    EXPECT_EQ(solved_one(kernels, two.view(), X.col(0)),
              solved_one(baseline, two.view(), X.col(0)));
  }
}

}  // namespace
}  // namespace palpate
