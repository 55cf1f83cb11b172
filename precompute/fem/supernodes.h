// The columns of a sparse factor, or of a part of it, by supernodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "precompute/lanes/factor_kernels.h"

namespace palpate {

/// Right-hand sides row by row, as solves work on them: (unknowns x width).
using SolveRows =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Columns that SolveRows need for so many right-hand sides; the rest are zero.
[[nodiscard]] constexpr Eigen::Index solve_width(Eigen::Index right_hand_sides) {
  return (right_hand_sides + kSolveWidth - 1) / kSolveWidth * kSolveWidth;
}

/// Working space of this thread, kept until it asks again.
[[nodiscard]] double* factor_space(std::ptrdiff_t doubles);

/// As SupernodeView lays them out, which see. Others own the numbers.
struct Supernodes {
  std::vector<std::int32_t> begin;
  std::vector<std::int64_t> row_begin{0};
  std::vector<std::int32_t> row;
  std::vector<const double*> number;
  std::vector<const float*> rounded;  ///< or empty

  [[nodiscard]] std::size_t count() const { return number.size(); }
  [[nodiscard]] std::ptrdiff_t columns(std::size_t s) const {
    return begin[s + 1] - begin[s];
  }
  [[nodiscard]] std::ptrdiff_t rows(std::size_t s) const {
    return row_begin[s + 1] - row_begin[s];
  }
  [[nodiscard]] std::ptrdiff_t unknowns() const {
    return begin.empty() ? 0 : begin.back();
  }
  [[nodiscard]] std::int64_t nonzeros() const;
  [[nodiscard]] SupernodeView view() const;
  void solve(SolveRows& X) const;
  void solve(Eigen::VectorXd& x) const;
};

}  // namespace palpate
