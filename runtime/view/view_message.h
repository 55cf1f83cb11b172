// What a page of the live view may ask for: the decoder of its messages. The messages
// come from whoever can reach the socket and are believed in nothing.
//
// A message is one JSON object of at most kViewMessageBytes bytes, with the keys below
// and no others:
//
//   {"type": "point", "hold": true, "target_m": [x, y, z]}   where the hand wants the
//                                              tool; hold false lets go (no target_m)
//      with "hand": 1 of the second of two hands; without, of the first, and letting go
//      is of both; with "turn": [x, y, z, w] a tool of several contacts turns
//   {"type": "set", "model": "potential", "slow_hz": 100, "stiffness_scale": 1,
//    "friction": 0.3, "coupled": false}        any of them; friction null: the
//                                              database's; coupled: several contacts
//   {"type": "run", "do": "pause"}             pause, resume, step, reset, record,
//                                              replay; anew: the scene that computes
//                                              the body has changed
//   {"type": "device", "do": "on", "node": 12, "right": [x, y, z], "limit": false}
//                                              the page's own device presses from over
//                                              the node, its x axis to the right of the
//                                              picture; limit: softened to what it
//                                              renders; keep: still wanted; off
//   {"type": "node", "node": 12}               the curve of a node
//   {"type": "field", "node": 12}              how the surface moves under it
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "runtime/account/local_model.h"

namespace palpate {

constexpr std::size_t kViewMessageBytes = 4096;

enum class ViewAction : std::uint8_t {
  kPoint,
  kSet,
  kPause,
  kResume,
  kStep,
  kReset,
  kRecord,
  kReplay,
  kAnew,
  kDevice,
  kDeviceKept,
  kDeviceOff,
  kNode,
  kField
};

/// Ranges that the decoder holds every number to.
struct ViewRanges {
  static constexpr double kTargetM = 10.0;         ///< [m] largest coordinate
  static constexpr double kSlowHzMin = 1.0;        ///< [Hz]
  static constexpr double kSlowHzMax = 2000.0;     ///< [Hz]
  static constexpr double kStiffnessMin = 0.05;    ///< [-] of stiffness_scale
  static constexpr double kStiffnessMax = 10.0;    ///< [-] of stiffness_scale
  static constexpr double kFrictionMax = 2.0;      ///< [-] Coulomb coefficient
  static constexpr double kQuaternionMin = 0.5;    ///< [-] least length of turn
  static constexpr double kDirectionMost = 1.001;  ///< [-] of a unit vector, rounded
};

/// A decoded message; which fields count depends on the action.
struct ViewRequest {
  ViewAction action = ViewAction::kPoint;
  bool hold = false;
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();  ///< [m] if hold
  std::optional<int> hand = {};                        ///< 0 or 1
  std::optional<Eigen::Quaterniond> turn = {};         ///< unit, if hold
  std::optional<LocalModel> model = {};
  std::optional<double> slow_hz = {};          ///< [Hz]
  std::optional<double> stiffness_scale = {};  ///< [-] forces are multiplied by it
  std::optional<double> friction = {};         ///< [-] for every node
  bool database_friction = false;              ///< friction as stored again
  std::optional<bool> coupled = {};            ///< contacts through the body
  std::int32_t node = -1;                      ///< >= 0; the database may have fewer
  Eigen::Vector3d right = Eigen::Vector3d::Zero();  ///< of the picture, if kDevice
  bool limit = false;                               ///< stiffness, likewise
};

/// @throws InputError saying, in one line without any of the message's own text, what
/// was not allowed.
[[nodiscard]] ViewRequest decode_view_message(std::string_view text);

}  // namespace palpate
