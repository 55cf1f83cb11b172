// Which chunks of a body a moving tool needs, and how much memory that takes: from the
// index alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

/// Chunks near any contact, the most urgent first. Follows each along its present
/// velocity for horizon_s [s] >= 0. A point s metres ahead has the distance d from a
/// chunk. The chunk is taken if d + 0.1 s is at most the smallest (distance + 0.4 box
/// diagonal) plus 0.1 of the whole way. The smallest is that of any chunk. Chunks are
/// ordered by d + 0.5 s, so near ones come first.
[[nodiscard]] std::vector<std::int64_t> chunks_near(
    const DatabaseIndex& index, std::span<const ToolMotion> contacts, double horizon_s);

/// What is kept of a chunk.
struct ChunkContent {
  std::size_t tool = 0;  ///< position in index.tools, of the responses
  /// The same, whose rows of compliance go along; none: contacts do not couple.
  std::optional<std::size_t> coupling = {};
};

/// Bytes that a chunk takes, loaded and as part of a piece of surface.
[[nodiscard]] std::size_t bytes_in_use(const DatabaseIndex& index,
                                       const ChunkContent& content, std::int64_t chunk);

/// Where the contacts of one table of responses are to each other.
struct ContactSpread {
  int hands = 1;          ///< that hold them
  int contacts = 1;       ///< of a hand, at most
  double extent_m = 0.0;  ///< [m] largest distance of two in one hand
};

/// Least budget [bytes] that holds a neighbourhood wherever the tool is. The budget
/// counts the largest chunks that there are, twice. For each hand it counts nine chunks
/// a contact, or all that may lie within the contacts' extent and eight around if that
/// is less. Twice, because new ones are loaded while the old ones are in use. Never
/// more than twice all.
[[nodiscard]] std::size_t least_budget(const DatabaseIndex& index,
                                       const ChunkContent& content,
                                       const ContactSpread& spread = {});

}  // namespace palpate
