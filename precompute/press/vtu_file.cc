#include "precompute/press/vtu_file.h"

#include <iterator>
#include <string>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "precompute/fem/quadratic_element.h"

namespace palpate {
namespace {

constexpr int kQuadraticTet = 24;  // VTK_QUADRATIC_TETRA: our order of nodes

// One <DataArray>, a line per tuple.
template <typename Tuple>
void add_array(std::string& text, const char* type, const char* name, int components,
               Eigen::Index tuples, const Tuple& tuple) {
  fmt::format_to(std::back_inserter(text),
                 "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
                 "format=\"ascii\">\n",
                 type, name, components);
  for (Eigen::Index i = 0; i < tuples; ++i) {
    tuple(i, std::back_inserter(text));
    text += '\n';
  }
  text += "</DataArray>\n";
}

void add_points(std::string& text, const char* name, Eigen::Index nodes,
                const auto& vector) {
  add_array(text, "Float64", name, 3, nodes, [&](Eigen::Index i, auto out) {
    const Eigen::Vector3d v = vector(i);
    fmt::format_to(out, "{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z());
  });
}

void add_cells(std::string& text, const QuadraticMesh& mesh) {
  const Eigen::Index tets = mesh.tet.rows();
  text += "<Cells>\n";
  add_array(text, "Int64", "connectivity", 1, tets, [&](Eigen::Index t, auto out) {
    for (Eigen::Index j = 0; j < 10; ++j) {
      fmt::format_to(out, "{} ", mesh.tet(t, j));
    }
  });
  add_array(text, "Int64", "offsets", 1, tets, [](Eigen::Index t, auto out) {
    fmt::format_to(out, "{}", 10 * (t + 1));
  });
  add_array(text, "UInt8", "types", 1, tets, [](Eigen::Index, auto out) {
    fmt::format_to(out, "{}", kQuadraticTet);
  });
  text += "</Cells>\n";
}

void add_cell_data(std::string& text, const QuadraticMesh& mesh,
                   const Eigen::VectorXd& u_m, std::span<const char> near) {
  const Eigen::Index tets = mesh.tet.rows();
  text += "<CellData>\n";
  add_array(text, "Float64", "det_f", 1, tets, [&](Eigen::Index t, auto out) {
    fmt::format_to(out, "{:.9g}",
                   smallest_jacobian(element_geometry(tet_corners(mesh, t), t),
                                     nodal_values(mesh, t, u_m)));
  });
  add_array(text, "Int32", "region", 1, tets, [&](Eigen::Index t, auto out) {
    fmt::format_to(out, "{}", region_of(mesh, t));
  });
  add_array(text, "UInt8", "near", 1, tets, [&](Eigen::Index t, auto out) {
    fmt::format_to(out, "{}", int{near[static_cast<std::size_t>(t)]});
  });
  text += "</CellData>\n";
}

}  // namespace

void write_vtu(const std::filesystem::path& file, const QuadraticMesh& mesh,
               const Eigen::VectorXd& u_m, std::span<const char> near) {
  AtomicFile place(file);
  const Eigen::Index nodes = mesh.position_m.rows();
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
      nodes, mesh.tet.rows());
  const auto moved = [&](Eigen::Index i) -> Eigen::Vector3d {
    return u_m.segment<3>(3 * i);
  };
  add_points(text, "position_m", nodes, [&](Eigen::Index i) -> Eigen::Vector3d {
    return mesh.position_m.row(i).transpose() + moved(i);
  });
  text += "</Points>\n";
  add_cells(text, mesh);
  text += "<PointData Vectors=\"displacement\">\n";
  add_points(text, "displacement", nodes, moved);
  text += "</PointData>\n";
  add_cell_data(text, mesh, u_m, near);
  text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  place.write(std::as_bytes(std::span(text)));
  place.commit();
}

}  // namespace palpate
