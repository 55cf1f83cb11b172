// How a tool's responses relax, read as a renderer needs it. What is the same for all
// nodes is read at once, rows of nodes with their chunk.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/database_index.h"

namespace palpate {

class StoredReader;

/// Into tool.viscoelasticity and tool.memory_sites: nothing where the tool is static.
/// @param group of the tool. @param nodes of the body.
/// @throws FormatError naming the dataset and what it must be.
void read_viscoelasticity_head(StoredReader& file, const std::string& group,
                               std::int64_t nodes, ToolIndex& tool);

/// Shares and sites of the nodes [begin, begin + count) beside what the head has.
void read_node_rows(const StoredReader& file, const std::string& group,
                    const ToolIndex& tool, std::int64_t begin, std::int64_t count,
                    Viscoelasticity& relaxation);

/// The shares of a chunk are as the index states. @throws FormatError
void check_shares(const ToolIndex& tool, std::int64_t chunk,
                  const Viscoelasticity& part);

}  // namespace palpate
