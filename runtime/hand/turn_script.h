// How a simulated hand turns a tool while it moves it: the wrist of hand_script.h.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/response/turn_from_z.h"

namespace palpate {

/// From upright on the surface the tool rocks to both sides and turns about the normal
/// to and fro. The speeds have no common period; the tool is at rest at time 0.
struct TurnScript {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< [-] the tool's z when upright
  double tilt_rad = 0.1;                              ///< [rad] most about either side
  double turn_rad = 0.5;                              ///< [rad] most about the normal

  /// The tool's orientation at `time_s` [s] >= 0: body frame from tool frame.
  [[nodiscard]] Eigen::Quaterniond at(double time_s) const {
    const auto swing = [&](double period_s) {
      return 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * time_s / period_s));
    };
    const auto upright = turn_from_z(normal);
    return (upright *
            Eigen::AngleAxisd(tilt_rad * (swing(1.7) - swing(2.3)),
                              Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(tilt_rad * (swing(1.3) - swing(1.9)),
                              Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(turn_rad * (swing(3.1) - swing(4.3)),
                              Eigen::Vector3d::UnitZ()))
        .normalized();
  }
};

}  // namespace palpate
