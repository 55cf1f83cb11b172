// What an element message says of how its responses relax, and where the surface
// remembers it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/response/viscoelasticity.h"
#include "runtime/element/element.h"

namespace palpate {

/// What is the same at all nodes: terms, times, number of bundles.
[[nodiscard]] ElementMemory tool_memory(const Viscoelasticity& relaxation) noexcept;

/// A row's shares, sites and cuts. Without sites in the table the node itself is one.
/// @param relaxation with rows of nodes; its curves instantaneous, or none of its own.
/// @param node the message of the row, named as in the source.
[[nodiscard]] NodeMemory node_memory(const Viscoelasticity& relaxation,
                                     std::int64_t row, const ElementNode& node);

/// Where a curve is cut into bundles none of which falls with depth. The cuts are those
/// of the depths asked for beyond which no slope is below that of the cut, up to the
/// next cut. The bundles between others are empty, as are all but the first of a curve
/// that falls.
/// @param depth_m [m] > 0, increasing.
/// @returns not decreasing.
[[nodiscard]] std::array<double, kMemoryBundles - 1> bundle_cuts_m(
    const CurveView& curve, const std::vector<double>& depth_m);

}  // namespace palpate
