// What an element message says of a node, and which elements an update sends.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>

#include "formats/mesh/surface_search.h"
#include "formats/response/response_table.h"
#include "formats/response/tilt_line.h"
#include "runtime/element/element.h"

namespace palpate {

/// Elements sent with the active one, at most. All elements of an update and the
/// element in use fit the fast process's cache (kCacheSlots), so an update does not
/// push itself out.
constexpr std::size_t kNeighboursMax = 28;

/// Curves that had to be thinned to fit a message, and what that cost.
struct ResampleLoss {
  std::int64_t nodes = 0;       ///< nodes with more than kElementSamples samples
  double force_n = 0.0;         ///< [N] largest difference of force
  double force_relative = 0.0;  ///< [-] largest, relative to the curve's largest force

  /// With that of other curves.
  void add(const ResampleLoss& other) noexcept {
    nodes += other.nodes;
    force_n = std::max(force_n, other.force_n);
    force_relative = std::max(force_relative, other.force_relative);
  }
};

/// Positions, normals and responses of the same nodes, row by row.
struct NodeRows {
  const Points& position_m;    ///< (n x 3) [m]
  const Points& normal;        ///< (n x 3) [-]
  const ResponseTable& table;  ///< of n nodes
  double force_scale = 1.0;    ///< [-] forces are multiplied by it
  /// (n) of a table that has directions by sample and no tilts; else empty.
  std::span<const TiltLine> tilt = {};
};

/// A row of positions or directions, as messages hold it.
[[nodiscard]] std::array<double, 3> row_array(const Points& points, Eigen::Index row);

/// The message of a row, whose node the caller names. Without response: no samples, no
/// direction, no touch offset, zero force. Its touch offset is that of a tool whose
/// reference point stands at nominal_height_m(tool) over a flat surface. So a tool of
/// any shape and fixed orientation is followed as a sphere of that radius. Its tilt is
/// the stored line; without one that of its direction. @param loss_n where not null,
/// what thinning cost [N]. @throws InputError for an endless tool that cannot touch the
/// node.
[[nodiscard]] ElementNode node_message(const NodeRows& rows, std::int64_t row,
                                       double* loss_n = nullptr);

/// Messages by row of the nodes whose curves are too long for one message. These
/// messages are made once, because thinning is too costly at every send. Adds to
/// `loss`.
[[nodiscard]] std::unordered_map<std::int32_t, ElementNode> thinned_messages(
    const NodeRows& rows, ResampleLoss& loss);

/// Triangles of one update, the active one first.
struct WantedTriangles {
  std::array<std::int32_t, 1 + kNeighboursMax> triangle{};
  std::size_t count = 0;
};

/// The active triangle, those around it, and, where that is another part of the
/// surface, those across the edges of the one in use. @param in_use -1: none.
[[nodiscard]] WantedTriangles wanted_triangles(const SurfaceSearch& search,
                                               std::int32_t active,
                                               std::int32_t in_use) noexcept;

}  // namespace palpate
