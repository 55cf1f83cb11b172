// How fine a body must be meshed, and around which of its vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/surface/refine_surface.h"

namespace palpate {

/// Edge length at distance r from a pressed vertex: growth * (r - core_m), never below
/// finest_m. The contact at a sixteenth of the largest depth needs finest_m. So a
/// shallow contact has as many nodes across as a deep one. A contact's radius over the
/// distance of contact nodes (half an edge) is 2 / growth. Around the rim of a flat
/// punch edges shrink likewise.
struct ContactFocus {
  double growth = 1.0;     ///< [-] edge over distance
  double finest_m = 0.0;   ///< [m] smallest edge that is asked for
  double rim_m = 0.0;      ///< [m] radius of a punch's rim, 0 for none
  double core_m = 0.0;     ///< [m] distance up to which edges stay at finest_m
  double contact_m = 0.0;  ///< [m] largest radius of a contact
};

/// From the scene's tools, largest depth and accuracy budget. With gradings measured on
/// spheres (growth 0.5, 0.8, 1.1: force errors of 0.5, 1, 3 %), the mesh takes about
/// half of the budget.
[[nodiscard]] ContactFocus contact_focus(const Scene& scene, const BodySource& body);

/// The same, some times finer (or coarser below 1).
[[nodiscard]] ContactFocus finer(ContactFocus focus, double times);

/// Distance of contact nodes [m] that a uniformly fine surface should have. A nonlinear
/// correction leaves less of the budget to it.
[[nodiscard]] double uniform_spacing_m(const Scene& scene, const BodySource& body,
                                       bool nonlinear);

/// Radius around a vertex that the tools may touch, pressed to the scene's depth [m].
/// It is the largest patch_radius_m() on a flat surface of contact nodes so far apart.
[[nodiscard]] double touched_radius_m(const Scene& scene, const BodySource& body,
                                      double node_spacing_m);

/// Wanted edges for a mesh that serves all the given vertices.
[[nodiscard]] EdgeLength wanted_edges(const SurfaceMesh& surface,
                                      std::span<const std::int32_t> vertices,
                                      const ContactFocus& focus);

/// Splits vertices along a space-filling curve into sets of neighbours, all of about
/// the same size, at most `size`. Each ascending; same input, same sets, same order.
[[nodiscard]] std::vector<std::vector<std::int32_t>> in_neighbourhoods(
    const SurfaceMesh& surface, std::span<const std::int32_t> vertices,
    std::size_t size);

/// Groups that share one mesh. A group has as many neighbours as add about as many
/// triangles as the body itself has. All vertices are one group where the body is as
/// fine as the contact wants.
[[nodiscard]] std::vector<std::vector<std::int32_t>> group_vertices(
    const SurfaceMesh& surface, std::span<const std::int32_t> vertices,
    const ContactFocus& focus);

/// Groups for presses on meshes of their own, as of group_vertices(). Nonlinear presses
/// have every vertex alone: they cost more the finer the body is elsewhere.
[[nodiscard]] std::vector<std::vector<std::int32_t>> group_presses(
    const SurfaceMesh& surface, std::span<const std::int32_t> vertices,
    const ContactFocus& focus, bool nonlinear);

}  // namespace palpate
