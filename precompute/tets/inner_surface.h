// Closed surfaces inside a body that part it into regions.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// The boundary of an inclusion, or of a hole, in a body.
struct InnerSurface {
  SurfaceMesh surface{};  ///< closed; it may have several disjoint parts
  bool cavity = false;    ///< what is inside is empty
  std::string name{};     ///< for messages; empty: only its number
  /// It reaches the outer surface or another inner one: tets are made without it, and
  /// then cut along it (cut_regions.h).
  bool cut = false;
  /// [m] above 0: a layer, all within this distance of the outer surface, and `cut`;
  /// it has no surface of its own.
  double under_m = 0.0;
};

/// Sets `cut` of those that touch or cross the outer surface or each other.
/// @throws InputError for a cavity among them.
void mark_cut(const SurfaceMesh& outer, std::span<InnerSurface> inner);

/// How a message names inner surface i: its name, or its number from 1.
[[nodiscard]] std::string inner_surface_name(std::span<const InnerSurface> inner,
                                             std::size_t i);

/// The inner surfaces, with those that were inside out turned. Surfaces to be `cut` are
/// passed over. Each other surface must bound a body, lie strictly inside the outer
/// surface, and neither touch nor cross the outer one or another. One inside another is
/// permitted, unless the other is a cavity.
/// @param outer counter-clockwise from outside, as check_surface() gives it.
/// @throws InputError naming the surface, and what is wrong with it where.
[[nodiscard]] std::vector<InnerSurface> check_inner_surfaces(
    const SurfaceMesh& outer, std::span<const InnerSurface> inner);

}  // namespace palpate
