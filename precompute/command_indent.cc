#include "precompute/command_indent.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "precompute/build.h"
#include "precompute/interrupt.h"

namespace palpate {
namespace {

struct Flags {
  std::string scene;
  std::int64_t vertex = -1;
  std::vector<double> at_m;
  std::string tool;
  bool json = false;
};

const SharedTool& chosen_tool(const BodySource& body, const std::string& name) {
  if (name.empty()) {
    return body.tool.front();
  }
  std::string known;
  for (const SharedTool& tool : body.tool) {
    if (tool->shape().name == name) {
      return tool;
    }
    known += (known.empty() ? "" : ", ") + tool->shape().name;
  }
  throw InputError(
      fmt::format("tool \"{}\" is not in the scene; it has: {}", name, known));
}

std::vector<double> list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::ordered_json to_json(std::int64_t vertex, const PressedNode& result,
                               const NodeResponse& response) {
  nlohmann::ordered_json report{{"vertex", vertex},
                                {"position_m", list(result.path.vertex_m)},
                                {"inward_normal", list(-result.path.outward)}};
  for (const IndentationSample& sample : result.indentation.sample) {
    report["depth_m"].push_back(sample.penetration_m);
    report["force_vector_n"].push_back(list(sample.force_n));
    report["force_n"].push_back(sample.force_n.norm());
    report["energy_j"].push_back(sample.energy_j);
    report["contact_radius_m"].push_back(sample.contact_radius_m);
  }
  report["touch_offset_m"] = response.touch_offset_m;
  report["direction"] = list(response.direction);
  report["direction_spread_rad"] = response.direction_spread_rad;
  report["error_relative"] = response.error_relative;
  report["node_spacing_m"] = result.indentation.node_spacing_m;
  report["converged"] = result.indentation.converged;
  return report;
}

void print(std::int64_t vertex, const PressedNode& result,
           const NodeResponse& response) {
  const Eigen::Vector3d& p = result.path.vertex_m;
  const Eigen::Vector3d n = -result.path.outward;
  fmt::print(
      "vertex {} at ({:.5g}, {:.5g}, {:.5g}) m, inward normal ({:.3f}, {:.3f}, "
      "{:.3f})\n",
      vertex, p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  fmt::print("{:>12} {:>12} {:>12} {:>12} {:>12} {:>12} {:>11}\n", "depth [mm]",
             "force [N]", "Fx [N]", "Fy [N]", "Fz [N]", "energy [J]", "radius [mm]");
  for (const IndentationSample& s : result.indentation.sample) {
    fmt::print("{:12.4f} {:12.5g} {:12.5g} {:12.5g} {:12.5g} {:12.5g} {:11.3f}\n",
               1e3 * s.penetration_m, s.force_n.norm(), s.force_n.x(), s.force_n.y(),
               s.force_n.z(), s.energy_j, 1e3 * s.contact_radius_m);
  }
  fmt::print(
      "estimated force error {:.1f} %, direction spread {:.2f} deg, contact node "
      "spacing {:.3g} mm\n",
      100 * response.error_relative, response.direction_spread_rad * 57.29577951,
      1e3 * result.indentation.node_spacing_m);
}

void run(const Flags& flags) {
  note_interrupts();
  const Scene scene = read_scene(flags.scene);
  Progress progress(stderr);
  const BodySource body = read_body(scene);
  const std::int64_t vertex =
      flags.at_m.empty()
          ? flags.vertex
          : nearest_vertex(body.surface, Eigen::Vector3d(flags.at_m.data()));
  const PressedNode result =
      press_vertex(scene, body, chosen_tool(body, flags.tool), vertex, progress);
  const NodeResponse response =
      to_response(result.indentation, result.path, scene.force_relative);
  if (flags.json) {
    fmt::print("{}\n", to_json(vertex, result, response).dump());
  } else {
    print(vertex, result, response);
  }
}

}  // namespace

void add_indent_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("indent", "Print the response of one node of a scene's body");
  auto flags = std::make_shared<Flags>();
  command->add_option("scene", flags->scene, "Scene file (TOML)")->required();
  auto* where = command->add_option_group("where");
  where->add_option("--vertex", flags->vertex, "Index of a vertex of the mesh");
  where->add_option("--at", flags->at_m, "The vertex nearest to x,y,z [m]")
      ->delimiter(',')
      ->expected(3);
  where->require_option(1);
  command->add_option("--tool", flags->tool, "Name of the tool; default: the first");
  command->add_flag("--json", flags->json, "Print the report as one JSON object");
  command->callback([flags] {
    run(*flags);
  });
}

}  // namespace palpate
