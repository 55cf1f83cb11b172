// Which chunks of a body a moving tool needs, and how much memory that takes: from the
// index alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/database/database_index.h"

namespace palpate {

struct ToolMotion {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();        ///< [m]
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();  ///< [m/s]
};

/// Position in index.tools of the named tool, or of the only one for an empty name.
/// @throws InputError naming the tools that there are.
[[nodiscard]] std::size_t find_tool(const DatabaseIndex& index,
                                    const std::string& name);

/// [m] Around a chunk's nodes and triangles.
[[nodiscard]] Eigen::AlignedBox3d chunk_box(const DatabaseIndex& index,
                                            std::int64_t chunk);

/// Chunks near the tool, the most urgent first. Follows the tool along its present
/// velocity for horizon_s [s] >= 0. For a point s metres ahead and a chunk at distance
/// d from it: the chunk is taken if d + 0.1 s is at most the smallest (distance + 0.4
/// box diagonal) of any chunk plus 0.1 of the whole way; chunks are ordered by d + 0.5
/// s, so that near ones come first.
[[nodiscard]] std::vector<std::int64_t> chunks_near(const DatabaseIndex& index,
                                                    const ToolMotion& motion,
                                                    double horizon_s);

/// Bytes that a chunk takes, loaded and as part of a piece of surface.
[[nodiscard]] std::size_t bytes_in_use(const DatabaseIndex& index, std::size_t tool,
                                       std::int64_t chunk);

/// Least budget [bytes] that holds a neighbourhood wherever the tool is: twice the nine
/// largest chunks, because a new one and eight around it are loaded while the old ones
/// are in use.
[[nodiscard]] std::size_t least_budget(const DatabaseIndex& index, std::size_t tool);

}  // namespace palpate
