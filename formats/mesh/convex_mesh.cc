#include "formats/mesh/convex_mesh.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr Eigen::Index kMostTriangles = 20000;

void require_indices(const SurfaceMesh& mesh) {
  if (mesh.triangle.rows() < 4 || mesh.triangle.rows() > kMostTriangles) {
    throw InputError(fmt::format("the mesh has {} triangles, must have 4 to {}",
                                 mesh.triangle.rows(), kMostTriangles));
  }
  if (!mesh.position_m.allFinite()) {
    throw InputError("the mesh has a coordinate that is not finite");
  }
  if (mesh.triangle.minCoeff() < 0 ||
      mesh.triangle.maxCoeff() >= mesh.position_m.rows()) {
    throw InputError(
        fmt::format("the mesh has a triangle with vertex {}, must lie in [0, {})",
                    mesh.triangle.minCoeff() < 0 ? mesh.triangle.minCoeff()
                                                 : mesh.triangle.maxCoeff(),
                    mesh.position_m.rows()));
  }
}

}  // namespace

double convexity_defect_m(const SurfaceMesh& mesh) {
  double defect = 0.0;
  for (Eigen::Index i = 0; i < mesh.triangle.rows(); ++i) {
    const Eigen::RowVector3d a = mesh.position_m.row(mesh.triangle(i, 0));
    const Eigen::RowVector3d b = mesh.position_m.row(mesh.triangle(i, 1));
    const Eigen::RowVector3d c = mesh.position_m.row(mesh.triangle(i, 2));
    const Eigen::RowVector3d normal = (b - a).cross(c - a).normalized();
    defect = std::max(
        defect,
        ((mesh.position_m.rowwise() - a) * normal.transpose()).eval().maxCoeff());
  }
  return defect;
}

void require_convex(const SurfaceMesh& mesh) {
  require_indices(mesh);
  const double size = bounding_box(mesh).diagonal().norm();
  if ((triangle_neighbours(mesh.triangle).array() < 0).any()) {
    throw InputError("the mesh is open, must be closed");
  }
  if (!(enclosed_volume_m3(mesh) > 1e-9 * size * size * size)) {
    throw InputError(
        fmt::format("the mesh encloses {} m^3, must be a body, outside out",
                    enclosed_volume_m3(mesh)));
  }
  const double defect = convexity_defect_m(mesh);
  if (!(defect <= kConvexityTolerance * size)) {
    throw InputError(
        fmt::format("the mesh is not convex: a vertex stands {:.3g} m above the plane "
                    "of a triangle, at most {:.3g} m is allowed",
                    defect, kConvexityTolerance * size));
  }
}

}  // namespace palpate
