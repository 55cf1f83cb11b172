// palpate-precompute sweep: a body's forces over a grid of material parameters.
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "precompute/build/material_sweep.h"
#include "precompute/command/commands.h"
#include "precompute/press/node_detail.h"
#include "precompute/press/scene_solver.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

struct SweepFlags {
  std::string scene;
  std::vector<std::string> parameter;
  std::vector<double> from, to;
  std::vector<int> count;
  std::vector<std::int32_t> vertex;
  std::vector<double> at_m;
  std::string tool;
  std::string output;
  bool json = false;
};

std::vector<SweepParameter> parameters_of(const SweepFlags& flags) {
  const std::size_t n = flags.parameter.size();
  if (flags.from.size() != n || flags.to.size() != n || flags.count.size() != n) {
    throw InputError(fmt::format(
        "{} --parameter, {} --from, {} --to, {} --count: each parameter needs one of "
        "each, in the same order",
        n, flags.from.size(), flags.to.size(), flags.count.size()));
  }
  std::vector<SweepParameter> parameters;
  for (std::size_t j = 0; j < n; ++j) {
    parameters.push_back(
        grid_of(flags.parameter[j], flags.from[j], flags.to[j], flags.count[j]));
  }
  return parameters;
}

const SharedTool& swept_tool(const BodySource& body, const std::string& name) {
  for (const SharedTool& tool : body.tool) {
    if (name.empty() || tool->shape().name == name) {
      return tool;
    }
  }
  throw InputError(fmt::format("tool {:?} is not in the scene; its first is {:?}", name,
                               body.tool.front()->shape().name));
}

std::vector<std::int32_t> vertices_of(const SweepFlags& flags, const Scene& scene,
                                      const BodySource& body) {
  std::vector<std::int32_t> vertices = flags.vertex;
  if (!flags.at_m.empty()) {
    vertices.push_back(static_cast<std::int32_t>(
        nearest_vertex(body.surface, Eigen::Vector3d(flags.at_m.data()))));
  }
  for (const std::int32_t v : vertices) {
    if (v < 0 || v >= body.surface.position_m.rows()) {
      throw InputError(fmt::format("vertex {} is not one of the body's {}", v,
                                   body.surface.position_m.rows()));
    }
    if (is_held(scene, body.surface.position_m.row(v).transpose())) {
      throw InputError(fmt::format("vertex {} is held by a support", v));
    }
  }
  return vertices;
}

void print_sweep(const ResponseSweep& sweep, const SweepFlags& flags, double seconds) {
  if (flags.json) {
    nlohmann::ordered_json report{{"combinations", sweep.combinations()},
                                  {"vertices", sweep.vertex},
                                  {"depth_max_m", sweep.depth_m.back()},
                                  {"error_relative", sweep.error_relative},
                                  {"seconds", seconds},
                                  {"file", flags.output}};
    for (const SweepParameter& p : sweep.parameter) {
      report["parameters"].push_back({{"name", p.name}, {"values", p.value}});
    }
    fmt::print("{}\n", json_text(report));
    return;
  }
  fmt::print(
      "{} combinations at {} vertices to {:.4g} mm in {:.1f} s, forces within about "
      "{:.2g} %: {}\n",
      sweep.combinations(), sweep.vertex.size(), 1e3 * sweep.depth_m.back(), seconds,
      100.0 * sweep.error_relative, flags.output);
}

void run_sweep(const SweepFlags& flags) {
  note_interrupts();
  const auto begin = std::chrono::steady_clock::now();
  std::vector<SweepParameter> parameters = parameters_of(flags);
  const Scene scene = read_scene(flags.scene);
  require_whole_body(scene, "sweep");
  const BodySource body = read_body(scene);
  const std::vector<std::int32_t> vertices = vertices_of(flags, scene, body);
  Progress progress(stderr);
  const ResponseSweep sweep =
      sweep_materials(scene, body, swept_tool(body, flags.tool), vertices,
                      std::move(parameters), progress);
  write_sweep(flags.output, sweep);
  print_sweep(
      sweep, flags,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
}

}  // namespace

void add_sweep_command(Command app) {
  Command command = app.add_subcommand(
      "sweep", "Press nodes of a scene's body for a grid of material parameters");
  auto flags = std::make_shared<SweepFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  command
      .add_option("--parameter", flags->parameter,
                  "constant, or region.constant, of a material; again for more")
      .required()
      .one_value_each();
  command.add_option("--from", flags->from, "smallest value, one per parameter")
      .required()
      .one_value_each();
  command.add_option("--to", flags->to, "largest value, one per parameter")
      .required()
      .one_value_each();
  command
      .add_option("--count", flags->count, "values in equal ratios, one per parameter")
      .required()
      .one_value_each();
  Command where = command.add_choice("where");
  where.add_option("--vertex", flags->vertex, "Index of a vertex; again for more")
      .one_value_each();
  where.add_option("--at", flags->at_m, "The vertex nearest to x,y,z [m]")
      .separated_by(',')
      .values(3);
  command.add_option("--tool", flags->tool, "Name of the tool; default: the first");
  command.add_option("-o,--output", flags->output, "Sweep file (CSV)").required();
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_sweep(*flags);
  });
}

}  // namespace palpate
