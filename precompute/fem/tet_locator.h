// Which tetrahedron a point lies in, and the values of a quadratic field there.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "precompute/fem/quadratic_mesh.h"

namespace palpate {

class TetLocator {
 public:
  explicit TetLocator(const QuadraticMesh& mesh);

  /// The ten nodes of a tet and their shape functions at a point.
  struct Place {
    std::array<std::int32_t, 10> node;
    Eigen::Matrix<double, 10, 1> shape;  ///< [-] sum 1
  };

  /// A point outside all tets gets the one near it that it is least outside of, with
  /// that tet's field continued.
  [[nodiscard]] Place place(const Eigen::Vector3d& p_m) const;

 private:
  using Cell = Eigen::Array3i;
  [[nodiscard]] Cell cell_of(const Eigen::Vector3d& p_m) const;
  [[nodiscard]] std::size_t number_of(const Cell& cell) const;
  const QuadraticMesh& mesh_;
  Eigen::Vector3d low_m_;
  double cell_m_ = 0.0;
  Cell cells_;
  std::vector<Eigen::Matrix4d> area_;  // (n_tets) area coordinates of (x, y, z, 1)
  std::vector<std::vector<std::int32_t>> tets_;  // by cell: whose boxes meet it
};

}  // namespace palpate
