// Poses and wrenches of a run as comma-separated values: written by a run, and poses
// read again, of a run or of a laboratory's tracker.
//
//   time_s, then for each hand a = 1, 2: xa_m, ya_m, za_m, qxa, qya, qza, qwa and, as
//   written, fxa_n, fya_n, fza_n, txa_n_m, tya_n_m, tza_n_m (on the tool, about its
//   reference point, in the body's frame), then contacts, depth_m, stored_j, tank_j,
//   dissipated_j, work_j.
//
// Numbers have 17 digits, so that a replay of the poses is the run bit for bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Geometry>

#include "runtime/contacts/coupled_step.h"

namespace palpate {

struct TracedPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

struct PoseTick {
  double time_s = 0.0;
  std::array<TracedPose, kPortsMax> pose;
  CoupledCommand command;  ///< of the tick; not read
  double work_j = 0.0;     ///< likewise
};

/// Work of hands from one pose to the next against the wrenches between [J]. @param
/// moved whether it counts what moved, or turns alone.
[[nodiscard]] double work_of_hands_j(const PoseTick& from, const PoseTick& to,
                                     std::size_t hands, bool moved);

/// @throws InputError if the place cannot be written.
void write_pose_trace(const std::filesystem::path& file, int ports,
                      const std::vector<PoseTick>& ticks);

/// Columns by their names, in any order, others passed over. Quaternions of any length
/// but 0 are made units; those within 1e-12 of it stay as they are.
/// @param ports hands that must be there. @throws InputError naming line and column.
[[nodiscard]] std::vector<PoseTick> read_poses(const std::filesystem::path& file,
                                               int ports);

}  // namespace palpate
