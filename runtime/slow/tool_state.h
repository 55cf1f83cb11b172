// What the fast process tells the slow one about the tool.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace palpate {

/// Written at every fast tick, the latest is read by the slow process.
struct ToolState {
  std::uint64_t sequence = 0;  ///< counts fast ticks from 1; 0: nothing written yet
  std::int64_t time_ns = 0;    ///< [ns] monotonic clock, when the device was read
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< [m] tool reference point
  std::int32_t triangle = -1;  ///< that holds the contact point; -1: none
  bool in_contact = false;
};

}  // namespace palpate
