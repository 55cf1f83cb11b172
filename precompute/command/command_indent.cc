#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "precompute/command/commands.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/node_detail.h"
#include "precompute/press/vtu_file.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

struct IndentFlags {
  std::string scene;
  std::int64_t vertex = -1;
  std::vector<double> at_m;
  std::string tool;
  std::string vtu;
  std::string repair = "off";
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

// A figure that does not exist is null: JSON knows no NaN.
nlohmann::ordered_json figure(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nullptr;
}

nlohmann::ordered_json checks_json(const NodeDetail& detail) {
  const BalanceChecks& checks = detail.checks;
  return {{"depth_m", detail.body.penetration_m},
          {"work_relative", figure(checks.work)},
          {"force_relative", figure(checks.force)},
          {"moment_relative", figure(checks.moment)},
          {"theory_force_relative", figure(checks.theory_force)},
          {"theory_moment_relative", figure(checks.theory_moment)}};
}

nlohmann::ordered_json response_json(const NodeDetail& detail,
                                     const NodeResponse& response,
                                     const std::vector<std::string>& notes) {
  const PressedNode& result = detail.pressed;
  nlohmann::ordered_json report{{"vertex", result.vertex},
                                {"position_m", list(result.path.vertex_m)},
                                {"inward_normal", list(-result.path.outward)}};
  for (std::size_t k = 0; k < result.indentation.sample.size(); ++k) {
    const IndentationSample& sample = result.indentation.sample[k];
    report["depth_m"].push_back(sample.penetration_m);
    report["force_vector_n"].push_back(list(sample.force_n));
    report["force_n"].push_back(sample.force_n.norm());
    report["energy_j"].push_back(sample.energy_j);
    report["contact_radius_m"].push_back(sample.contact_radius_m);
    report["newton"].push_back(detail.depth[k].newton);
    report["gradients"].push_back(detail.depth[k].gradients);
    report["smallest_det_f"].push_back(detail.depth[k].smallest_jacobian);
  }
  report["touch_offset_m"] = response.touch_offset_m;
  report["direction"] = list(response.direction);
  report["direction_spread_rad"] = response.direction_spread_rad;
  const Indentation& path = result.indentation;
  report["error_relative"] = response.error_relative;  // an estimate, by ...
  report["error_parts"] = {
      {"pressure_mesh", path.sample.size() > 1 ? pressure_mesh_error(path) : 0.0},
      {"path", path.path_error},
      {"contact_edge", path.edge_share}};
  report["near_singular"] = path.near_singular;
  report["node_spacing_m"] = result.indentation.node_spacing_m;
  report["nonlinear"] = result.nonlinear != nullptr;
  report["tets"] = detail.model.mesh.tet.rows();
  report["near_tets"] = result.checks.near_tets;
  report["min_dihedral_deg"] = detail.model.min_dihedral_deg;
  report["checks"] = checks_json(detail);
  report["converged"] = result.indentation.converged && result.failure.empty();
  report["failure"] = result.failure;
  report["history"] = history_text(result.tried);
  report["notes"] = notes;
  return report;
}

void print_samples(const NodeDetail& detail) {
  fmt::print("{:>12} {:>12} {:>12} {:>12} {:>12} {:>12} {:>11} {:>7} {:>9} {:>7}\n",
             "depth [mm]", "force [N]", "Fx [N]", "Fy [N]", "Fz [N]", "energy [J]",
             "radius [mm]", "Newton", "gradients", "det F");
  for (std::size_t k = 0; k < detail.depth.size(); ++k) {
    const IndentationSample& s = detail.pressed.indentation.sample[k];
    const DepthDetail& d = detail.depth[k];
    fmt::print(
        "{:12.4f} {:12.5g} {:12.5g} {:12.5g} {:12.5g} {:12.5g} {:11.3f} {:7} {:9} "
        "{:7.4f}\n",
        1e3 * s.penetration_m, s.force_n.norm(), s.force_n.x(), s.force_n.y(),
        s.force_n.z(), s.energy_j, 1e3 * s.contact_radius_m, d.newton, d.gradients,
        d.smallest_jacobian);
  }
}

void print_checks(const NodeDetail& detail) {
  const BalanceChecks& checks = detail.checks;
  if (std::isnan(checks.work)) {
    return;
  }
  fmt::print("work against stored energy: {:.2g} relative\n", checks.work);
  if (std::isnan(checks.force)) {
    fmt::print("balance: the contact loads held nodes, nothing to compare\n");
    return;
  }
  fmt::print(
      "contact against supports: force {:.2g}, moment {:.2g} relative; left to linear "
      "theory: force {:.2g}, moment {:.2g}\n",
      checks.force, checks.moment, checks.theory_force, checks.theory_moment);
}

void print_response(const NodeDetail& detail, const NodeResponse& response) {
  const PressedNode& result = detail.pressed;
  const Eigen::Vector3d& p = result.path.vertex_m;
  const Eigen::Vector3d n = -result.path.outward;
  fmt::print(
      "vertex {} at ({:.5g}, {:.5g}, {:.5g}) m, inward normal ({:.3f}, {:.3f}, "
      "{:.3f})\n{} tets, {} of them near and nonlinear\n",
      result.vertex, p.x(), p.y(), p.z(), n.x(), n.y(), n.z(),
      detail.model.mesh.tet.rows(), result.checks.near_tets);
  print_samples(detail);
  fmt::print(
      "estimated force error {:.1f} % (a build says more, by its checks), direction "
      "spread {:.2f} deg, contact node "
      "spacing {:.3g} mm\n",
      100 * response.error_relative, response.direction_spread_rad * 57.29577951,
      1e3 * result.indentation.node_spacing_m);
  print_checks(detail);
  if (const std::string history = history_text(result.tried); !history.empty()) {
    fmt::print("pressed again: {}\n", history);
  }
  if (!result.failure.empty()) {
    fmt::print("the path ends early: {}\n", result.failure);
  }
}

void print_needle_note(const Scene& scene, const BodySource& body,
                       const ToolSurface& tool) {
  for (std::size_t t = 0; t < scene.tool_needle.size(); ++t) {
    const auto& needle = scene.tool_needle[t];
    if (needle && body.tool[t].get() == &tool && !needle->is_its_ball()) {
      fmt::print(
          "note: this is the ball of {:.4g} mm that is pressed; a build makes the "
          "curve "
          "of a needle of {:.4g} mm of it\n",
          1e3 * needle->press_radius_m, 1e3 * needle->radius_m);
    }
  }
}

void run_indent(const IndentFlags& flags) {
  note_interrupts();
  const Scene scene = read_scene(flags.scene);
  Progress progress(stderr);
  const BodySource body = read_body(scene, repair_mode(flags.repair));
  const std::int64_t vertex =
      flags.at_m.empty()
          ? flags.vertex
          : nearest_vertex(body.surface, Eigen::Vector3d(flags.at_m.data()));
  const SharedTool tool = chosen_tool(body, flags.tool);
  const NodeDetail detail = press_in_detail(scene, body, tool, vertex, {}, progress);
  const NodeResponse response = to_response(detail.pressed.indentation,
                                            detail.pressed.path, scene.force_relative);
  if (!flags.vtu.empty()) {
    write_vtu(flags.vtu, detail.model.mesh, detail.body.displacement_m,
              detail.body.near);
  }
  if (flags.json) {
    fmt::print("{}\n", json_text(response_json(detail, response, body.notes)));
  } else {
    print_response(detail, response);
    for (const std::string& note : body.notes) {
      fmt::print("note: {}\n", note);
    }
    print_needle_note(scene, body, *tool);
  }
}

}  // namespace

void add_indent_command(Command app) {
  Command command =
      app.add_subcommand("indent", "Print the response of one node of a scene's body");
  auto flags = std::make_shared<IndentFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  Command where = command.add_choice("where");
  where.add_option("--vertex", flags->vertex, "Index of a vertex of the mesh");
  where.add_option("--at", flags->at_m, "The vertex nearest to x,y,z [m]")
      .separated_by(',')
      .values(3);
  command.add_option("--tool", flags->tool, "Name of the tool; default: the first");
  command.add_option("--repair", flags->repair,
                     "off, safe or wrap: mend the body's surface first");
  command.add_option("--vtu", flags->vtu,
                     "Write the deformed body at the last depth (VTK, for ParaView)");
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_indent(*flags);
  });
}

}  // namespace palpate
