// What a run must know of a streamed body before it starts: where to press, how stiff
// it gets. Reads the index and a few chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/database/chunk_reader.h"
#include "runtime/device/stability_margin.h"
#include "runtime/slow/contact_stiffness.h"

namespace palpate {

/// A node to press, with the surface of its chunk.
struct StreamedPlace {
  std::int32_t source_node = -1;  ///< as the source counts
  std::int32_t row = -1;          ///< of `around`
  ResponseDatabase around;        ///< its chunk, with one tool
};

/// The node with a response nearest to `at_m` [m], or, without, the highest one.
/// @throws InputError if no node has a response, FormatError for a damaged chunk.
[[nodiscard]] StreamedPlace streamed_place(const ChunkReader& reader, std::size_t tool,
                                           const std::optional<Eigen::Vector3d>& at_m);

/// As rendered_stiffness(), with the tool's own friction everywhere.
[[nodiscard]] RenderedStiffness streamed_stiffness(const ChunkReader& reader,
                                                   std::size_t tool,
                                                   double force_max_n);

/// As stiffest_by_contact(), of the same stiffness.
[[nodiscard]] std::vector<StiffestNode> streamed_stiffest(const ChunkReader& reader,
                                                          std::size_t tool,
                                                          double force_max_n);

}  // namespace palpate
