#include "python/binding/array_view.h"
#include "python/binding/bind.h"
#include "python/binding/held_database.h"

#include <filesystem>
#include <span>
#include <string_view>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace palpate {

HeldTool tool_of(const std::shared_ptr<HeldDatabase>& held, const std::string& name) {
  return {held, &find_tool(held->database, name)};
}

std::shared_ptr<const StaticField> field_of(const HeldTool& tool) {
  auto& field = tool.held->field[tool.table];
  if (!field) {
    field = std::make_shared<const StaticField>(tool.held->database, *tool.table);
  }
  return field;
}

namespace {

using Held = std::shared_ptr<HeldDatabase>;

Held open(const std::filesystem::path& file) {
  const py::gil_scoped_release released;
  return std::make_shared<HeldDatabase>(HeldDatabase{read_database(file)});
}

// What a path is made of may be bytes, too: these are a database's.
Held open_bytes(const py::bytes& bytes) {
  const std::string_view all(bytes);
  const py::gil_scoped_release released;
  return std::make_shared<HeldDatabase>(
      HeldDatabase{read_database(StoredSource(std::as_bytes(std::span(all))))});
}

void save(const Held& held, const std::filesystem::path& file) {
  const py::gil_scoped_release released;
  write_database(file, held->database);
}

std::vector<std::string> tool_names(const Held& held) {
  std::vector<std::string> names;
  for (const ResponseTable& table : held->database.tools) {
    names.push_back(table.tool.name);
  }
  return names;
}

py::dict provenance(const Held& held) {
  const Provenance& from = held->database.provenance;
  py::dict parts;
  parts["writer"] = from.writer;
  parts["scene_toml"] = from.scene_toml;
  parts["source_file"] = from.source_file;
  parts["source_sha256"] = from.source_sha256;
  parts["left_out"] = from.left_out;
  return parts;
}

py::dict measurement(const Held& held) {
  const Measurement& from = held->database.measurement;
  const py::object owner = py::cast(held);
  py::dict parts;
  parts["depth_m"] = looking_at(from.depth_m, owner);
  parts["force_n"] = looking_at(from.force_n, owner);
  parts["time_s"] = looking_at(from.time_s, owner);
  parts["depth_m_errors"] = looking_at(from.depth_errors_m, owner);
  parts["force_n_errors"] = looking_at(from.force_errors_n, owner);
  parts["run_begin"] = looking_at(from.run_begin, owner);
  parts["run_node"] = looking_at(from.run_node, owner);
  parts["run_name"] = from.run_name;
  return parts;
}

}  // namespace

void bind_database(py::module_& module) {
  py::class_<HeldDatabase, Held> type(
      module, "Database", py::dynamic_attr(),
      "A body's responses, as read-only arrays in SI units.\n\nreport: of one that "
      "build() or precompute() made, what palpate-precompute said.");
  type.def_property_readonly(
      "vertices",
      [](const Held& h) {
        return rows_of(h->database.body.position_m, py::cast(h));
      },
      "(n, 3) [m] nodes at rest");
  type.def_property_readonly(
      "triangles",
      [](const Held& h) {
        return rows_of(h->database.body.triangle, py::cast(h));
      },
      "(t, 3) node indices, counter-clockwise from outside");
  type.def_property_readonly(
      "normals",
      [](const Held& h) {
        return rows_of(h->database.normal, py::cast(h));
      },
      "(n, 3) [-] outward unit normals");
  type.def_property_readonly("tools", &tool_names, "names of the tools");
  type.def_property_readonly("provenance", &provenance);
  type.def_property_readonly("measurement", &measurement,
                             "raw samples and runs; empty unless measured");
  type.def(
      "tool", &tool_of, py::arg("name") = "",
      "The named tool, or the only one. InputError names the tools that there are.");
  type.def("save", &save, py::arg("file"),
           "Writes the database; the file is there whole or not at all.");
  constexpr const char* kOpen =
      "Reads and checks a response database, HDF5 or flat, by its path or of its "
      "bytes; "
      "nodes in the order of the source.\n\n"
      "InputError: no such file. FormatError: foreign, truncated or damaged.";
  module.def("open", &open_bytes, py::arg("file"), kOpen);
  module.def("open", &open, py::arg("file"), kOpen);
}

}  // namespace palpate
