// A part of a database, and several of one body in one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "formats/database/response_database.h"

namespace palpate {

struct SliceOptions {
  std::optional<Eigen::AlignedBox3d> box_m = {};  ///< [m] keeps triangles inside
  std::vector<std::string> tools = {};            ///< keeps these; empty: all
  std::optional<double> depth_max_m = {};         ///< [m] (0, inf) cuts curves here
};

/// What the options keep. Nodes are numbered anew, in their old order; what was cut is
/// said in provenance.left_out. @throws InputError if nothing would be left, or a tool
/// is not there.
[[nodiscard]] ResponseDatabase slice(const ResponseDatabase& database,
                                     const SliceOptions& options);

/// The table with every curve cut at a depth: the curve before it is the same cubic,
/// with its own energy. A curve that ends before it is not touched.
/// @param depth_m [m] positive
[[nodiscard]] ResponseTable cut(const ResponseTable& table, double depth_m);

/// One database with the tools of all, in turn; provenance of the first.
/// @throws InputError saying why two do not belong together: other bodies, other
/// sources, or a tool of the same name in both.
[[nodiscard]] ResponseDatabase merge(const std::vector<ResponseDatabase>& databases);

}  // namespace palpate
