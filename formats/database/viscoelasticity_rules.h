// The rules of FORMAT.md for how responses relax: of a whole table, or of a chunk.
#pragma once

#include <cstdint>
#include <string>

#include "formats/response/viscoelasticity.h"

namespace palpate {

// Every function @throws FormatError naming the dataset, the row, its value and what it
// must be. @param tool the group: "/tools/ball".

/// Times, kind of curve, speed and bundles.
void check_terms(const std::string& tool, const Viscoelasticity& relaxation);

/// Shares and sites of nodes. @param nodes that have rows.
/// @param sites that the whole table has. @param first of the nodes, as the file
/// counts.
void check_node_rows(const std::string& tool, const Viscoelasticity& relaxation,
                     std::int64_t nodes, std::int64_t sites, std::int64_t first = 0);

/// Rows of how responses yield. @param nodes that have rows, if there is more than one.
void check_yielding(const std::string& tool, const Yielding& yielding,
                    std::int64_t nodes, std::int64_t first = 0);

/// All of a table's. @param nodes of the body.
void check(const std::string& tool, const Viscoelasticity& relaxation,
           std::int64_t nodes);

}  // namespace palpate
