#include "fitting/surface/laplace_beltrami.h"

#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

SurfaceOperator surface_operator(const SurfaceMesh& mesh) {
  const Eigen::Index n = mesh.position_m.rows();
  SurfaceOperator result;
  result.mass_m2.setZero(n);
  result.stiffness.resize(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(12 * mesh.triangle.rows()));
  // Stiffness by cotangents (Pinkall, Polthier 1993): cot(k) / 2 on the edge opposite
  // of k, with cot(k) = a . b / |a x b|. Mass: a third of each triangle's area [m^2].
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (Eigen::Index corner = 0; corner < 3; ++corner) {
      const std::int32_t k = mesh.triangle(t, corner);
      const std::int32_t i = mesh.triangle(t, (corner + 1) % 3);
      const std::int32_t j = mesh.triangle(t, (corner + 2) % 3);
      const Eigen::Vector3d a = mesh.position_m.row(i) - mesh.position_m.row(k);
      const Eigen::Vector3d b = mesh.position_m.row(j) - mesh.position_m.row(k);
      const double twice_area = a.cross(b).norm();
      if (!(twice_area > 1e-12 * (a.squaredNorm() + b.squaredNorm()))) {
        throw InputError(fmt::format(
            "triangle {} has no area ({:.3g} m^2): repair the surface first", t,
            0.5 * twice_area));
      }
      result.mass_m2[k] += twice_area / 6.0;
      // The angle at k weighs the opposite edge (i, j).
      const double w = 0.5 * a.dot(b) / twice_area;
      entries.insert(entries.end(), {{i, j, -w}, {j, i, -w}, {i, i, w}, {j, j, w}});
    }
  }
  for (Eigen::Index v = 0; v < n; ++v) {
    if (!(result.mass_m2[v] > 0.0)) {
      throw InputError(fmt::format("vertex {} belongs to no triangle", v));
    }
  }
  result.stiffness.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace palpate
