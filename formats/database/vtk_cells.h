// A surface as VTK's unstructured grids store it.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "formats/response/response_table.h"

namespace palpate {

struct VtkCells {
  std::vector<std::int64_t> points;        ///< (1) number of nodes
  std::vector<std::int64_t> cells;         ///< (1) number of triangles
  std::vector<std::int64_t> corners;       ///< (1) length of connectivity
  std::vector<std::int64_t> connectivity;  ///< (3 t) node indices
  std::vector<std::int64_t> offset;        ///< (t + 1) cell i: offset[i], offset[i + 1]
  std::vector<std::uint8_t> type;          ///< (t) 5, VTK's triangle
};

[[nodiscard]] VtkCells vtk_cells(const SurfaceMesh& surface);

/// (n) [m] the last depth of each node's curve, 0 without one.
[[nodiscard]] std::vector<double> node_depth_max_m(const ResponseTable& table);

}  // namespace palpate
