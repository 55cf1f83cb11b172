// A needle and its channels, for drawing: where they are, what has broken, and the
// force along the needle at every depth.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "formats/recording/tick_record.h"
#include "runtime/fast/needle_step.h"
#include "runtime/view/view_contact.h"

namespace palpate {

/// A needle as the latest tick of a frame left it.
struct ViewNeedle {
  NeedleState state;
  std::int32_t along = -1;   ///< channel along which depths count; -1: none
  double tip_below_m = 0.0;  ///< [m] from the tool's reference point, at touch
};

/// @param before of the frame before: ticks of a frame in which the needle has left its
/// channel still count along it.
[[nodiscard]] ViewNeedle view_needle(const NeedleState& state, const ToolShape& tool,
                                     const std::optional<ViewNeedle>& before);

/// [m] the tip's depth below the surface at rest, along the channel; in none as ticks
/// have it.
[[nodiscard]] double tip_m(const ViewNeedle& needle, const TickRecord& tick);

/// [N] along the same axis, positive where the body pushes the needle out; without a
/// channel all of the force.
[[nodiscard]] double axial_n(const ViewNeedle& needle, const TickRecord& tick);

/// view_contact(). A needle in a channel presses no surface: the contact is where it
/// went in, and the needle stands along the channel.
[[nodiscard]] ViewContact tool_contact(const ResponseDatabase& database,
                                       const ToolShape& tool,
                                       const SurfaceSearch& search,
                                       const Eigen::Vector3d& x_m, std::int32_t from,
                                       const std::optional<ViewNeedle>& needle);

/// One object: the channel that the needle is in ("in", -1: none), force along it,
/// inserted length, counts and energies of NeedleState. "channels" has each with entry
/// of the tip, axis outward, depth and layers. Layers have the depths where they begin
/// and rows of puncture_text()'s materials. "broke_m" and "broke_n" are tip depth and
/// force when each membrane broke, of the layers entered; null of an earlier run.
[[nodiscard]] std::string needle_text(const ViewNeedle& needle, const TickRecord& now);

/// What of a puncture does not change: names of materials and the mouth. "deepest_m" is
/// where the deepest layer begins that a needle gets to. "null" without puncture.
[[nodiscard]] std::string puncture_text(const ResponseTable& table);

}  // namespace palpate
