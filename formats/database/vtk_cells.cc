#include "formats/database/vtk_cells.h"

namespace palpate {

VtkCells vtk_cells(const SurfaceMesh& surface) {
  constexpr std::uint8_t kVtkTriangle = 5;
  const Eigen::Index t = surface.triangle.rows();
  VtkCells cells;
  cells.points = {surface.position_m.rows()};
  cells.cells = {t};
  cells.corners = {3 * t};
  cells.connectivity.assign(surface.triangle.data(), surface.triangle.data() + 3 * t);
  for (Eigen::Index i = 0; i <= t; ++i) {
    cells.offset.push_back(3 * i);
  }
  cells.type.assign(static_cast<std::size_t>(t), kVtkTriangle);
  return cells;
}

std::vector<double> node_depth_max_m(const ResponseTable& table) {
  std::vector<double> depth_m;
  depth_m.reserve(static_cast<std::size_t>(table.nodes()));
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    depth_m.push_back(table.curve(i).depth_max_m());
  }
  return depth_m;
}

}  // namespace palpate
