#include "precompute/material/convex_tangent.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace palpate {
namespace {

template <typename Symmetric>
Symmetric clipped(const Symmetric& matrix) {
  const Eigen::SelfAdjointEigenSolver<Symmetric> eigen(matrix);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

// Index of a row and a column in a tangent.
constexpr int at(int row, int column) {
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
      Eigen::Map<Eigen::Matrix3d>(dyads.col(at(i, j)).data()) =
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
  const Tangent dyads = principal_dyads(F);
  Tangent rest = dyads.transpose() * tangent * dyads;
  Tangent clipped_blocks = Tangent::Zero();
  const auto clip = [&](const auto& which) {
    clipped_blocks(which, which) = clipped((rest(which, which)).eval());
    rest(which, which).setZero();
  };
  clip(Eigen::Array3i(at(0, 0), at(1, 1), at(2, 2)));
  clip(Eigen::Array2i(at(0, 1), at(1, 0)));
  clip(Eigen::Array2i(at(0, 2), at(2, 0)));
  clip(Eigen::Array2i(at(1, 2), at(2, 1)));
  if (rest.norm() <= kRounding * tangent.norm()) {
    tangent = dyads * clipped_blocks * dyads.transpose();
  } else {
    tangent = clipped(tangent);
  }
}

}  // namespace palpate
