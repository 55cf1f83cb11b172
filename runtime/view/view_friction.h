// The friction of a contact, for drawing: the spring that holds it sideways, and the
// loop of lateral force against lateral displacement.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "runtime/render/friction_seen.h"
#include "runtime/view/view_contact.h"

namespace palpate {

/// Ticks that wait to be taken, at most: the latest.
constexpr std::size_t kTicksKept = 8191;

/// A tick of a contact that rubs.
struct RubbedTick {
  Eigen::Vector3d slid_m = Eigen::Vector3d::Zero();   ///< [m] since the contact began
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< [N] of the spring on the tool
  double limit_n = 0.0;                               ///< [N] mu F_n
};

/// Friction as the latest tick of a frame left it.
struct ViewFriction {
  FrictionSeen now;
  /// Where the contact stuck: the tool's place less the stretch. None: nothing rubs.
  std::optional<ViewContact> anchor;
  std::vector<RubbedTick> ticks;  ///< since the frame before, those that rub
};

/// Follows a contact tick by tick. What the contact slid is the sum of the tool's
/// movements in the plane of the tick before, as the spring takes them. So d force / d
/// slid is the lateral stiffness while the contact sticks.
class FrictionTrail {
 public:
  void add(const FrictionSeen& seen);
  /// What came since the last call, of ticks at most the kTicksKept latest.
  [[nodiscard]] ViewFriction take();

 private:
  FrictionSeen last_;
  Eigen::Vector3d slid_m_ = Eigen::Vector3d::Zero();
  std::vector<RubbedTick> ticks_;
};

/// Whether a table's tool touches at one place, with friction, and is no needle: others
/// show none.
[[nodiscard]] bool shows_friction(const ResponseTable& table);

/// What passed, with its anchor on the body. @param from as of view_contact()
[[nodiscard]] ViewFriction view_friction(FrictionTrail& trail,
                                         const ResponseDatabase& database,
                                         const ToolShape& tool,
                                         const SurfaceSearch& search,
                                         std::int32_t from);

/// One object: "state" is "sticks", "slips" (the spring's force is at Coulomb's limit)
/// or "free". "stretch_m" and "force_n" (on the tool) are vectors of the world.
/// "limit_n" is mu F_n, "n_per_m" the mean lateral stiffness. "anchor" has "point_m",
/// "normal", "nodes" and "shares", null where nothing rubs. "trace" has every tick:
/// "slid_m" and "force_n", three numbers a tick, and "limit_n". A contact begins where
/// "slid_m" is zero.
[[nodiscard]] std::string friction_text(const ViewFriction& friction);

}  // namespace palpate
