// The part of a body around the tool that is treated as nonlinear; all the rest stays
// linear and is condensed exactly.
//
// K is the rest stiffness of the whole body. Every displacement of the near field is u
// = K^-1 s with a source s [N] on near nodes only. The far field's residual is then
// zero by construction. The total elastic energy is
//   W = s.u/2 + sum over near tets of (W_e(u_e) - u_e.K_e u_e/2).
// W needs u on the near nodes only. The cost is one solve per iteration, and nothing
// else of the body's size.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/block_matrix.h"
#include "precompute/fem/element_batches.h"
#include "precompute/fem/quadratic_element.h"
#include "precompute/fem/quadratic_mesh.h"
#include "precompute/material/material.h"

namespace palpate {

/// A displacement of the near nodes and its source, u = (K^-1 s)_near. Both have 3 m
/// entries, at 3 near node + axis, with zero on held nodes.
struct NearState {
  Eigen::VectorXd source_n;
  Eigen::VectorXd displacement_m;
};

class NearField {
 public:
  /// @param tets near tets; those of linear laws are left out.
  /// @param nodes further mesh nodes that must be near (the contact's).
  NearField(const QuadraticMesh& mesh, std::span<const Material> materials,
            const Supports& supports, std::span<const Eigen::Index> tets,
            std::span<const std::int32_t> nodes);

  [[nodiscard]] Eigen::Index size() const {
    return 3 * static_cast<Eigen::Index>(node_.size());
  }
  [[nodiscard]] Eigen::Index tets() const { return elements_.elements(); }
  /// Near node of a mesh node, or -1.
  [[nodiscard]] std::int32_t near_node(std::int32_t mesh_node) const;
  /// (3 m) unknown of the whole body, -1 where held.
  [[nodiscard]] const std::vector<std::int64_t>& dof() const { return dof_; }
  /// Sets what acts on held unknowns to zero.
  void mask(Eigen::VectorXd& v) const;

  /// Sum of W_e - u.K_e u/2 over the near tets [J]; +inf where a law does not admit u.
  /// Also the smallest det F, at most 1.
  [[nodiscard]] ElementBatches::Energy excess(const Eigen::VectorXd& u_m) const;

  /// Adds d(excess)/du to `force` (3 m) and sets `change` to d2(excess)/du2.
  /// @param convex tangents of elements that have negative eigenvalues are replaced by
  /// such without (element_response), along which a step always descends.
  void linearise(const Eigen::VectorXd& u_m, Eigen::VectorXd& force_n, bool convex);
  /// y += (K(u) - K(0)) x of the last linearise().
  void add_change(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    change_.multiply_add(x, y);
  }
  /// K(u) - K(0) of the last linearise(), by near nodes.
  [[nodiscard]] const BlockMatrix& change() const { return change_; }

 private:
  std::vector<std::int32_t> node_;  // (m) mesh nodes, ascending
  std::vector<std::int64_t> dof_;   // (3 m)
  ElementBatches elements_;         // of near nodes
  BlockMatrix rest_;
  BlockMatrix change_;
};

/// Tets in which the displacement gradient of `u_m` (3 n_nodes) reaches `threshold`.
/// All tets of some laws are added: laws without a tangent at rest that holds for small
/// strains (has_kink).
[[nodiscard]] std::vector<Eigen::Index> strained_tets(
    const QuadraticMesh& mesh, std::span<const Material> materials,
    const Eigen::VectorXd& u_m, double threshold);

/// Energy of the laws at u_m (3 n_nodes) over that of the rest stiffness, minus 1 [-],
/// at most 10. The value measures how nonlinear the body is where it is strained. Tets
/// with less than a twentieth of the largest displacement gradient are left out.
[[nodiscard]] double nonlinearity(const QuadraticMesh& mesh,
                                  std::span<const Material> materials,
                                  const Eigen::VectorXd& u_m);

/// What the rest stiffness misses in the far tets: sum of |W_e - u.K_e u/2| [J] over
/// those that are not near, at u_m (3 n_nodes). +inf where a law does not admit it.
/// @param near ascending.
[[nodiscard]] double far_excess_j(const QuadraticMesh& mesh,
                                  std::span<const Material> materials,
                                  std::span<const Eigen::Index> near,
                                  const Eigen::VectorXd& u_m);

}  // namespace palpate
