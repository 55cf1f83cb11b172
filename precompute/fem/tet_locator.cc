#include "precompute/fem/tet_locator.h"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "formats/base/reproducible.h"

namespace palpate {
namespace {

Eigen::Matrix<double, 10, 1> shape_at(const Eigen::Vector4d& l) {
  Eigen::Matrix<double, 10, 1> shape;
  for (int j = 0; j < 4; ++j) {
    shape[j] = l[j] * (2.0 * l[j] - 1.0);
  }
  for (int e = 0; e < 6; ++e) {
    const auto& [a, b] = kTetEdges[static_cast<std::size_t>(e)];
    shape[4 + e] = 4.0 * l[a] * l[b];
  }
  return shape;
}

}  // namespace

TetLocator::TetLocator(const QuadraticMesh& mesh) : mesh_(mesh) {
  const Points& p = mesh.position_m;
  low_m_ = p.colwise().minCoeff().transpose();
  const Eigen::Vector3d size = p.colwise().maxCoeff().transpose() - low_m_;
  // About as many cells as tets in the body's box.
  cell_m_ = reproducible::cbrt(size.prod() / static_cast<double>(mesh.tet.rows()));
  cells_ = (size.array() / cell_m_).floor().cast<int>() + 1;
  tets_.resize(static_cast<std::size_t>(cells_.prod()));
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    const Eigen::Matrix<double, 4, 3> corner = tet_corners(mesh, t);
    // Barycentric coordinates of p are A^-1 (p, 1), A the corners over ones.
    Eigen::Matrix4d A;
    A << corner.transpose(), Eigen::RowVector4d::Ones();
    area_.emplace_back(A.inverse());
    const Cell from = cell_of(corner.colwise().minCoeff().transpose());
    const Cell to = cell_of(corner.colwise().maxCoeff().transpose());
    for (int x = from.x(); x <= to.x(); ++x) {
      for (int y = from.y(); y <= to.y(); ++y) {
        for (int z = from.z(); z <= to.z(); ++z) {
          tets_[number_of({x, y, z})].push_back(static_cast<std::int32_t>(t));
        }
      }
    }
  }
}

TetLocator::Cell TetLocator::cell_of(const Eigen::Vector3d& p_m) const {
  return ((p_m - low_m_).array() / cell_m_)
      .floor()
      .max(0.0)
      .min((cells_ - 1).cast<double>())
      .cast<int>();
}

std::size_t TetLocator::number_of(const Cell& cell) const {
  const auto n = cells_.cast<std::size_t>().eval();
  const auto at = cell.cast<std::size_t>().eval();
  return (at.z() * n.y() + at.y()) * n.x() + at.x();
}

TetLocator::Place TetLocator::place(const Eigen::Vector3d& p_m) const {
  const Cell centre = cell_of(p_m);
  std::int32_t best = -1;
  double best_least = -std::numeric_limits<double>::infinity();
  Eigen::Vector4d best_at;
  const auto look_into = [&](const Cell& cell) {
    for (const std::int32_t t : tets_[number_of(cell)]) {
      const Eigen::Vector4d at = area_[static_cast<std::size_t>(t)] * p_m.homogeneous();
      if (at.minCoeff() > best_least) {
        best_least = at.minCoeff();
        best = t;
        best_at = at;
      }
    }
  };
  look_into(centre);
  // Outside: the least outside among the cells around, widening until there are any.
  for (int ring = 1; best_least < -1e-9 && (ring == 1 || best < 0); ++ring) {
    const Cell from = (centre - ring).max(0);
    const Cell to = (centre + ring).min(cells_ - 1);
    for (int x = from.x(); x <= to.x(); ++x) {
      for (int y = from.y(); y <= to.y(); ++y) {
        for (int z = from.z(); z <= to.z(); ++z) {
          look_into({x, y, z});
        }
      }
    }
  }
  Place place{.node = {}, .shape = shape_at(best_at)};
  for (int k = 0; k < 10; ++k) {
    place.node[static_cast<std::size_t>(k)] = mesh_.tet(best, k);
  }
  return place;
}

}  // namespace palpate
