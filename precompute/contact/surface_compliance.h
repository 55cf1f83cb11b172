// How far contact nodes move for a unit pressure force at their neighbours.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/contact/contact_surface.h"
#include "precompute/fem/cholesky_factor.h"

namespace palpate {

struct LoadedPart;

/// Which degrees of freedom are solved for: index among the free ones, or -1 if held.
struct Supports {
  std::vector<std::int64_t> free_index;  ///< (3 n_nodes)
  std::int64_t free = 0;
};

/// Holds every surface node of the mesh whose position [m] is one of those, in all
/// directions.
using Where = std::function<bool(const Eigen::Vector3d& p_m)>;
[[nodiscard]] Supports hold_where(const QuadraticMesh& mesh, const Where& held);
[[nodiscard]] Supports hold_boxes(const QuadraticMesh& mesh,
                                  std::span<const Eigen::AlignedBox3d> box_m);

/// Points of a surface face (face_rule) [m] that lie there: all of them where all of
/// its nodes do.
/// @param take called with each, and which of the rule's it is.
void for_points_there(
    const QuadraticMesh& mesh, Eigen::Index face, const Where& where,
    const std::function<void(const Eigen::Vector3d& p_m, std::size_t point)>& take);

/// Adds an elastic foundation to the stiffness: springs of k [Pa/m] per area, in all
/// directions, under the surface there (for_points_there).
void add_foundation(Stiffness& lower, const QuadraticMesh& mesh, double k_pa_per_m,
                    const Where& where);

/// Average inward displacement [m] over the hat of a contact node along the normals:
/// what its unit pressure force works on. @param u_m of the free degrees of freedom;
/// the held ones do not move.
[[nodiscard]] double average_displacement(const ContactNode& node,
                                          const Supports& supports,
                                          const Eigen::Ref<const Eigen::VectorXd>& u_m);

/// K without the rows and columns of held degrees of freedom.
[[nodiscard]] Stiffness reduce(const Stiffness& lower, const Supports& supports);

/// Near-field compliance of the contact surface. Entry (v, w) [m/N] is the average
/// displacement over the hat of v, along the inward normals. The load is 1 N of
/// pressure force spread over the hat of w. Symmetric (Maxwell-Betti).
class SurfaceCompliance {
 public:
  static constexpr std::size_t kBlock = kSolveWidthMax;  ///< columns per solve

  /// Of a model's many nodes: solves for one column per node and keeps its rows within
  /// `radius_m`. Runs on all cores; the result does not depend on their number.
  /// @param nodes contact nodes, ascending.
  /// @param wanted by contact node: blocks of columns without a wanted one are left
  /// out; empty: all are wanted. What is wanted does not change the bits of a column.
  /// @param progress called now and then from one thread with the columns done; may
  /// throw.
  /// @throws as require_free_memory().
  SurfaceCompliance(const CholeskyFactor& factor, const Supports& supports,
                    const ContactSurface& surface, std::span<const std::int32_t> nodes,
                    double radius_m, std::span<const char> wanted,
                    const std::function<void(std::size_t)>& progress);

  /// Of the few nodes that a model was made for: all pairs are kept, and cost less than
  /// solves for half of the columns (load_compliance.h). Of the calling thread alone.
  /// @param nodes as above.
  SurfaceCompliance(const CholeskyFactor& factor, const Supports& supports,
                    const ContactSurface& surface, std::span<const std::int32_t> nodes);

  /// Adds to the compliance among the given contact nodes, where it is kept.
  /// @param nodes ascending. @param more (n x n) [m/N], symmetric.
  void add(std::span<const std::int32_t> nodes, const Eigen::MatrixXd& more);

  /// Compliance among the given contact nodes, (n x n). Pairs that are not kept are
  /// zero; every node must be one of those that were solved for.
  [[nodiscard]] Eigen::MatrixXd among(std::span<const std::int32_t> nodes) const;

  /// Memory that it takes [bytes].
  [[nodiscard]] double bytes() const {
    return sizeof(std::int32_t) * static_cast<double>(neighbour_.size()) +
           sizeof(double) * static_cast<double>(value_.size());
  }

  /// (n_rows x n_columns), zero as above.
  [[nodiscard]] Eigen::MatrixXd between(std::span<const std::int32_t> rows,
                                        std::span<const std::int32_t> columns) const;

 private:
  // A node's column: where its neighbours and its values begin.
  struct Column {
    std::int64_t neighbour = 0, value = 0, count = 0;
  };

  [[nodiscard]] std::span<const std::int32_t> neighbours(std::int32_t node) const {
    const Column& column = column_[static_cast<std::size_t>(node)];
    return {neighbour_.data() + column.neighbour,
            static_cast<std::size_t>(column.count)};
  }
  [[nodiscard]] const double* values(std::int32_t node) const {
    return value_.data() + column_[static_cast<std::size_t>(node)].value;
  }
  [[nodiscard]] double* values(std::int32_t node) {
    return value_.data() + column_[static_cast<std::size_t>(node)].value;
  }
  static std::vector<std::int32_t> by_elimination(
      const LoadedPart& loaded, const ContactSurface& surface,
      std::span<const std::int32_t> columns);
  // At most kBlock columns.
  void solve_block(const LoadedPart& loaded, const ContactSurface& surface,
                   std::span<const std::int32_t> columns);
  // Calls entry(i, at) for the rows[i] that are kept of a column, as its at-th.
  template <typename Entry>
  void for_entries(std::int32_t column, std::span<const std::int32_t> rows,
                   const Entry& entry) const;

  std::vector<Column> column_;           // (n_contact_nodes)
  std::vector<std::int32_t> neighbour_;  // ascending within a column
  Eigen::MatrixXd value_;                // by columns, of any shape
};

}  // namespace palpate
