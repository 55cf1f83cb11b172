#include "precompute/press/press_cost.h"

#include <algorithm>

#include "formats/base/reproducible.h"
#include "precompute/body/meshed_body.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {
namespace {

constexpr double kTriangles = 25920.0;
constexpr double kFactorS = 25.0;
constexpr double kColumnS = 0.047;

}  // namespace

double expected_cpu_s(const MeshWork& work) {
  return kFactorS * reproducible::pow(work.triangles / kTriangles, 1.48) +
         work.columns * expected_column_cpu_s(work.triangles);
}

double expected_column_cpu_s(double triangles) {
  return kColumnS * reproducible::pow(triangles / kTriangles, 1.24);
}

MeshWork own_mesh_work(const Scene& scene, const BodySource& body,
                       std::span<const std::int32_t> vertices,
                       const ContactFocus& focus) {
  const SurfaceMesh surface = graded_surface(scene, body, vertices, focus);
  const double reach_m = touched_radius_m(scene, body, 0.5 * focus.finest_m);
  return {static_cast<double>(surface.triangle.rows()),
          static_cast<double>(contact_nodes_near(surface, body, vertices, reach_m))};
}

double expected_own_meshes_cpu_s(const Scene& scene, const BodySource& body,
                                 std::span<const std::int32_t> vertices,
                                 const ContactFocus& focus) {
  const auto groups = group_vertices(body.surface, vertices, focus);
  const MeshWork work = own_mesh_work(scene, body, groups[groups.size() / 2], focus);
  return static_cast<double>(groups.size() * body.tool.size()) * expected_cpu_s(work);
}

}  // namespace palpate
