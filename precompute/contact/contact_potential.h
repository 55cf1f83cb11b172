// What pushes a body's surface out of a rigid tool: an augmented Lagrangian of the
// averaged gaps, at finite displacements.
//
// Averaged gap of contact node v: g_v(u) = sum_q omega_vq phi(x_q + u(x_q)), phi the
// signed distance of the tool. With multipliers lambda_v [N] and spring k_v [N/m]:
//   Psi(u) = sum_v ( <lambda_v - k_v g_v>^2 - lambda_v^2 ) / (2 k_v),
// pressure force p_v = <lambda_v - k_v g_v>, <x> = max(x, 0) (Rockafellar 1974; Simo
// and Laursen 1992). Where lambda = p, g.p = 0 and g >= 0 hold exactly.
//
// An averaged gap does not see a surface that folds into the tool within a hat. A sharp
// edge under a tool saves energy by such a fold. On request, springs at the points
// resist the fold: sum_q (k_q/2) <-phi(x_q + u(x_q))>^2, k_q a share of sum_v omega_vq
// k_v. The energy that these springs store is not the body's energy. The springs are
// for paths that are hard to follow without springs.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/contact/contact_surface.h"
#include "precompute/contact/near_field.h"
#include "precompute/contact/tool_surface.h"
#include "precompute/fem/block_matrix.h"
#include "precompute/fem/quadratic_mesh.h"

namespace palpate {

struct Multipliers {
  Eigen::VectorXd pressure_n;      ///< (n_patch) [N] lambda
  Eigen::VectorXd spring_n_per_m;  ///< (n_patch) [N/m] k
  double point_share = 0.0;        ///< [-] springs at the points over those
  /// (n_patch x 3) [N] of the ties of a sticking tool; zero for a frictionless one.
  Eigen::MatrixX3d tie_n;
  /// (n_patch x 3) [m] where each node's average point first touched, in the tool's
  /// frame; only where `tied`.
  Eigen::MatrixX3d anchor_m;
  std::vector<char> tied;  ///< (n_patch)
};

struct ContactState {
  double energy_j = 0.0;       ///< Psi
  Eigen::Vector3d force_n;     ///< on the tool
  Eigen::Vector3d moment_nm;   ///< on the tool, about the world's origin
  Eigen::VectorXd pressure_n;  ///< (n_patch) p
  Eigen::VectorXd gap_m;       ///< (n_patch) g
  Eigen::MatrixX3d tie_n;      ///< (n_patch x 3) forces of ties
};

/// Deflection [m] of the springs that carry what the multipliers lack. Springs act
/// along normals and, where nodes are tied, across the normals too. The deflection is
/// the mean weighted by forces, as a share of the whole pressure. The hand would feel
/// the same force from a tool that much higher or lower.
[[nodiscard]] double spring_give_m(const ContactState& contact,
                                   const Multipliers& multipliers);

/// The contact nodes that the tool may meet, over near nodes.
class ContactPotential {
 public:
  ContactPotential(const ContactSurface& surface, const QuadraticMesh& mesh,
                   std::span<const std::int32_t> patch, const NearField& near);

  [[nodiscard]] Eigen::Index nodes() const {
    return static_cast<Eigen::Index>(patch_size_);
  }

  [[nodiscard]] ContactState evaluate(const Eigen::VectorXd& u_m,
                                      const PlacedTool& tool,
                                      const Multipliers& multipliers) const;

  /// Adds dPsi/du to `force_n` and prepares add_curvature.
  void linearise(const Eigen::VectorXd& u_m, const PlacedTool& tool,
                 const Multipliers& multipliers, Eigen::VectorXd& force_n);
  /// y += d2Psi/du2 x of the last linearise().
  void add_curvature(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  /// (n_patch x 3) averaged positions of the hats [m].
  [[nodiscard]] Eigen::MatrixX3d average_position_m(const Eigen::VectorXd& u_m) const;

 private:
  struct Point {
    std::int32_t face = 0;
    std::int32_t rule = 0;
    Eigen::Vector3d position_m;
    // Up to three hats of the patch with their omega.
    std::array<std::int32_t, 3> hat{-1, -1, -1};
    std::array<double, 3> omega{0.0, 0.0, 0.0};
  };
  struct RowEntry {
    std::int32_t node = 0;
    Eigen::Vector3d gradient;
    double mean = 0.0;  // integral of omega N
  };
  [[nodiscard]] Eigen::Vector3d displaced(const Point& point,
                                          const Eigen::VectorXd& u_m) const;
  /// [N] its share of the hats' pressure forces
  [[nodiscard]] static double pressure_at(const Point& point,
                                          const Eigen::VectorXd& pressure_n);
  /// k_q [N/m]
  [[nodiscard]] static double point_spring(const Point& point,
                                           const Multipliers& multipliers);
  RowEntry& row_entry(std::int32_t hat, std::int32_t node);

  std::size_t patch_size_ = 0;
  NodeGroups face_;  // (n_faces x 6) near nodes
  std::vector<Point> point_;
  std::vector<std::vector<RowEntry>> row_;   // (n_patch) gradients of the gaps
  std::vector<double> row_spring_;           // (n_patch) 0 where inactive
  std::vector<Eigen::Matrix3d> tie_spring_;  // (n_patch)
  BlockMatrix curvature_;
};

}  // namespace palpate
