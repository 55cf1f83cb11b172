// What stored tilts keep to.
#pragma once

#include <cstdint>
#include <span>

#include "formats/mesh/surface_mesh.h"
#include "formats/response/response_table.h"

namespace palpate {

/// Both parts of a node's tilt, or none for all; 0 without a response. The tilt lies in
/// the plane across the normal to 1e-9 over the depths of the curve. The tilt keeps its
/// limits (tilt_line.h). @throws FormatError naming the node, counted from `first`.
/// @param normal (n x 3) [-] of the table's nodes.
/// @param longest_edge_m (n) [m] at each node, which limits the change by depth. Empty
///   where the whole body is not at hand: that limit is not checked.
void check_tilts(const Points& normal, const ResponseTable& table, std::int64_t first,
                 std::span<const double> longest_edge_m);

}  // namespace palpate
