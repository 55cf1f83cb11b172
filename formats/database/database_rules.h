// The rules of FORMAT.md for parts of a database: all of it at once, or chunk by chunk
// as a renderer streams it. One writing for both: what is rendered was held to them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/database/database_index.h"
#include "formats/database/response_database.h"

namespace palpate {

// Every function @throws FormatError naming the dataset, the row, its value and what it
// must be. Rows are named as the file counts them: first + row.

/// Positions are finite, there is a normal for each, of length 1 or zero.
void check_nodes(const Points& position_m, const Points& normal,
                 std::int64_t first = 0);

/// Three different nodes in [0, nodes) for each triangle.
void check_triangles(const Triangles& triangle, std::int64_t nodes,
                     std::int64_t first = 0);

/// All of a tool's arrays: their sizes, the shape of the tool, each node's values, its
/// direction and its curve.
/// @param group of the tool, for messages: "/tools/ball"
void check_responses(const std::string& group, const ResponseTable& table,
                     std::int64_t first = 0);

/// A node with a response has a normal, and a tilt lies in the plane across it and
/// keeps its limits (tilt_rules.h).
void check_normals(const Points& normal, const ResponseTable& table,
                   std::int64_t first = 0, std::span<const double> longest_edge_m = {});

/// A chunk of the body against what the index says of the chunk. The chunk's nodes lie
/// in its box, and its triangles begin with one of its nodes.
void check_chunk(const DatabaseIndex& index, std::int64_t chunk, const BodyChunk& body);

/// A chunk of responses against the index: its largest depth, force, slope, error and
/// spread are those that the index states.
void check_chunk(const ToolIndex& index, std::int64_t chunk,
                 const ResponseTable& table);

/// Which of the source's nodes and triangles chunks have named: each once, by one
/// chunk. A bit for each.
class SourceNames {
 public:
  explicit SourceNames(const DatabaseIndex& index);

  /// A chunk that was read, for the first time or again.
  void add(std::int64_t chunk, const BodyChunk& body);

 private:
  std::vector<bool> chunk_;
  std::vector<bool> node_;
  std::vector<bool> triangle_;
};

/// write_database() without the rules: a file whose digests are right and whose content
/// is not, for tests of who must refuse it. Sizes must agree.
void write_unchecked(const std::filesystem::path& file,
                     const ResponseDatabase& database,
                     std::optional<StoredForm> form = std::nullopt);

}  // namespace palpate
