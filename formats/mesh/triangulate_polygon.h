// A polygon in space, cut into triangles.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace palpate {

/// Cuts a simple polygon, nearly plane, into n - 2 triangles of its own corners that
/// run round the same way. The best-shaped ear is taken off first. So a quadrangle is
/// cut along its better diagonal, and concave polygons are cut inside. A polygon
/// without an ear (crossing itself, without area) is cut in order; check_surface() then
/// finds the fault.
/// @param corner_m (n) [m], n >= 3. @return indices into corner_m.
[[nodiscard]] std::vector<std::array<std::size_t, 3>> triangulate_polygon(
    std::span<const Eigen::Vector3d> corner_m);

}  // namespace palpate
