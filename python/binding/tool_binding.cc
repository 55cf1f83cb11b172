#include "python/binding/array_view.h"
#include "python/binding/bind.h"
#include "python/binding/held_database.h"
#include "python/binding/number_array.h"

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "formats/base/error.h"
#include "formats/response/curve_view.h"

namespace py = pybind11;

namespace palpate {
namespace {

py::object forces_at(const HeldTool& tool, const py::object& values, unsigned threads,
                     const py::object& out) {
  Doubles array = doubles(values, "positions");
  const bool one = array.ndim() == 1 && array.shape(0) == 3;
  if (!one && (array.ndim() != 2 || array.shape(1) != 3)) {
    throw InputError(
        fmt::format("positions have {} dimensions and {} numbers, must have "
                    "shape (n, 3) or (3,)",
                    array.ndim(), array.size()));
  }
  const Buffer result = buffer_like(out, array);
  const py::ssize_t rows = one ? 1 : array.shape(0);
  const auto field = field_of(tool);
  {
    const py::gil_scoped_release released;
    field->force_n(Eigen::Map<const Points>(array.data(), rows, 3),
                   Eigen::Map<Points>(result.data, rows, 3), threads);
  }
  return result.given;
}

py::array stiffness(const HeldTool& tool, double depth_m) {
  if (!(depth_m >= 0.0 && std::isfinite(depth_m))) {
    throw InputError(
        fmt::format("depth is {}, must be finite and at least 0 m", depth_m));
  }
  py::array_t<double> result(tool.table->nodes());
  auto value = result.mutable_unchecked<1>();
  for (py::ssize_t i = 0; i < value.shape(0); ++i) {
    const CurveView curve = tool.table->curve(i);
    value(i) = curve.depth_m.empty() ? std::numeric_limits<double>::quiet_NaN()
                                     : curve.at(depth_m).stiffness_n_per_m;
  }
  return result;
}

py::dict curve(const HeldTool& tool, py::ssize_t node) {
  const ResponseTable& table = *tool.table;
  if (node < 0 || node >= table.nodes()) {
    throw InputError(
        fmt::format("node is {}, must lie in [0, {}]", node, table.nodes() - 1));
  }
  const py::object owner = py::cast(tool.held);
  const CurveView view = table.curve(node);
  const auto part = [&](std::span<const double> row) {
    return looking_at(row.data(), {static_cast<py::ssize_t>(row.size())}, owner);
  };
  py::dict parts;
  parts["depth_m"] = part(view.depth_m);
  parts["force_n"] = part(view.force_n);
  parts["stiffness_n_per_m"] = part(view.stiffness_n_per_m);
  parts["energy_j"] = part(view.energy_j);
  return parts;
}

template <typename Member>
void array(py::class_<HeldTool>& type, const char* name, Member member,
           const char* text) {
  type.def_property_readonly(
      name,
      [member](const HeldTool& tool) {
        const py::object owner = py::cast(tool.held);
        const auto& rows = tool.table->*member;
        if constexpr (requires { rows.rows(); }) {
          return rows_of(rows, owner);
        } else {
          return looking_at(rows, owner);
        }
      },
      text);
}

void add_node_arrays(py::class_<HeldTool>& type) {
  using T = ResponseTable;
  array(type, "direction", &T::direction, "(n, 3) [-] unit, force on the tool");
  array(type, "direction_spread_rad", &T::direction_spread_rad, "(n,) [rad]");
  array(type, "touch_offset_m", &T::touch_offset_m, "(n,) [m]");
  array(type, "tilt", &T::tilt,
        "(n, 3) [-] tangential over normal force at the touch; or (0, 3)");
  array(type, "tilt_by_depth_per_m", &T::tilt_by_depth_per_m,
        "(n, 3) [1/m] its change with normal depth past the touch; or (0, 3)");
  array(type, "error_relative", &T::error_relative, "(n,) [-] stated error of force");
  array(type, "friction", &T::friction, "(n,) [-] Coulomb coefficient");
  array(type, "presliding_m", &T::presliding_m, "(n,) [m]");
  array(type, "stiffness_max_n_per_m", &T::stiffness_max_n_per_m, "(n,) [N/m]");
  array(type, "origin", &T::origin,
        "(n,) 0 none, 1 simulated, 2 interpolated, 3 measured");
  array(type, "flags", &T::flags, "(n,) bits, see FORMAT.md");
  array(type, "verified_error_relative", &T::verified_error_relative,
        "(n,) [-] measured, NaN: not verified; or empty");
  array(type, "history", &T::history, "(n,) row of history_text, -1: none; or empty");
  array(type, "failure", &T::failure, "(n,) row of failure_reason, -1: none; or empty");
}

void add_sample_arrays(py::class_<HeldTool>& type) {
  using T = ResponseTable;
  array(type, "sample_begin", &T::sample_begin,
        "(n + 1,) node i owns samples sample_begin[i] to sample_begin[i + 1] - 1");
  array(type, "depth_m", &T::depth_m, "(s,) [m] along the direction");
  array(type, "force_n", &T::force_n, "(s,) [N]");
  array(type, "stiffness_n_per_m", &T::stiffness_n_per_m, "(s,) [N/m]");
  array(type, "energy_j", &T::energy_j, "(s,) [J]");
  array(type, "force_n_errors", &T::force_errors_n, "(s,) [N] or empty");
  array(type, "direction_begin", &T::direction_begin, "(n + 1,) or empty");
  array(type, "sample_direction", &T::sample_direction, "(q, 3) [-]");
}

}  // namespace

void bind_tool(py::module_& module) {
  py::class_<HeldTool> type(module, "Tool",
                            "Responses of one tool, as read-only arrays in SI units.");
  type.def_property_readonly("name", [](const HeldTool& t) {
    return t.table->tool.name;
  });
  type.def_property_readonly("shape", [](const HeldTool& t) {
    return t.table->tool.kind;
  });
  type.def_property_readonly("radius_m", [](const HeldTool& t) {
    return t.table->tool.radius_m;
  });
  type.def_property_readonly("history_text", [](const HeldTool& t) {
    return t.table->history_text;
  });
  type.def_property_readonly("failure_reason", [](const HeldTool& t) {
    return t.table->failure_reason;
  });
  add_node_arrays(type);
  add_sample_arrays(type);
  bind_optional(type);
  bind_pressure(module, type);
  bind_contact(type);
  type.def("curve", &curve, py::arg("node"),
           "The stored curve of a node, four arrays.");
  type.def(
      "force", &forces_at, py::arg("positions"), py::kw_only(), py::arg("threads") = 0,
      py::arg("out") = py::none(),
      "Force on the tool [N], (n, 3), at positions (n, 3) [m] of its reference "
      "point, or (3,) for one.\n\nThe stored potential field without friction and "
      "history; of a body that relaxes, its\ninstantaneous response. On `threads` "
      "threads (0: all processors), whose number changes no bit,\nwithout Python's "
      "lock. out: a buffer that gets the forces and is returned.\nInputError: shape, "
      "not finite, body that yields, a buffer that cannot be written to.");
  type.def("stiffness", &stiffness, py::arg("depth"),
           "Slope (n,) [N/m] of each node's stored curve at depth [m] along its "
           "direction;\nNaN at a node without response.");
}

}  // namespace palpate
