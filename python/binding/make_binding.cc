#include "python/binding/bind.h"
#include "python/binding/held_database.h"
#include "python/binding/number_array.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "formats/base/error.h"
#include "formats/response/response_table.h"

namespace py = pybind11;

namespace palpate {
namespace {

using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

py::array numbers(const py::object& values, const char* kinds,
                  const std::string& what) {
  const py::array array = py::array::ensure(values);
  if (!array || std::string(kinds).find(array.dtype().kind()) == std::string::npos) {
    PyErr_Clear();
    throw InputError(fmt::format("{} are not {}", what,
                                 kinds == std::string("iu") ? "integers" : "numbers"));
  }
  return array;
}

Points points(const py::object& values, const std::string& what) {
  const Doubles array(numbers(values, "fiu", what));
  if (array.ndim() != 2 || array.shape(1) != 3) {
    throw InputError(fmt::format("{} must have shape (n, 3)", what));
  }
  return Eigen::Map<const Points>(array.data(), array.shape(0), 3);
}

Triangles triangles(const py::object& values, Eigen::Index nodes) {
  const Integers array(numbers(values, "iu", "triangles"));
  if (array.ndim() != 2 || array.shape(1) != 3) {
    throw InputError("triangles must have shape (t, 3)");
  }
  Triangles triangle(array.shape(0), 3);
  for (py::ssize_t i = 0; i < array.size(); ++i) {
    const std::int64_t node = array.data()[i];
    if (node < 0 || node >= nodes) {
      throw InputError(fmt::format("triangle {} has node {}, must lie in [0, {}]",
                                   i / 3, node, nodes - 1));
    }
    triangle.data()[i] = static_cast<std::int32_t>(node);
  }
  return triangle;
}

std::vector<double> row(const py::handle& values, std::size_t node) {
  const Doubles array(numbers(py::reinterpret_borrow<py::object>(values), "fiu",
                              fmt::format("samples of node {}", node)));
  if (array.ndim() != 1) {
    throw InputError(fmt::format("samples of node {} must have one dimension", node));
  }
  return {array.data(), array.data() + array.size()};
}

std::vector<NodeResponse> responses(const py::sequence& curves, const Points& normal) {
  if (static_cast<Eigen::Index>(curves.size()) != normal.rows()) {
    throw InputError(
        fmt::format("{} curves for {} vertices, must be one for each, or None",
                    curves.size(), normal.rows()));
  }
  std::vector<NodeResponse> response(curves.size());
  for (std::size_t i = 0; i < response.size(); ++i) {
    const py::object curve = curves[i];
    if (curve.is_none()) {
      continue;
    }
    if (!py::isinstance<py::sequence>(curve) || py::len(curve) != 2) {
      throw InputError(fmt::format("curve {} must be (depth, force) or None", i));
    }
    const auto pair = py::reinterpret_borrow<py::sequence>(curve);
    response[i].direction = normal.row(static_cast<Eigen::Index>(i));
    response[i].depth_m = row(py::object(pair[0]), i);
    response[i].force_n = row(py::object(pair[1]), i);
    if (response[i].depth_m.size() != response[i].force_n.size()) {
      throw InputError(
          fmt::format("curve {} has {} depths and {} forces, must be as many", i,
                      response[i].depth_m.size(), response[i].force_n.size()));
    }
    response[i].origin = ResponseOrigin::kMeasured;
  }
  return response;
}

std::shared_ptr<HeldDatabase> from_curves(const py::object& vertices,
                                          const py::object& faces,
                                          const py::sequence& curves, double radius_m,
                                          const std::string& tool) {
  ResponseDatabase database;
  database.body.position_m = points(vertices, "vertices");
  if (!database.body.position_m.allFinite()) {
    throw InputError("vertices must be finite");
  }
  database.body.triangle = triangles(faces, database.body.position_m.rows());
  database.normal = vertex_normals(database.body);
  ToolShape shape;
  shape.name = tool;
  shape.radius_m = radius_m;
  check(shape);
  database.tools.push_back(make_table(shape, responses(curves, database.normal)));
  database.provenance.writer = "palpate (Python) " PALPATE_VERSION;
  check(database);
  return std::make_shared<HeldDatabase>(HeldDatabase{std::move(database)});
}

}  // namespace

void bind_make(py::module_& module) {
  module.def(
      "from_curves", &from_curves, py::arg("vertices"), py::arg("triangles"),
      py::arg("curves"), py::kw_only(), py::arg("radius_m"), py::arg("tool") = "tool",
      "A database of one's own curves under a sphere of radius_m [m].\n\nvertices "
      "(n, 3) [m], triangles (t, 3) counter-clockwise from outside; curves: for "
      "each\nvertex (depth [m], force [N]), both from 0, along the outward normal, "
      "or None.\nInputError or FormatError: the first value that is wrong.");
}

}  // namespace palpate
