// The pressure law of a node or place, and of all nodes as arrays.
#include "python/binding/array_view.h"
#include "python/binding/bind.h"
#include "python/binding/held_database.h"
#include "python/binding/number_array.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_search.h"
#include "formats/response/pressure_law.h"

namespace py = pybind11;

namespace palpate {
namespace {

// The law looks into the database.
struct HeldLaw {
  std::shared_ptr<HeldDatabase> held;
  PressureLaw law;
};

Eigen::Vector3d normal_of(const ResponseDatabase& database, std::int64_t node) {
  return database.normal.row(node).transpose();
}

HeldLaw place_law(const HeldTool& tool, const py::object& position) {
  check_gives_pressure(tool.table->tool);
  const ResponseDatabase& database = tool.held->database;
  Eigen::Vector3d at;
  take_row(position, "place", 3, at.data());
  if (!at.allFinite()) {
    throw InputError("place must be the index of a node, or three finite coordinates");
  }
  const SurfacePoint point = SurfaceSearch(database.body).nearest(at);
  std::array<std::int64_t, 3> node{};
  Eigen::Matrix3d normals;
  for (Eigen::Index j = 0; j < 3; ++j) {
    node[static_cast<std::size_t>(j)] = database.body.triangle(point.triangle, j);
    normals.col(j) = normal_of(database, database.body.triangle(point.triangle, j));
  }
  return {tool.held, pressure_law(*tool.table, node, point.area_coordinate, normals)};
}

HeldLaw pressure_law_at(const HeldTool& tool, const py::object& place) {
  if (!PyIndex_Check(place.ptr()) || py::hasattr(place, "__len__")) {
    return place_law(tool, place);
  }
  const auto node = py::cast<std::int64_t>(py::int_(place));
  check_gives_pressure(tool.table->tool);
  const bool there = node >= 0 && node < tool.table->nodes();
  return {tool.held, pressure_law(*tool.table, node,
                                  there ? normal_of(tool.held->database, node)
                                        : Eigen::Vector3d::UnitZ())};
}

// Elementwise, in the shape of the depths.
template <typename Value>
py::array_t<double> at_depths(const py::object& depths, const Value& value) {
  const Doubles depth_m = doubles(depths, "depths");
  py::array_t<double> result(
      std::vector<py::ssize_t>(depth_m.shape(), depth_m.shape() + depth_m.ndim()));
  for (py::ssize_t i = 0; i < depth_m.size(); ++i) {
    result.mutable_data()[i] = value(depth_m.data()[i]);
  }
  return result;
}

py::array_t<double> even_depths(py::ssize_t count, double depth_max_m) {
  if (count < 2) {
    throw InputError(fmt::format("a table has {} depths, must have 2 at least", count));
  }
  py::array_t<double> depth_m(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    depth_m.mutable_data()[i] =
        depth_max_m * static_cast<double>(i) / static_cast<double>(count - 1);
  }
  return depth_m;
}

py::array_t<double> pressures_at(const HeldLaw& held, const py::object& depths) {
  return at_depths(depths, [&](double depth_m) {
    return held.law.pressure_pa(depth_m);
  });
}

py::array_t<double> forces(const HeldLaw& held, const py::object& depths,
                           const std::optional<double>& radius_m) {
  const double radius = radius_m.value_or(held.law.radius_m());
  if (!(radius > 0.0 && std::isfinite(radius))) {
    throw InputError(
        fmt::format("radius_m is {}, must be positive and finite", radius));
  }
  return at_depths(depths, [&](double depth_m) {
    return held.law.force_n(depth_m, radius);
  });
}

py::tuple law_table(const HeldLaw& held, py::ssize_t count) {
  const py::array_t<double> depth_m = even_depths(count, held.law.depth_max_m());
  return py::make_tuple(depth_m, pressures_at(held, depth_m));
}

py::dict linear_fit(const HeldLaw& held, double thickness_m,
                    const std::optional<double>& depth_max_m) {
  if (!(thickness_m > 0.0 && std::isfinite(thickness_m))) {
    throw InputError(
        fmt::format("thickness_m is {}, must be positive and finite", thickness_m));
  }
  const LinearPressure fit =
      linear_pressure(held.law, depth_max_m.value_or(held.law.depth_max_m()));
  py::dict parts;
  parts["modulus_pa"] = fit.slope_pa_per_m * thickness_m;
  parts["slope_pa_per_m"] = fit.slope_pa_per_m;
  parts["misfit_relative"] = fit.misfit_relative;
  parts["force_error_relative"] = fit.force_error_relative;
  return parts;
}

py::dict all_laws(const HeldTool& tool, py::ssize_t count) {
  const ResponseTable& table = *tool.table;
  check_gives_pressure(table.tool);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::optional<PressureLaw>> law(static_cast<std::size_t>(table.nodes()));
  double deepest_m = 0.0;
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    if (!table.curve(node).depth_m.empty()) {
      auto& own = law[static_cast<std::size_t>(node)];
      own = pressure_law(table, node, normal_of(tool.held->database, node));
      deepest_m = std::max(deepest_m, own->depth_max_m());
    }
  }
  const py::array_t<double> depth_m = even_depths(count, deepest_m);
  const py::ssize_t nodes = table.nodes();
  py::array_t<double> pressure_pa({nodes, count});
  py::array_t<double> depth_max_m(nodes), slope(nodes), misfit(nodes);
  for (py::ssize_t i = 0; i < nodes; ++i) {
    const auto& own = law[static_cast<std::size_t>(i)];
    const LinearPressure fit =
        own ? linear_pressure(*own, own->depth_max_m()) : LinearPressure{kNone, kNone};
    depth_max_m.mutable_data()[i] = own ? own->depth_max_m() : kNone;
    slope.mutable_data()[i] = fit.slope_pa_per_m;
    misfit.mutable_data()[i] = fit.misfit_relative;
    for (py::ssize_t k = 0; k < count; ++k) {
      *pressure_pa.mutable_data(i, k) =
          own ? own->pressure_pa(depth_m.data()[k]) : kNone;
    }
  }
  py::dict parts;
  parts["radius_m"] = table.tool.radius_m;
  parts["depth_m"] = depth_m;
  parts["pressure_pa"] = pressure_pa;
  parts["depth_max_m"] = depth_max_m;
  parts["slope_pa_per_m"] = slope;
  parts["misfit_relative"] = misfit;
  return parts;
}

}  // namespace

