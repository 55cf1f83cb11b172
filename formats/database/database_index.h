// What a renderer or a tool must know of a database before it reads any response. The
// index states which nodes lie together, where, and how large their responses get.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/database/select_nodes.h"

namespace palpate {

constexpr std::size_t kSha256Bytes = 32;

/// (c x 32) one SHA-256 per row.
using Sha256Rows =
    Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// One tool, chunk by chunk: chunk k holds the rows of nodes [node_begin[k],
/// node_begin[k + 1]) and their samples.
struct ToolIndex {
  ToolShape tool;
  std::vector<std::int64_t> sample_begin;        ///< (c + 1) first sample of a chunk
  std::vector<double> depth_max_m;               ///< (c) [m]
  std::vector<double> force_max_n;               ///< (c) [N] of any sample
  std::vector<double> stiffness_max_n_per_m;     ///< (c) [N/m] largest slope
  std::vector<double> error_relative_max;        ///< (c) [-] largest stated error
  std::vector<double> direction_spread_max_rad;  ///< (c) [rad]
  std::vector<std::int64_t> origin_count;        ///< (4) nodes by ResponseOrigin
  std::vector<std::int64_t> flag_count;          ///< (7 or 8) nodes by flag bit
  ResponseRelaxation relaxation;                 ///< as the table's
  /// As the table's; without rows of nodes and sites if there is more than one.
  Viscoelasticity viscoelasticity;
  std::int64_t memory_sites = 0;  ///< rows of its sites; 0: the nodes
  bool yielding_rows = false;     ///< nodes have rows of their own of how they yield
  RowsOf<double> share_min;       ///< (c x K + 1) [-] g_k and their sum; none if ...
  RowsOf<double> share_max;       ///< (c x K + 1) [-] ... there is one row of shares
  AccuracyRecord accuracy;        ///< as the table's
  Sha256Rows sha256;              ///< (c x 32) chunk_digest()
  Sha256Rows memory_sha256;    ///< (c x 32) memory_digest(); none without rows of nodes
  ComplianceTable compliance;  ///< as the table's, without rows of nodes
  Puncture puncture;           ///< as the table's, with its rows of nodes
  bool has_pressure = false;   ///< nodes have rows of contact_table.h's pressure
  bool has_lateral = false;    ///< and of its lateral stiffness
  Sha256Rows tilt_sha256;      ///< (c x 32) tilt_digest(); none without tilts
  Sha256Rows compliance_sha256;  ///< (c x 32) compliance_digest(); none without table
  Sha256Rows puncture_sha256;    ///< (1 x 32) puncture_digest(); none without puncture
  Sha256Rows contact_sha256;     ///< (c x 32) contact_digest(); none without contact
};

/// Chunks of neighbouring nodes. Nodes and triangles are counted as the file orders
/// them; triangle i belongs to the chunk of the first of its nodes.
struct DatabaseIndex {
  std::vector<std::int64_t> node_begin;      ///< (c + 1)
  std::vector<std::int64_t> triangle_begin;  ///< (c + 1)
  Points box_min_m;   ///< (c x 3) [m] of the chunk's nodes and triangles
  Points box_max_m;   ///< (c x 3) [m]
  Sha256Rows sha256;  ///< (c x 32) chunk_digest() of the body
  std::vector<ToolIndex> tools;
  std::int64_t measured_samples = 0;
  Provenance provenance;  ///< without the scene
  StorageOptions storage;
  std::uintmax_t bytes = 0;  ///< of the file

  [[nodiscard]] std::int64_t chunks() const noexcept {
    return static_cast<std::int64_t>(node_begin.size()) - 1;
  }
  [[nodiscard]] std::int64_t nodes() const noexcept { return node_begin.back(); }
  [[nodiscard]] std::int64_t triangles() const noexcept {
    return triangle_begin.back();
  }
  /// The chunk that holds a node of the file. @param node in [0, nodes())
  [[nodiscard]] std::int64_t chunk_of(std::int64_t node) const noexcept;
};

/// The nodes of a chunk and the triangles that belong to it.
struct BodyChunk {
  std::int64_t node_begin = 0;                ///< row of the first node in the file
  Points position_m;                          ///< (k x 3) [m]
  Points normal;                              ///< (k x 3) [-]
  Triangles triangle;                         ///< (j x 3) rows of nodes in the file
  std::vector<std::int32_t> source_node;      ///< (k) index in the source's order
  std::vector<std::int32_t> source_triangle;  ///< (j)
};

/// Of a tool whose responses relax, over all of its nodes.
[[nodiscard]] ShareExtent share_extent(const ToolIndex& tool);

/// Whether nodes have rows of their own there.
[[nodiscard]] bool has_node_rows(const Viscoelasticity& relaxation) noexcept;

/// The rows of nodes [begin, end) alone; a single row of shares stays.
[[nodiscard]] Viscoelasticity rows_of(const Viscoelasticity& relaxation,
                                      std::int64_t begin, std::int64_t end);

/// The largest values of some nodes' responses, 0 without any: what the index states of
/// a chunk.
struct TableMaxima {
  double depth_m = 0.0;
  double force_n = 0.0;
  double stiffness_n_per_m = 0.0;
  double error_relative = 0.0;
  double direction_spread_rad = 0.0;
};

/// Over the nodes [begin, end) of a table.
[[nodiscard]] TableMaxima maxima_of(const ResponseTable& table, std::int64_t begin,
                                    std::int64_t end);

/// Index of a database whose nodes and triangles are in the file's order.
/// @param order by which they were ordered.
[[nodiscard]] DatabaseIndex make_index(const ResponseDatabase& ordered,
                                       const StorageOrder& order);

/// 64 hexadecimal digits over the index itself.
[[nodiscard]] std::string index_digest(const DatabaseIndex& index);

}  // namespace palpate
