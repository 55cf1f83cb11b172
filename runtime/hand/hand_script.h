// Where a simulated hand wants the tool: the motions of a person who feels a body.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

struct HandTarget {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< [-] body from tool
};

/// Approach a surface point along its normal, press, slide in a circle, press deeper,
/// release; again and again. Every motion starts and ends at rest and is twice
/// differentiable. Depths are the hand's: the body holds the tool back, so the tool is
/// less deep by its force over the hand's stiffness.
struct HandScript {
  Eigen::Vector3d surface_m = Eigen::Vector3d::Zero();  ///< [m] the point to press
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();    ///< [-] unit, outward
  double touch_m = 0.0;    ///< [m] height of the reference point at touch (tool radius)
  double clear_m = 0.01;   ///< [m] > 0 height above touch before and after
  double press_m = 0.002;  ///< [m] depth of the slide, below touch
  double deeper_m = 0.004;  ///< [m] depth of the second press, below touch
  double circle_m = 0.005;  ///< [m] >= 0 radius of the slide
  double duration_s = 4.0;  ///< [s] > 0 of one round
  double still_s = 0.0;     ///< [s] >= 0 at rest above the surface before the first one

  /// The target at `time_s` [s] >= 0 from the start.
  [[nodiscard]] HandTarget at(double time_s) const noexcept;
};

}  // namespace palpate