void bind_pressure(py::module_& module, py::class_<HeldTool>& tool) {
  py::class_<HeldLaw> type(
      module, "PressureLaw",
      "Pressure [Pa] by depth [m] past the first touch, of an elastic foundation that "
      "gives the\nstored force to a ball of radius_m. law(depths): an array of the "
      "same shape.\n\nExact for that ball alone. On a half space the foundation is "
      "41 % too stiff for a ball of twice\nthe radius, 29 % too soft for one of half "
      "of it.");
  type.def("__call__", &pressures_at, py::arg("depths"));
  type.def("force", &forces, py::arg("depths"), py::arg("radius_m") = py::none(),
           "Normal force [N] on a ball of radius_m [m] at depths [m]; without: of the "
           "law's own ball.");
  type.def("table", &law_table, py::arg("n"),
           "(n,) even depths [m] from 0 to depth_max_m, and (n,) pressures [Pa].");
  type.def("hydroelastic_modulus", &linear_fit, py::arg("thickness_m"),
           py::arg("depth_max_m") = py::none(),
           "The best p = modulus_pa d / thickness_m up to a depth, a dict: "
           "slope_pa_per_m is "
           "Newton's kh,\nmisfit_relative the rms of p that is missed, "
           "force_error_relative what the ball's force is off\nat that depth.");
  type.def_property_readonly("radius_m", [](const HeldLaw& held) {
    return held.law.radius_m();
  });
  type.def_property_readonly(
      "depth_max_m",
      [](const HeldLaw& held) {
        return held.law.depth_max_m();
      },
      "[m] up to which it was computed; beyond it the pressure stays level");
  tool.def("pressure_law", &pressure_law_at, py::arg("place"),
           "PressureLaw of a node (index), or of the place of the surface that is "
           "nearest to (3,) [m].\nInputError: the tool is no sphere, or there is no "
           "response.");
  tool.def(
      "pressure_laws", &all_laws, py::arg("n"),
      "Of all nodes at n even depths: depth_m (n,), pressure_pa (nodes, n), and per "
      "node depth_max_m,\nslope_pa_per_m and misfit_relative; NaN without response.");
}

}  // namespace palpate
