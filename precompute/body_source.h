// A scene's body as its files describe it, read and checked once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/scene.h"
#include "formats/surface_mesh.h"
#include "precompute/material.h"

namespace palpate {

struct BodySource {
  SurfaceMesh surface;  ///< in metres, outside out; its vertices are the nodes
  Points normal;        ///< (n_vertices x 3) outward unit normals
  std::vector<Material> material;  ///< by region: the body, then the inclusions
  std::vector<std::string> notes;  ///< what was changed, one line each
};

/// @throws InputError for a body or scene that the user can mend.
[[nodiscard]] BodySource read_body(const Scene& scene);

/// Vertices to press: in the scene's reach and not held; ascending.
/// @throws InputError if there are none.
[[nodiscard]] std::vector<std::int32_t> reachable_vertices(const Scene& scene,
                                                           const BodySource& body);

}  // namespace palpate
