#include "precompute/press/contact_spot.h"

#include "precompute/contact/complementarity.h"
#include "precompute/contact/gaps_along.h"

namespace palpate {

PressureForces contact_spot(const BodyModel& model, const SurfaceCompliance& compliance,
                            const PressedNode& placed) {
  PressureForces spot;
  Eigen::Vector3d resultant_n = Eigen::Vector3d::Zero();
  if (!placed.patch.empty()) {
    // The linear contact at half of the largest depth: w = g + A f >= 0, f >= 0, w . f
    // = 0.
    const Gaps gaps = gaps_at(model.contact, placed.patch, placed.path,
                              0.5 * placed.path.depth_max_m);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(std::ssize(placed.patch));
    (void)solve_complementarity(compliance.among(placed.patch), gaps.distance_m, f);
    for (Eigen::Index j = 0; j < f.size(); ++j) {
      if (f[j] > 0.0) {
        spot.node.push_back(placed.patch[static_cast<std::size_t>(j)]);
        spot.force_n.push_back(f[j]);
        // Force on the tool: sum_j f_j dg_j/d(reference).
        resultant_n += f[j] * gaps.by_centre.row(j).transpose();
      }
    }
  }
  if (!(resultant_n.norm() > 0.0)) {
    return {
        {model.contact
             .of_mesh_node[static_cast<std::size_t>(corner_of(model, placed.vertex))]},
        {1.0}};
  }
  // Forces of a resultant of 1 N are a share of the whole [-]; compliances are in m/N.
  for (double& force_n : spot.force_n) {
    force_n /= resultant_n.norm();
  }
  return spot;
}

Eigen::MatrixXd between_spots(const SurfaceCompliance& compliance,
                              std::span<const PressureForces> spots) {
  const auto n = std::ssize(spots);
  Eigen::MatrixXd C(n, n);
  const auto forces = [&](Eigen::Index i) {
    const auto& of = spots[static_cast<std::size_t>(i)].force_n;
    return Eigen::Map<const Eigen::VectorXd>(of.data(), std::ssize(of));
  };
  // C_ij = f_i^T A f_j: displacement of spot i in the sense of its forces, for 1 N on
  // spot j.
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Eigen::MatrixXd A =
          compliance.between(spots[static_cast<std::size_t>(i)].node,
                             spots[static_cast<std::size_t>(j)].node);
      C(i, j) = forces(i).dot(A * forces(j));
      C(j, i) = C(i, j);
    }
  }
  return C;
}

}  // namespace palpate
