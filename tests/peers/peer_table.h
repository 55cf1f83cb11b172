// The rows as people and programs read them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/peers/peer_row.h"

namespace palpate::peers {

/// Markdown, a table for each scene, which is readable as it is.
[[nodiscard]] std::string table_markdown(std::span<const PeerRow> rows);

/// The nodule question, a row for each renderer and scene with a raster. Markdown.
[[nodiscard]] std::string nodule_markdown(std::span<const PeerRow> rows);

/// Everything, a line per row, SI units.
[[nodiscard]] std::string table_csv(std::span<const PeerRow> rows);

/// Force error in contact over the median time of a step, a series for each renderer.
[[nodiscard]] std::string table_picture(std::span<const PeerRow> rows);

/// The sideways force along the slowest slide by frequency, the true one first. Empty
/// where the scene's truth is not dense.
[[nodiscard]] std::string spectrum_picture(std::span<const PeerRow> rows,
                                           const std::string& scene);

/// The rows' scenes in their order.
[[nodiscard]] std::vector<std::string> scenes_of(std::span<const PeerRow> rows);

}  // namespace palpate::peers
