// A chunk of a database in memory, and what it costs there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "formats/database/chunk_reader.h"
#include "runtime/slow/chunk_choice.h"
#include "runtime/slow/element_message.h"

namespace palpate {

struct LoadedChunk {
  BodyChunk body;
  ResponseTable table;  ///< of the body's nodes; its compliance is the coupling tool's
  std::unordered_map<std::int32_t, ElementNode> thinned;  ///< by row; already scaled
  ResampleLoss loss;
  std::vector<std::int64_t> needs;  ///< other chunks with nodes of its triangles

  [[nodiscard]] NodeRows rows(double force_scale) const {
    return {body.position_m, body.normal, table, force_scale};
  }
};

/// Reads a chunk and verifies its checksums. @throws FormatError if it is damaged.
[[nodiscard]] std::shared_ptr<const LoadedChunk> load_chunk(const ChunkReader& reader,
                                                            const ChunkContent& content,
                                                            std::int64_t chunk,
                                                            double force_scale);

/// Bytes that a chunk takes in memory, at most.
[[nodiscard]] std::size_t chunk_bytes(const DatabaseIndex& index,
                                      const ChunkContent& content, std::int64_t chunk);

/// Bytes that a chunk adds to a piece of surface while that is built, at most.
[[nodiscard]] std::size_t piece_bytes(const DatabaseIndex& index, std::int64_t chunk);

}  // namespace palpate
