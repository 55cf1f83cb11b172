// How a scene's contacts couple through its body: the table of compliance by distance
// that is stored for tools that couple (compliance_table.h).
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "formats/response/compliance_table.h"
#include "formats/response/response_table.h"
#include "formats/scene/scene.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/process/progress.h"

namespace palpate {

constexpr std::size_t kCouplingKnots = 25;
/// Sets of contacts are tried no closer than that, in contact radii of the largest
/// depth.
constexpr double kClosestInRadii = 1.8;

/// Whether contacts of some tool of the scene couple.
[[nodiscard]] bool couples(const Scene& scene);

/// Distances of a scene's table [m]. The smallest distance is one and a half contact
/// radii. The contact is that of the smallest tool that couples, pressed to half of the
/// largest depth. The largest distance is that of the two vertices farthest apart.
[[nodiscard]] std::vector<double> coupling_distances(
    const Scene& scene, const BodySource& body, std::span<const std::int32_t> vertices);

/// The surface of the table's mesh, as even as the table wants it: two and a half
/// distances of contact nodes in its first one.
[[nodiscard]] UniformSurface coupling_surface(const BodySource& body, double first_m);

/// The scene's body, linear, meshed within that surface.
/// @throws InputError for scenes with [cutout], and as make_body_model().
[[nodiscard]] BodyModel coupling_model(const Scene& scene, const BodySource& body,
                                       double first_m);

/// Table of a linear body for vertices that are pressed and those that share a triangle
/// with them; rows of others are 0. Each row takes one solve: displacements for 1 N of
/// the smallest tool's contact there (contact_spot.h). Displacements times distance are
/// averaged by area over the surface around the pressed vertices, in bins. The bins
/// overlap like hats between neighbouring distances. Bins with hardly any surface have
/// the mean of the other vertices' bins.
/// @param model of small strains: of a nonlinear body its linear one.
/// @param vertices that are pressed, ascending.
[[nodiscard]] ComplianceTable coupling_table(const Scene& scene, const BodySource& body,
                                             const BodyModel& model,
                                             std::span<const std::int32_t> vertices,
                                             const std::vector<double>& distance_m,
                                             Progress& progress);

/// The three in turn.
[[nodiscard]] ComplianceTable make_coupling_table(
    const Scene& scene, const BodySource& body, std::span<const std::int32_t> vertices,
    Progress& progress);

/// Distances of contacts of one set.
struct ApartBetween {
  double closest_m = 0.0;   ///< [m] of any two
  double farthest_m = 0.0;  ///< [m] from the first
};

/// Nodes at random that lie together, but not too close; fewer than wanted where no
/// more are found. @param nodes not empty.
[[nodiscard]] std::vector<std::int32_t> set_of_contacts(
    std::span<const std::int32_t> nodes, const Points& position_m,
    const ApartBetween& apart, std::size_t count, std::mt19937_64& random);

/// Whether contacts at sets of the table's nodes have one equilibrium at any depths.
/// The criterion: diag(1 / k) + C, with k the largest slopes of the nodes' curves, is
/// positive definite. It is tested for 900 sets of 2, 4 and 9 nodes that lie together,
/// no two of them closer than closest_m.
[[nodiscard]] bool one_equilibrium(const ComplianceTable& coupling,
                                   const ResponseTable& responses,
                                   const Points& position_m, double closest_m);

}  // namespace palpate
