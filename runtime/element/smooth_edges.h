// What an element fixes of its smooth field (smooth_triangle.h has letters and
// equations): once for all places over it.
#pragma once

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element.h"
#include "runtime/element/turned.h"

namespace palpate {

/// The corner after i, and the edge likewise: cyclic.
constexpr Eigen::Index after(Eigen::Index i) noexcept {
  return i == 2 ? 0 : i + 1;
}

/// A value per edge, edge i opposite corner i, from corner j = i + 1 to k = i + 2
/// (cyclic). The fourth repeats the first, so that two pairs make it.
using EdgeValues = Eigen::Array<Real, 4, 1>;

/// A vector per edge.
struct EdgeVectors {
  EdgeValues x = EdgeValues::Zero();
  EdgeValues y = EdgeValues::Zero();
  EdgeValues z = EdgeValues::Zero();

  [[nodiscard]] Vector3 at(Eigen::Index i) const noexcept { return {x(i), y(i), z(i)}; }
};

/// The edges, and what they add to the height.
struct SmoothEdges {
  EdgeVectors start_m;                             ///< [m] v_j
  EdgeVectors edge_m;                              ///< [m] e
  EdgeVectors normal;                              ///< [-] n_j
  EdgeVectors bend;                                ///< [-] n_k - n_j
  EdgeVectors across;                              ///< [-] m, unit, to the inside
  EdgeVectors turned;                              ///< [-] m x n_j
  EdgeVectors turning;                             ///< [-] m x (n_k - n_j)
  EdgeValues open_m = EdgeValues::Zero();          ///< [m] e . (m x n_j)
  EdgeValues closing_m = EdgeValues::Zero();       ///< [m] e . (m x (n_k - n_j))
  EdgeValues edge_normal_m = EdgeValues::Zero();   ///< [m] e . n_j
  EdgeValues edge_bend_m = EdgeValues::Zero();     ///< [m] e . (n_k - n_j)
  EdgeValues across_normal = EdgeValues::Zero();   ///< [-] m . n_j
  EdgeValues across_bend = EdgeValues::Zero();     ///< [-] m . (n_k - n_j)
  EdgeValues normal_squared = EdgeValues::Zero();  ///< [-] |n_j|^2
  EdgeValues normal_bend = EdgeValues::Zero();     ///< [-] n_j . (n_k - n_j)
  EdgeValues bend_squared = EdgeValues::Zero();    ///< [-] |n_k - n_j|^2
  EdgeValues per_altitude_m =
      EdgeValues::Zero();                 ///< [1/m] of the triangle over this edge
  EdgeValues gap_m = EdgeValues::Zero();  ///< [m] gamma
  EdgeValues gap = EdgeValues::Zero();    ///< [-] gamma'
  EdgeValues twist = EdgeValues::Zero();  ///< [-] tau
  EdgeValues twist_by_height_per_m = EdgeValues::Zero();  ///< [1/m] tau'
  EdgeValues sag_m = EdgeValues::Zero();                  ///< [m] kappa
  EdgeValues sag = EdgeValues::Zero();                    ///< [-] kappa'
};

struct SmoothTriangle {
  Matrix3 corner_m = Matrix3::Zero();              ///< [m] v_j, one per column
  Matrix3 normal = Matrix3::Zero();                ///< [-] n_j, likewise
  Matrix3 rise = Matrix3::Zero();                  ///< [-] p_j, likewise
  Matrix3 rise_by_height_per_m = Matrix3::Zero();  ///< [1/m] q_j, likewise
  SmoothEdges edges;
};

[[nodiscard]] SmoothTriangle make_smooth_triangle(const Element& element) noexcept;

}  // namespace palpate
