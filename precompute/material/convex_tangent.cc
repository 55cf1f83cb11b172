#include "precompute/material/convex_tangent.h"

#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace palpate {
namespace {

// One solver for tangents and blocks of two: unrolled ones compile for half a minute.
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 9, 9>;

template <typename Symmetric>
Symmetric clipped(const Symmetric& matrix) {
  const Eigen::SelfAdjointEigenSolver<Symmetric> eigen(matrix);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

// Index of a row and a column in a tangent.
constexpr int entry(int row, int column) {
  return row + 3 * column;
}

// Columns u_i v_j', as tangents count their entries; NaN where F is singular.
Tangent principal_dyads(const Eigen::Matrix3d& F) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> right(F.transpose() * F);
  const Eigen::Matrix3d& V = right.eigenvectors();
  const Eigen::Matrix3d U =
      F * V * right.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal();
  Tangent dyads;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Eigen::Map<Eigen::Matrix3d>(dyads.col(entry(i, j)).data()) =
          U.col(i) * V.col(j).transpose();
    }
  }
  return dyads;
}

}  // namespace

void clip_negative(const Eigen::Matrix3d& F, Tangent& tangent) {
  if (Eigen::LLT<Tangent>(tangent).info() == Eigen::Success) {
    return;
  }
  constexpr double kRounding = 1e-10;
  // The tangent in the basis u_i v_j^T: one block of three and three blocks of two.
  const Tangent dyads = principal_dyads(F);
  Tangent rest = dyads.transpose() * tangent * dyads;
  Tangent clipped_blocks = Tangent::Zero();
  const auto clip = [&](const auto& which, const auto& block) {
    clipped_blocks(which, which) = clipped(block);
    rest(which, which).setZero();
  };
  const Eigen::Array3i stretches(entry(0, 0), entry(1, 1), entry(2, 2));
  clip(stretches, Eigen::Matrix3d(rest(stretches, stretches)));
  for (const auto& [i, j] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
    const Eigen::Array2i shears(entry(i, j), entry(j, i));
    clip(shears, Small(rest(shears, shears)));
  }
  // What the blocks leave is zero for an isotropic law. For other laws the whole
  // tangent is clipped; so it is where F is singular, whose dyads are NaN.
  if (rest.norm() <= kRounding * tangent.norm()) {
    tangent = dyads * clipped_blocks * dyads.transpose();
  } else {
    tangent = clipped(Small(tangent));
  }
}

}  // namespace palpate
