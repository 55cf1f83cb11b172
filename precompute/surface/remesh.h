// A surface with triangles of even size and shape.
#pragma once

#include <cstddef>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct RemeshReport {
  double edge_mean_before_m = 0.0;
  double edge_mean_m = 0.0;
  double smallest_angle_before_rad = 0.0;
  double smallest_angle_rad = 0.0;
  double displaced_m = 0.0;      ///< largest distance between the two surfaces
  double volume_relative = 0.0;  ///< change
  std::size_t features = 0;      ///< edges sharper than 60 degrees, which stayed
};

struct RemeshedSurface {
  SurfaceMesh mesh;
  RemeshReport report;
};

/// Cuts, collapses and swaps edges until they are about edge_m long, and moves vertices
/// along the surface (Botsch and Kobbelt 2004). Edges where the surface turns by more
/// than 60 degrees stay, cut to length, where they make lines that span two new edges.
/// Places where that makes the surface cross itself are cut out and filled
/// (repair_intersections.h). Done in a child process; the vertices are new.
/// @param mesh a body (see check_surface). @param edge_m [m] > 0.
/// @throws InputError if the surface is no body, or has specks, or more than about
/// 2,000,000 triangles would be made. Also if the body is thinner than the edges can
/// follow. The result then crosses itself, or has lost parts or more than 10 % of its
/// volume.
[[nodiscard]] RemeshedSurface remesh_surface(const SurfaceMesh& mesh, double edge_m);

}  // namespace palpate
