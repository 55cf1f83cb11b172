// Pressure over a tool's face, and the stored tables of its contacts.
#include "python/binding/array_view.h"
#include "python/binding/bind.h"
#include "python/binding/held_database.h"
#include "python/binding/number_array.h"

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "formats/base/error.h"
#include "formats/response/tangent_frame.h"
#include "formats/response/taxels.h"

namespace py = pybind11;

namespace palpate {
namespace {

TaxelGrid grid_of(const py::object& grid) {
  const auto parts = py::cast<py::sequence>(grid);
  if (py::len(parts) != 3) {
    throw InputError(fmt::format("grid has {} values, must be (rows, columns, pitch_m)",
                                 py::len(parts)));
  }
  return {.rows = py::cast<int>(parts[0]),
          .columns = py::cast<int>(parts[1]),
          .pitch_m = py::cast<double>(parts[2])};
}

py::dict pressure(const HeldTool& tool, const py::object& position,
                  const py::object& grid) {
  Eigen::Vector3d at;
  take_row(position, "position", 3, at.data());
  const ResponseDatabase& database = tool.held->database;
  const Taxels taxels =
      taxels_at(database.body, database.normal, SurfaceSearch(database.body),
                *tool.table, at, grid_of(grid));
  const bool touches = taxels.contact.normal_n > 0.0;
  const auto frame = tangent_frame(taxels.outward);
  py::dict parts;
  parts["pressure_pa"] = taxels.pressure_pa;
  parts["force_n"] = taxels.contact.normal_n;
  parts["beside_n"] = taxels.beside_n;
  parts["radius_m"] = touches ? taxels.contact.radius_m() : 0.0;
  parts["middle_pa"] = touches ? taxels.contact.middle_pa() : 0.0;
  parts["centre_m"] = taxels.contact.centre_m;
  parts["moment_m2"] = taxels.contact.moment_m2;
  parts["exponent"] = taxels.contact.exponent;
  parts["error_relative"] = taxels.error_relative;
  parts["middle_m"] = taxels.middle_m;
  parts["outward"] = taxels.outward;
  parts["x"] = frame.col(0).eval();
  parts["y"] = frame.col(1).eval();
  return parts;
}

py::dict contact_tables(const HeldTool& tool) {
  py::dict parts;
  for_each_contact_dataset(tool.table->contact,
                           [&](const std::string& name, const char* /*units*/,
                               Eigen::Index /*columns*/, const RowsOf<float>& rows) {
                             if (rows.rows() > 0) {
                               parts[py::str(name.substr(1))] = rows;
                             }
                           });
  return parts;
}

}  // namespace

void bind_contact(py::class_<HeldTool>& tool) {
  tool.def("pressure", &pressure, py::arg("position"), py::arg("grid"),
           "Pressure under the tool with its reference point at (3,) [m], on a grid "
           "(rows, columns,\npitch_m) of taxels in the plane across the surface, its "
           "middle below the tool. A dict:\npressure_pa (rows, columns), rows along y, "
           "columns along x; force_n along the normal, of which\nbeside_n is on no "
           "taxel; radius_m, middle_pa, centre_m, moment_m2, exponent and "
           "error_relative of the\ncontact; middle_m, outward, x and y in the world. "
           "InputError: no pressures are stored.");
  tool.def_property_readonly(
      "contact", &contact_tables,
      "Stored tables by name, as FORMAT.md has them: \"pressure/moment_m2\", "
      "\"lateral/stiffness\", ..; empty: none.");
}

}  // namespace palpate
