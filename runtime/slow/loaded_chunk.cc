#include "runtime/slow/loaded_chunk.h"

#include <algorithm>

#include "formats/database/database_rules.h"
#include "formats/response/press_inversion.h"
#include "formats/response/yielding.h"

namespace palpate {
namespace {

std::vector<std::int64_t> chunks_of_nodes(const DatabaseIndex& index,
                                          const BodyChunk& body, std::int64_t chunk) {
  std::vector<std::int64_t> needs;
  const std::int64_t end = body.node_begin + body.position_m.rows();
  for (Eigen::Index i = 0; i < body.triangle.size(); ++i) {
    const std::int64_t node = body.triangle.data()[i];
    if (node < body.node_begin || node >= end) {
      needs.push_back(index.chunk_of(node));
    }
  }
  std::sort(needs.begin(), needs.end());
  needs.erase(std::unique(needs.begin(), needs.end()), needs.end());
  std::erase(needs, chunk);
  return needs;
}

}  // namespace

std::shared_ptr<const LoadedChunk> load_chunk(const ChunkReader& reader,
                                              const ChunkContent& content,
                                              std::int64_t chunk, double force_scale) {
  auto loaded = std::make_shared<LoadedChunk>();
  loaded->body = reader.body(chunk);
  loaded->table = reader.responses(content.tool, chunk);
  check_normals(loaded->body.normal, loaded->table, loaded->body.node_begin);
  make_instantaneous(loaded->table);
  make_undamaged(loaded->table);
  loaded->table.compliance = content.coupling
                                 ? reader.compliance(*content.coupling, chunk)
                                 : ComplianceTable{};
  loaded->thinned = thinned_messages(loaded->rows(force_scale), loaded->loss);
  loaded->needs = chunks_of_nodes(reader.index(), loaded->body, chunk);
  return loaded;
}

std::size_t chunk_bytes(const DatabaseIndex& index, const ChunkContent& content,
                        std::int64_t chunk) {
  // What FORMAT.md lists per node, triangle and sample, and what holds it together.
  constexpr std::size_t kPerNode = 3 * 8 + 3 * 8 + 4 + 3 * 8 + 6 * 8 + 2 + 8;
  constexpr std::size_t kPerTriangle = 3 * 4 + 4;
  constexpr std::size_t kPerSample = 4 * 8;
  constexpr std::size_t kPerThinned = sizeof(ElementNode) + 32;
  constexpr std::size_t kFixed = sizeof(LoadedChunk) + 1024;
  const auto k = static_cast<std::size_t>(chunk);
  const auto count = [k](const std::vector<std::int64_t>& begin) {
    return static_cast<std::size_t>(begin[k + 1] - begin[k]);
  };
  const std::size_t nodes = count(index.node_begin);
  const ToolIndex& entry = index.tools[content.tool];
  const std::size_t per_memory =
      entry.memory_sha256.rows() > 0
          ? sizeof(float) * static_cast<std::size_t>(entry.viscoelasticity.terms()) +
                kNodeSites * (sizeof(std::int32_t) + sizeof(float))
          : 0;
  // Five rows of a node at most, and curves that soften have as many samples as fit.
  const Yielding& yielding = entry.viscoelasticity.yielding;
  const std::size_t per_yielding =
      entry.yielding_rows || !yielding.empty()
          ? 5 * sizeof(double) + kPerSample * kElementSamples
          : 0;
  const std::size_t per_coupling =
      content.coupling ? sizeof(float) * (kMostKnots + kMostModes) : 0;
  const std::size_t samples = count(entry.sample_begin);
  const std::size_t thinned = std::min(nodes, samples / (kElementSamples + 1));
  return kFixed + (kPerNode + per_memory + per_yielding + per_coupling) * nodes +
         kPerTriangle * count(index.triangle_begin) + kPerSample * samples +
         kPerThinned * thinned;
}

std::size_t piece_bytes(const DatabaseIndex& index, std::int64_t chunk) {
  // Rows of SurfacePiece and SurfaceSearch; per triangle also the three sides in the
  // list that finds neighbours, and boxes in a vector that doubles.
  constexpr std::size_t kPerNode = 3 * 8 + 1 + 2 * 4;
  constexpr std::size_t kPerTriangle =
      2 * (3 * 4 + 4) + 3 * 4 + 4 + 3 * 8 + 3 * 4 + 240;
  constexpr std::size_t kFixed = 256;
  const auto k = static_cast<std::size_t>(chunk);
  return kFixed +
         kPerNode *
             static_cast<std::size_t>(index.node_begin[k + 1] - index.node_begin[k]) +
         kPerTriangle * static_cast<std::size_t>(index.triangle_begin[k + 1] -
                                                 index.triangle_begin[k]);
}

}  // namespace palpate
