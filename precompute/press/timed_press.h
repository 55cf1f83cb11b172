// Presses of a few nodes at several numbers of depths, each with its price. Meshes,
// factors and compliances are made once, as they do not depend on depths.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/press/node_press.h"
#include "precompute/press/scene_solver.h"

namespace palpate {

/// Processor time by what it grows with.
struct PressPrice {
  double once_s = 0.0;       ///< [s] whatever the number of nodes
  double per_group_s = 0.0;  ///< [s] for each group of neighbours that share a mesh
  double per_node_s = 0.0;   ///< [s]
  std::int64_t peak_memory_bytes = 0;
};

struct PricedPresses {
  int depths = 0;
  std::vector<PressedNode> node;  ///< by vertex, ascending
  PressPrice price;
};

/// Linear presses on the strategy's shared mesh; nonlinear ones on it as well if asked.
/// @param reachable every vertex of the build, among them `vertices`; both ascending.
[[nodiscard]] std::vector<PricedPresses> press_on_shared_mesh(
    const Scene& scene, const BodySource& body, const PressStrategy& strategy,
    std::span<const std::int32_t> reachable, std::span<const std::int32_t> vertices,
    std::span<const int> depths, bool nonlinear);

/// Presses on meshes of groups of neighbours, as press_on_own_mesh does.
[[nodiscard]] std::vector<PricedPresses> press_on_own_meshes(
    const Scene& scene, const BodySource& body, const ContactFocus& focus,
    std::span<const std::int32_t> vertices, std::span<const int> depths,
    PressMode mode);

}  // namespace palpate
