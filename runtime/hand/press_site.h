// Where on a body a simulated hand presses, and how deep.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "runtime/hand/hand_script.h"

namespace palpate {

/// The node to press. With `at_m` [m] it is the node with a response that is nearest to
/// it. Without `at_m` it is the one deepest inside the reachable part (most edges away
/// from a node without response), of those the highest (largest z).
/// @throws InputError if no node has a response.
[[nodiscard]] std::int32_t node_to_press(const ResponseDatabase& database,
                                         const ResponseTable& table,
                                         const std::optional<Eigen::Vector3d>& at_m);

/// What the hand does at a node. The hand presses to 0.3 and 0.6 of the depth that the
/// node's curve covers. If that is less, it presses to where the curve's force reaches
/// 0.4 and 0.8 of force_max_n [N]. Then the hand circles over some elements.
/// @param force_scale [-] by which rendered forces are multiplied.
/// @param hand_n_per_m [N/m] > 0 stiffness of the grip, whose give is added.
[[nodiscard]] HandScript script_at(const ResponseDatabase& database,
                                   const ResponseTable& table, std::int32_t node,
                                   double force_max_n, double force_scale,
                                   double hand_n_per_m);

}  // namespace palpate
