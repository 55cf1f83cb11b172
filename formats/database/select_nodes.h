// Some nodes of a table or a database, in any order: the order of a file, a chunk of
// neighbours, a region that somebody wants.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

/// The table of these nodes: row i of the result is node nodes[i]. Displacement fields
/// keep the vertices and the pressed nodes among them.
/// @param nodes each in [0, n), none twice. @param table passes check().
[[nodiscard]] ResponseTable select_nodes(const ResponseTable& table,
                                         std::span<const std::int32_t> nodes);

/// The database of these nodes and triangles, in the order given. Every corner of the
/// triangles must be among the nodes. Runs of the measurement at other nodes stay, at
/// an unknown node.
[[nodiscard]] ResponseDatabase select_nodes(const ResponseDatabase& database,
                                            std::span<const std::int32_t> nodes,
                                            std::span<const std::int32_t> triangles);

/// place[order[i]] = i; -1 for what is not in the order. @param size of the result.
[[nodiscard]] std::vector<std::int32_t> places_of(std::span<const std::int32_t> order,
                                                  std::size_t size);

/// How a file orders a body: rows of the file, by their index in the source.
struct StorageOrder {
  std::vector<std::int32_t> node;      ///< (n) along Hilbert's curve
  std::vector<std::int32_t> triangle;  ///< (t) by the first of its nodes in that order
};

[[nodiscard]] StorageOrder storage_order(const SurfaceMesh& body);

/// Slopes and energies of all curves from depths and forces (ResponseCurve).
/// @throws FormatError naming the node whose samples make no curve.
void remake_curves(ResponseTable& table);

}  // namespace palpate
