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

/// Adds an elastic foundation to the stiffness: springs of k [Pa/m] per area, in all
/// directions, under every surface face whose nodes all lie there.
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

/// Near-field compliance of the contact surface. Entry (v, w) [m/N]: average inward
/// displacement over the hat of v along the inward normals, for 1 N of pressure force
/// spread over the hat of w. Symmetric (Maxwell-Betti).
class SurfaceCompliance {
 public:
  static constexpr std::size_t kBlock = kSolveWidthMax;  ///< columns per solve

  /// Solves for one column per node of `columns` and keeps its rows within `radius_m`.
  /// Runs on all cores; the result does not depend on their number.
  /// @param nodes contact nodes, ascending: the rows. @param columns of them,
  /// ascending.
  /// @param wanted by contact node: blocks of columns without a wanted one are left
  /// out; empty: all are wanted. What is wanted does not change the bits of a column.
  /// @param progress called now and then from one thread with the columns done; may
  /// throw.
  SurfaceCompliance(const CholeskyFactor& factor, const Supports& supports,
                    const ContactSurface& surface, std::span<const std::int32_t> nodes,
                    std::span<const std::int32_t> columns, double radius_m,
                    std::span<const char> wanted,
                    const std::function<void(std::size_t)>& progress);

  /// Solves for columns that are missing, as the constructor does.
  /// @param columns of its nodes, ascending; those that are there are passed over.
  void add_columns(const CholeskyFactor& factor, const Supports& supports,
                   const ContactSurface& surface,
                   std::span<const std::int32_t> columns);

  /// Adds to the compliance among the given contact nodes, where it is kept.
  /// @param nodes ascending. @param more (n x n) [m/N], symmetric.
  void add(std::span<const std::int32_t> nodes, const Eigen::MatrixXd& more);

  /// Compliance among the given contact nodes, (n x n). Pairs farther apart than the
  /// radius are zero; every node must be one of those that were solved for.
  [[nodiscard]] Eigen::MatrixXd among(std::span<const std::int32_t> nodes) const;

  /// (n_rows x n_columns), zero as above. @param columns that were solved for.
  [[nodiscard]] Eigen::MatrixXd between(std::span<const std::int32_t> rows,
                                        std::span<const std::int32_t> columns) const;

  /// Whether a contact node is one of the columns.
  [[nodiscard]] bool is_column(std::int32_t node) const {
    return is_column_[static_cast<std::size_t>(node)] != 0;
  }

 private:
  static std::vector<std::int32_t> by_elimination(
      const LoadedPart& loaded, const ContactSurface& surface,
      std::span<const std::int32_t> columns);
  // At most kBlock columns.
  void solve_block(const LoadedPart& loaded, const ContactSurface& surface,
                   std::span<const std::int32_t> columns);
  void solve(const CholeskyFactor& factor, const Supports& supports,
             const ContactSurface& surface, std::span<const std::int32_t> columns,
             std::span<const char> wanted,
             const std::function<void(std::size_t)>& progress);
  // Calls entry(i, value) for the rows[i] that are kept of a column.
  template <typename Entry>
  void for_entries(std::int32_t column, std::span<const std::int32_t> rows,
                   const Entry& entry) const;

  std::vector<char> is_column_;          // (n_contact_nodes)
  std::vector<std::int64_t> begin_;      // (n_contact_nodes + 1)
  std::vector<std::int32_t> neighbour_;  // ascending within a node's range
  std::vector<double> value_;
};

}  // namespace palpate
