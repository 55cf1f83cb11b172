// A body meshed for some of its vertices, ready to be pressed: tetrahedra, supports,
// factor, contact surface.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "formats/scene/scene.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/body/scene_body.h"
#include "precompute/contact/contact_surface.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/cholesky_factor.h"
#include "precompute/tets/cut_regions.h"

namespace palpate {

/// Most surface triangles of a body. Past this number a body of compact shape has some
/// 200 000 quadratic nodes, and its factor outgrows the memory of a small machine.
inline constexpr Eigen::Index kMostTriangles = 30000;

struct BodyModel {
  QuadraticMesh mesh;
  /// Corner of the mesh that a vertex of the body is; empty: the first nodes are the
  /// vertices of the body. Those that the model was not made for may be missing.
  std::unordered_map<std::int32_t, std::int32_t> corner;
  std::vector<Material> material;  ///< by region of the mesh
  ContactSurface contact;
  Supports supports;
  std::optional<CholeskyFactor> factor;
  /// K over the free unknowns, lower triangle; only where asked for, else empty.
  Stiffness stiffness;
  double contact_spacing_m = 0.0;  ///< [m] of contact nodes where a contact ends
  double times_finer = 1.0;        ///< [-] than asked for, around what it was made for
  double min_dihedral_deg = 0.0;   ///< [deg] of the tets
};

/// Tets that fill a surface of the body. Where it has parts that reach its surface,
/// tets are cut along them, and the surface with them.
[[nodiscard]] FilledBody filled_body(const BodySource& body,
                                     const SurfaceMesh& surface);

/// The body's surface with every triangle cut into four until contact nodes are no
/// farther apart than wanted.
struct UniformSurface {
  SurfaceMesh surface;
  int subdivisions = 0;
  double node_spacing_m = 0.0;  ///< [m] mean distance of contact nodes
  bool fine_enough = true;  ///< false: stopped at the most triangles that are sensible
};
[[nodiscard]] UniformSurface uniform_surface(
    const BodySource& body, double spacing_m,
    Eigen::Index triangles_max = kMostTriangles);

/// The body's surface, refined for contact nodes `spacing_m` apart within `reach_m` of
/// the given vertices. Longer edges are halved there; beyond, edges may grow by half of
/// the distance. For bodies of which only a part is pressed.
[[nodiscard]] UniformSurface pressed_surface(
    const BodySource& body, std::span<const std::int32_t> vertices, double spacing_m,
    double reach_m, Eigen::Index triangles_max = kMostTriangles);

/// Contact nodes (vertices and edge middles) of a surface within reach_m of any of the
/// body's given vertices.
[[nodiscard]] std::int64_t contact_nodes_near(const SurfaceMesh& surface,
                                              const BodySource& body,
                                              std::span<const std::int32_t> vertices,
                                              double reach_m);

/// Surface nodes of the mesh that the scene holds.
[[nodiscard]] Supports scene_supports(const Scene& scene, const QuadraticMesh& mesh);

/// Stiffness of the mesh and of the foundations that it stands on.
/// @param material by region.
[[nodiscard]] Stiffness scene_stiffness(const Scene& scene, const QuadraticMesh& mesh,
                                        std::span<const Material> material);

/// Which supports a point belongs to, as bits.
[[nodiscard]] int support_part(const Scene& scene, const Eigen::Vector3d& p_m);

/// @throws InputError if the model's supports do not hold it.
void check_held(const Scene& scene, const BodyModel& model);

/// Tetrahedralises, holds, assembles and factorises.
/// @param surface of the body, refined; its first vertices are the body's.
/// @throws InputError where the supports do not hold the body. Also where its factor
/// would not fit into this machine's memory (require_memory).
/// @throws NumericalError where meshing or factorisation failed.
[[nodiscard]] BodyModel make_body_model(const Scene& scene, const BodySource& body,
                                        const SurfaceMesh& surface);

/// Corner of the model's mesh that a vertex is.
[[nodiscard]] std::int32_t corner_of(const BodyModel& model, std::int32_t vertex);

/// The surface that make_graded_model() meshes first.
[[nodiscard]] SurfaceMesh graded_surface(const Scene& scene, const BodySource& body,
                                         std::span<const std::int32_t> vertices,
                                         const ContactFocus& focus);

/// The model on a surface that is refined around the given vertices. Farther away the
/// surface is coarsened where the body is finer than its contact can feel. Its edges
/// stay shorter than the mesh wants them there. Where the coarse surface cannot be
/// meshed two less coarse ones are tried, then the body's own is taken. Where tets
/// under the tool are slivers, which are too stiff, slightly finer and coarser surfaces
/// are tried.
/// @param keep_stiffness beside its factor.
[[nodiscard]] BodyModel make_graded_model(const Scene& scene, const BodySource& body,
                                          std::span<const std::int32_t> vertices,
                                          const ContactFocus& focus,
                                          bool keep_stiffness = false);

}  // namespace palpate
