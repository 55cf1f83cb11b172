// A scene's body, ready to be pressed: tetrahedra, supports, factor, contact surface.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/scene.h"
#include "formats/surface_mesh.h"
#include "precompute/cholesky_factor.h"
#include "precompute/contact_surface.h"
#include "precompute/progress.h"
#include "precompute/surface_compliance.h"

namespace palpate {

struct BodyModel {
  SurfaceMesh surface;  ///< as the scene's mesh has it, in metres, outside out
  Points normal;        ///< (n_vertices x 3) outward unit normals of `surface`
  QuadraticMesh mesh;   ///< its first n_vertices nodes are the vertices of `surface`
  std::vector<Material> material;  ///< by region of the mesh
  ContactSurface contact;
  Supports supports;
  std::optional<CholeskyFactor> factor;
  int subdivisions = 0;            ///< times each surface triangle was cut into four
  double node_spacing_m = 0.0;     ///< [m] mean distance of contact nodes
  double min_dihedral_deg = 0.0;   ///< [deg] of the tets
  std::vector<std::string> notes;  ///< what was changed or fell short, one line each
};

/// Reads, checks, subdivides, tetrahedralises, assembles and factorises.
/// @throws InputError for a body or scene that the user can mend, NumericalError where
/// meshing or factorisation failed.
[[nodiscard]] BodyModel make_body_model(const Scene& scene, Progress& progress);

/// Vertices to press: in the scene's reach and not held; ascending.
/// @throws InputError if there are none.
[[nodiscard]] std::vector<std::int32_t> reachable_vertices(const Scene& scene,
                                                           const BodyModel& body);

}  // namespace palpate
