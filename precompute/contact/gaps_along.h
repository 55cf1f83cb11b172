// Averaged gaps of many contact nodes to a tool, at one penetration or along its path.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/contact/contact_surface.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

struct Gaps {
  Eigen::VectorXd distance_m;  ///< (n) [m]
  Eigen::MatrixX3d by_centre;  ///< (n x 3) [-] by the tool's position
};

/// Of the nodes of a patch (average_gap), the body at rest. Nodes whose surface does
/// not face the tool's are never met: twice the largest depth, by_centre 0.
[[nodiscard]] Gaps gaps_at(const ContactSurface& surface,
                           std::span<const std::int32_t> patch,
                           const IndentationPath& path, double penetration_m);

/// Gaps at any penetration, without most of the work of gaps_at(). Gaps are convex in
/// the penetration, and nearly always linear (contact_gap.h). A gap with the same slope
/// at both ends of the path is linear all along the path.
class GapsAlong {
 public:
  /// All must outlive it. @param first_m penetration where the path begins.
  GapsAlong(const ContactSurface& surface, std::span<const std::int32_t> patch,
            const IndentationPath& path, double first_m);

  /// @param penetration_m from first_m to the path's largest.
  [[nodiscard]] Gaps at(double penetration_m) const;

 private:
  const ContactSurface& surface_;
  std::span<const std::int32_t> patch_;
  const IndentationPath& path_;
  Gaps last_;
  Eigen::VectorXd closing_;         // (n) [-] by the penetration, at its end
  std::vector<Eigen::Index> bent_;  // those that are not linear
};

}  // namespace palpate
