// Poses and wrenches of a run as comma-separated values: written by a run, and poses
// read again, of a run or of a laboratory's tracker.
//
//   time_s, then for each hand a = 1, 2: xa_m, ya_m, za_m, qxa, qya, qza, qwa and, as
//   written, fxa_n, fya_n, fza_n, txa_n_m, tya_n_m, tza_n_m (on the tool, about its
//   reference point, in the body's frame), then contacts, depth_m, stored_j, tank_j,
//   dissipated_j, work_j.
//
// Numbers have 17 digits, so that a replay of the poses is the run bit for bit. Times
// are whole nanoseconds.
#pragma once

#include <filesystem>
#include <vector>

#include "runtime/render/render_report.h"

namespace palpate {

/// @throws InputError if the place cannot be written.
void write_pose_trace(const std::filesystem::path& file, int ports,
                      const std::vector<RenderTick>& ticks);

/// Columns by their names, in any order, others passed over. Quaternions of any length
/// but 0 are made units; those within 1e-12 of it stay as they are.
/// @param ports hands that must be there. @throws InputError naming line and column.
[[nodiscard]] std::vector<RenderTick> read_poses(const std::filesystem::path& file,
                                                 int ports);

}  // namespace palpate
