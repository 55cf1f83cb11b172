// Small bodies with known responses, made in memory.
#pragma once

#include <functional>

#include "formats/database/response_database.h"

namespace palpate {

/// Force [N] at depth [m] of a node.
using NodeForce = std::function<double(Eigen::Index node, double depth_m)>;

/// A closed sphere about the origin: an icosahedron, each triangle cut in four
/// `refinements` times; 10 * 4^r + 2 vertices.
[[nodiscard]] SurfaceMesh sphere_surface(double radius_m, int refinements);

/// The same, its coordinates times `by`.
[[nodiscard]] SurfaceMesh stretched(SurfaceMesh mesh, const Eigen::Vector3d& by);

/// A body with a blunt edge and a hollow, as an organ has them; 0.18 m long.
[[nodiscard]] SurfaceMesh organ_like(int refinements);

/// An open square plate in the plane z = 0, outside upwards: (cells + 1)^2 vertices,
/// centred at the origin.
[[nodiscard]] SurfaceMesh plate(double side_m, int cells);

/// A spherical tool "ball".
[[nodiscard]] ToolShape ball(double radius_m, double friction, double presliding_m);

/// A database whose responses act along the normals: every curve sampled at `samples`
/// equal steps to depth_max_m.
[[nodiscard]] ResponseDatabase sample_database(const SurfaceMesh& mesh,
                                               const ToolShape& tool,
                                               const NodeForce& force,
                                               double depth_max_m, int samples = 21);

}  // namespace palpate
