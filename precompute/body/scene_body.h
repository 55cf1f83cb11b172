// A scene's body as its files describe it, read and checked once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "formats/mesh/surface_search.h"
#include "formats/scene/scene.h"
#include "precompute/contact/held_obstacle.h"
#include "precompute/contact/tool_surface.h"
#include "precompute/material/material.h"
#include "precompute/surface/repair.h"
#include "precompute/tets/inner_surface.h"

namespace palpate {

struct BodySource {
  SurfaceMesh surface;          ///< in metres, outside out; its vertices are the nodes
  Points normal;                ///< (n_vertices x 3) outward unit normals
  std::vector<HeldPoint> held;  ///< of the surface, by fixed supports
  /// Of inclusions, as the scene has them, then cavities that the body's mesh has.
  std::vector<InnerSurface> inner;
  std::vector<Material> material;  ///< by region: the body, then the inclusions
  std::vector<std::shared_ptr<const ToolSurface>> tool;  ///< as the scene has them
  std::vector<std::filesystem::path> files;              ///< that were read
  std::vector<std::string> notes;  ///< what was changed, one line each
};

/// @param repair of the body's mesh file: vertices that it adds are the body's like
/// others; every change is a note.
/// @throws InputError for a body or scene that the user can mend, as a support that no
/// part of the surface lies in.
[[nodiscard]] BodySource read_body(const Scene& scene,
                                   RepairMode repair = RepairMode::kOff);

/// BodySource::material of a scene: of the body, then of its inclusions, a cavity's
/// being the body's. @throws InputError naming the region without one, or its constant
/// that is out of range.
[[nodiscard]] std::vector<Material> materials_of(const Scene& scene);

/// The same body with a vertex at a place of its surface, the last: its normal is the
/// place's, between those of the triangle's vertices. @param place as split_at()'s.
[[nodiscard]] BodySource with_vertex_at(const BodySource& body,
                                        const SurfacePoint& place);

/// Whether a fixed support holds the surface there.
[[nodiscard]] bool is_held(const Scene& scene, const Eigen::Vector3d& p_m);

/// Area of the body's surface that each support holds, or that its springs stand under
/// [m^2]. The area is counted by points that lie four or more to a support's smallest
/// extent.
[[nodiscard]] std::vector<double> supported_areas_m2(const Scene& scene,
                                                     const SurfaceMesh& surface);

/// Vertices to press: in the scene's reach and not held; ascending.
/// @throws InputError if there are none.
[[nodiscard]] std::vector<std::int32_t> reachable_vertices(const Scene& scene,
                                                           const BodySource& body);

}  // namespace palpate
