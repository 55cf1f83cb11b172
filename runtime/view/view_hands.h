// Tools of several contacts and two hands, for drawing: poses, contacts, wrenches, and
// what the contacts would do if nobody coupled them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/database/response_database.h"
#include "formats/recording/tick_record.h"
#include "runtime/render/contacts_seen.h"

namespace palpate {

struct ViewHand {
  Eigen::Vector3d tool_m = Eigen::Vector3d::Zero();  ///< [m] reference point
  Eigen::Quaterniond turn =
      Eigen::Quaterniond::Identity();  ///< [-] from the tool's frame
  Eigen::Vector3d hand_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d pointer_m = Eigen::Vector3d::Zero();
  bool holding = false;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();     ///< [N] on the tool
  Eigen::Vector3d torque_n_m = Eigen::Vector3d::Zero();  ///< about the reference point
  /// [N] of the body at this pose, without friction and delta_0. `coupled_n` is with
  /// contacts that couple through the body. `added_up_n` adds the contacts up as if
  /// each had the body alone.
  Eigen::Vector3d coupled_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d added_up_n = Eigen::Vector3d::Zero();
};

/// One contact sphere that has found the body.
struct ViewTouch {
  int hand = 0;
  double radius_m = 0.0;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< [m] on the body at rest
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();   ///< [-] outward
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< [N] on the tool
  double depth_m = 0.0;                               ///< [m] signed
  double own_m = 0.0;  ///< [m] of that what its own force sinks the body by
  std::array<std::int32_t, 3> node{-1, -1, -1};     ///< of the element ...
  Eigen::Vector3d share = Eigen::Vector3d::Zero();  ///< ... with the area coordinates
};

struct ViewHands {
  std::vector<ViewHand> hand = {};
  std::vector<ViewTouch> touch;
  bool coupled = true;   ///< as it is rendered
  bool scaled = false;   ///< the coupling is not whole (coupled_contacts.h)
  bool compared = true;  ///< coupled_n and added_up_n are known
};

/// A contact that has found the body.
[[nodiscard]] ViewTouch touch_at(const ResponseDatabase& database,
                                 const BodyContact& contact);

/// Members of a frame's object, without braces: hands and contacts now, and how large
/// forces and torques were in the frame's ticks.
[[nodiscard]] std::string hands_text(const ViewHands& hands,
                                     const std::vector<TickRecord>& ticks);

/// What of the tools does not change: an array, one object for each hand.
[[nodiscard]] std::string tools_text(const std::vector<const ResponseTable*>& tables);

}  // namespace palpate
