// What laboratories measured, and surfaces of files, as arrays.
#include "python/binding/bind.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "fitting/curve/split_presses.h"
#include "formats/base/error.h"
#include "formats/measurement/instrument_file.h"
#include "formats/mesh/surface_reader.h"

namespace py = pybind11;

namespace palpate {
namespace {

// A press of a file, or why it cannot be read.
struct ReadPress {
  InstrumentCurve curve;
  MeasurementFile file;  // empty where `broken` says why
  std::size_t press = 1, presses = 1;
  std::string broken;
};

struct ReadPresses {
  std::string layout, left_out;
  std::vector<ReadPress> press;
};

void append_presses(const InstrumentCurve& curve, MeasurementFile whole,
                    ReadPresses& all) {
  std::vector<Measurement> presses =
      split_presses(std::exchange(whole.samples, Measurement{}));
  for (std::size_t k = 0; k < presses.size(); ++k) {
    ReadPress& press = all.press.emplace_back();
    press.curve = curve;
    press.file = whole;
    press.file.samples = std::move(presses[k]);
    press.press = k + 1;
    press.presses = presses.size();
  }
}

ReadPresses read_presses(const std::filesystem::path& file,
                         const InstrumentRequest& request) {
  const InstrumentLayout& layout = layout_of(file);
  const InstrumentFile list = layout.list(file);
  ReadPresses all{std::string(layout.name), list.left_out, {}};
  for (const InstrumentCurve& curve : list.curve) {
    try {
      append_presses(curve, layout.read(file, curve, request), all);
    } catch (const Error& error) {
      if (list.curve.size() == 1) {
        throw;
      }
      ReadPress& press = all.press.emplace_back();
      press.curve = curve;
      press.broken = error.what();
    }
  }
  return all;
}

template <typename Value>
py::object or_none(const std::optional<Value>& value) {
  if (!value) {
    return py::none();
  }
  if constexpr (std::is_same_v<Value, double>) {
    return py::float_(*value);
  } else {
    return py::array_t<double>(value->size(), value->data());
  }
}

py::array array_of(const std::vector<double>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::dict parts_of(const ReadPress& press) {
  const Measurement& samples = press.file.samples;
  py::dict metadata;
  metadata["number"] = press.curve.number;
  metadata["press"] = press.press;
  metadata["presses"] = press.presses;
  metadata["kind"] = press.curve.kind;
  metadata["line"] = press.curve.line;
  metadata["position_m"] = or_none(press.curve.position_m);
  metadata["normal"] = or_none(press.curve.normal);
  metadata["tip_radius_m"] = or_none(press.curve.tip_radius_m);
  metadata["spring_n_per_m"] = or_none(press.curve.spring_n_per_m);
  metadata["depth_column"] = press.file.depth_column;
  metadata["force_column"] = press.file.force_column;
  metadata["time_column"] = press.file.time_column;
  metadata["notes"] = press.file.notes;
  py::dict parts;
  parts["broken"] = press.broken;
  parts["depth_m"] = array_of(samples.depth_m);
  parts["force_n"] = array_of(samples.force_n);
  parts["time_s"] = array_of(samples.time_s);
  parts["metadata"] = metadata;
  return parts;
}

std::optional<MeasurementColumn> time_column(const MeasurementColumn& given) {
  if (given.column.empty()) {
    if (!given.unit.empty()) {
      throw InputError("time_unit goes with time_column");
    }
    return std::nullopt;
  }
  return MeasurementColumn{given.column,
                           given.unit.empty() ? kUnitFromHeader : given.unit};
}

py::tuple load(const std::filesystem::path& file, MeasurementColumn depth,
               MeasurementColumn force, const MeasurementColumn& time, bool with_time,
               bool ignore_header_units) {
  InstrumentRequest request;
  request.given = {std::move(depth), std::move(force), time_column(time)};
  request.header_units =
      ignore_header_units ? HeaderUnits::kIgnored : HeaderUnits::kMustAgree;
  request.with_time = with_time;
  ReadPresses all;
  {
    const py::gil_scoped_release released;
    all = read_presses(file, request);
  }
  py::list presses;
  for (const ReadPress& press : all.press) {
    presses.append(parts_of(press));
  }
  return py::make_tuple(all.layout, all.left_out, presses);
}

py::tuple read_mesh(const std::filesystem::path& file, const std::string& unit) {
  SurfaceMesh mesh;
  {
    const py::gil_scoped_release released;
    mesh = read_surface(file, unit);
  }
  py::array_t<double> vertices({mesh.position_m.rows(), py::ssize_t{3}},
                               mesh.position_m.data());
  py::array_t<std::int32_t> faces({mesh.triangle.rows(), py::ssize_t{3}},
                                  mesh.triangle.data());
  return py::make_tuple(vertices, faces);
}

}  // namespace

void bind_measurement(py::module_& module) {
  using Column = std::pair<std::string, std::string>;
  module.def(
      "_load",
      [](const std::filesystem::path& file, const Column& depth, const Column& force,
         const Column& time, bool with_time, bool ignore_header_units) {
        const auto column = [](const Column& given) {
          return MeasurementColumn{given.first, given.second};
        };
        return load(file, column(depth), column(force), column(time), with_time,
                    ignore_header_units);
      },
      py::arg("file"), py::arg("depth"), py::arg("force"), py::arg("time"),
      py::arg("with_time"), py::arg("ignore_header_units"));
  module.def(
      "read_mesh", &read_mesh, py::arg("file"), py::arg("length_unit"),
      "Vertices (n, 3) [m] and triangles (t, 3) of an OBJ, STL, PLY or OFF file.\n\n"
      "length_unit: 'm', 'cm', 'mm', 'um', 'in', ..., of the file's coordinates. "
      "Nothing is\nrepaired. InputError, FormatError: what is wrong with the file.");
}

}  // namespace palpate
