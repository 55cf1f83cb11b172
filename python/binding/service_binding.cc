// A scene that is rendered while it is computed: its options, and how its service is.
#include "python/binding/bind.h"
#include "python/binding/held_renderer.h"
#include "python/binding/option.h"
#include "python/binding/scene_option.h"

#include <string>

#include <pybind11/pybind11.h>

namespace py = pybind11;

namespace palpate {
namespace {

py::object service_of(const HeldRenderer& renderer) {
  const ServedClient* client = renderer.body().service();
  if (client == nullptr) {
    return py::none();
  }
  const ServiceStatus status = client->status();
  py::dict all;
  all["state"] = std::string(palpate::name(status.state));
  all["detail"] = status.detail;
  all["nodes"] = status.progress.nodes;
  all["answered"] = status.progress.answered;
  all["finished"] = status.progress.finished;
  all["softened"] = renderer.body().softened();
  return all;
}

}  // namespace

void take_scene(const std::filesystem::path& file, const py::dict& given,
                HostOptions& options) {
  if (file.extension() != ".toml") {
    return;
  }
  options.scene = true;
  take_option(given, "estimate", options.estimate);
  const py::object output = given.attr("pop")("output", py::none());
  if (!output.is_none()) {
    options.output = py::str(output).cast<std::string>();
  }
  options.server = py::module_::import("palpate._tools")
                       .attr("find_tool")("palpate-precompute")
                       .cast<std::string>();
}

void bind_service(py::class_<HeldRenderer>& type) {
  type.def_property_readonly(
      "answer",
      [](const HeldRenderer& renderer) {
        return std::string(palpate::name(renderer.answer()));
      },
      "'none', 'estimated', 'preliminary' or 'final': of a scene, how the place "
      "answers by "
      "now");
  type.def_property_readonly(
      "service", &service_of,
      "of a scene: state, detail, nodes, answered, finished, softened; "
      "of a database None");
}

}  // namespace palpate
