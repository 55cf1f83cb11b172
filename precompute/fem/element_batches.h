// A body's quadratic tets in batches for the kernels of precompute/lanes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/fem/block_matrix.h"
#include "precompute/fem/quadratic_element.h"
#include "precompute/lanes/element_kernels.h"
#include "precompute/material/material.h"

namespace palpate {

/// A law as the kernels take it; the material must outlive it.
[[nodiscard]] BatchLaw batch_law(const Material& material);

/// Energies, forces and stiffnesses of many elements; what quadratic_element.h says of
/// one holds for each. Batches are of one law; the last of a law may hold fewer.
class ElementBatches {
 public:
  struct Batch {
    std::array<Eigen::Index, kBatch> element{};  ///< the last is repeated
    std::size_t count = 0;
    std::size_t law = 0;
    ElementBatch geometry;
  };

  ElementBatches() = default;
  /// @param node (n x 10). @param geometry (n). @param region (n) into materials, which
  /// must outlive it.
  ElementBatches(NodeGroups node, std::span<const ElementGeometry> geometry,
                 std::span<const std::int32_t> region,
                 std::span<const Material> materials);

  [[nodiscard]] Eigen::Index elements() const { return node_.rows(); }
  [[nodiscard]] const NodeGroups& node() const { return node_; }

  struct Energy {
    double energy_j = 0.0;           ///< sum; +inf where a law does not admit u
    double smallest_jacobian = 1.0;  ///< [-] det F, at most 1
  };
  /// @param u_m (3 n_nodes).
  [[nodiscard]] Energy energy(const Eigen::VectorXd& u_m) const;

  /// Calls `take` with every batch's answer, in order.
  /// @param convex stiffnesses with negative eigenvalues, but for negligible ones, are
  /// replaced by such without (element_response).
  void linearise(
      const Eigen::VectorXd& u_m, bool convex,
      const std::function<void(const Batch&, const BatchResponse&)>& take) const;

  /// Adds a batch's forces to `force_n` (3 n_nodes).
  void add_forces(const Batch& batch, const BatchResponse& response,
                  Eigen::VectorXd& force_n) const;

 private:
  using BatchVector = std::array<double, kElementUnknowns * kBatch>;
  void gather(const Batch& batch, const Eigen::VectorXd& u_m, BatchVector& u) const;
  void make_convex(const Batch& batch, const BatchVector& u,
                   BatchResponse& response) const;

  NodeGroups node_;
  std::vector<Batch> batch_;
  std::vector<BatchLaw> law_;
  std::span<const Material> materials_;
};

}  // namespace palpate
