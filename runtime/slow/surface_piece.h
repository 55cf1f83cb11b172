// The part of a body that is in memory, as one surface that can be searched.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "formats/mesh/surface_search.h"
#include "runtime/slow/loaded_chunk.h"
#include "runtime/slow/table_elements.h"

namespace palpate {

using LoadedChunks = std::map<std::int64_t, std::shared_ptr<const LoadedChunk>>;

/// Immutable. A chunk is complete in a piece if all nodes of its triangles are there.
/// Its triangles are then the piece's, in the source's order, so a search meets them as
/// it does in the whole body. Queries are const and do not allocate.
class SurfacePiece {
 public:
  /// @param index must outlive the piece. @param chunks any of it.
  SurfacePiece(const DatabaseIndex& index, LoadedChunks chunks, double force_scale);

  SurfacePiece(const SurfacePiece&) = delete;
  SurfacePiece& operator=(const SurfacePiece&) = delete;

  [[nodiscard]] const SurfaceSearch& search() const noexcept { return *search_; }
  [[nodiscard]] std::int64_t triangles() const noexcept {
    return mesh_.triangle.rows();
  }

  /// Row of a triangle that the source calls `source`; -1: not in this piece.
  [[nodiscard]] std::int32_t row_of(std::int32_t source) const noexcept;

  /// Whether every triangle of the body that shares a vertex with that of the row is
  /// in the piece. @param row in [0, triangles())
  [[nodiscard]] bool is_surrounded(std::int32_t row) const noexcept;

  /// [m] No triangle that is missing is nearer than this; infinite if none is missing.
  [[nodiscard]] double missing_distance_m(const Eigen::Vector3d& p_m) const noexcept;

  /// The message for one triangle, without sequence and time, named as in the source.
  [[nodiscard]] Element element(std::int32_t row) const;
  /// Rows of compliance of its nodes; zero where the chunks have none.
  [[nodiscard]] ElementRows compliance(std::int32_t row) const;

  /// The source's name of a triangle. @param row in [0, triangles())
  [[nodiscard]] std::int32_t source_of(std::int32_t row) const noexcept {
    return source_triangle_[static_cast<std::size_t>(row)];
  }

  [[nodiscard]] bool has_complete(std::int64_t chunk) const noexcept {
    return complete_[static_cast<std::size_t>(chunk)] != 0;
  }

 private:
  // A row of a loaded chunk.
  struct Place {
    const LoadedChunk* chunk = nullptr;
    std::int32_t row = 0;
  };

  void place_nodes();
  void add_triangles();
  void find_surrounded();
  [[nodiscard]] Place place(std::int32_t node) const noexcept;
  [[nodiscard]] std::int32_t local(std::int64_t file_node) const noexcept;

  const DatabaseIndex& index_;
  LoadedChunks chunks_;
  double force_scale_;
  std::vector<std::uint8_t> complete_;         // (c)
  std::vector<const LoadedChunk*> part_;       // in the file's order
  std::vector<std::int32_t> part_begin_;       // (parts + 1) first local node
  SurfaceMesh mesh_;                           // local nodes
  std::vector<std::int32_t> source_triangle_;  // (t) ascending
  std::vector<std::uint8_t> surrounded_;       // (local nodes)
  std::optional<SurfaceSearch> search_;        // of mesh_
};

/// Whether all the chunks that it needs are there.
[[nodiscard]] bool is_complete(const LoadedChunks& chunks, const LoadedChunk& chunk);

}  // namespace palpate
