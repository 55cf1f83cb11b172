#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/command_line.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/base/quantile.h"
#include "formats/database/error_calibration.h"
#include "precompute/command/commands.h"
#include "precompute/press/contact_coupling.h"
#include "precompute/press/joint_presses.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct PairsFlags {
  std::string scene;
  std::string tool;
  JointOptions options;
  bool json = false;
};

Json quantiles(const std::vector<double>& errors) {
  if (errors.empty()) {
    return nullptr;
  }
  return {{"median", quantile(errors, 0.5)},
          {"p95", quantile(errors, 0.95)},
          {"largest", errors.back()}};
}

std::string percents(const std::vector<double>& errors) {
  return errors.empty()
             ? "-"
             : fmt::format("{:.2f} % median, {:.2f} % at the 95th percentile",
                           100 * quantile(errors, 0.5), 100 * quantile(errors, 0.95));
}

void print_study(const CouplingStudy& study) {
  for (const CouplingErrors& of : study.by_count) {
    fmt::print("contacts      {} at once, {} sets\n", of.contacts, of.sets);
    fmt::print("  not coupled {}\n", percents(of.alone));
    fmt::print("  by table    {}\n", percents(of.by_table));
    fmt::print("  by spots    {}\n", percents(of.by_spot));
  }
  if (!study.worst_by_table.empty()) {
    fmt::print("of {} sets, 95 % have every force by table within {:.2f} %\n",
               study.worst_by_table.size(), 100 * covering(study.worst_by_table));
  }
}

std::size_t named_tool(const Scene& scene, const std::string& name) {
  for (std::size_t t = 0; t < scene.tool.size(); ++t) {
    if (name.empty() ? scene.tool_couples[t] : scene.tool[t].name == name) {
      return t;
    }
  }
  throw InputError(
      name.empty() ? "no tool of the scene couples: give one shape = \"spheres\" or "
                     "compliance = true, or name one with --tool"
                   : fmt::format("the scene has no tool {:?}", name));
}

void run_pairs(const PairsFlags& flags) {
  Scene scene = read_scene(flags.scene);
  const std::size_t t = named_tool(scene, flags.tool);
  if (scene.tool[t].kind != "sphere") {
    throw InputError(fmt::format("tool {:?} is a {}, must be a sphere",
                                 scene.tool[t].name, scene.tool[t].kind));
  }
  scene.tool_couples[t] = true;  // the table is the one that a build keeps for it
  Progress progress(stderr);
  progress.stage("body");
  const BodySource body = read_body(scene);
  const std::vector<std::int32_t> vertices = reachable_vertices(scene, body);
  progress.stage("coupling of contacts");
  const ComplianceTable coupling = make_coupling_table(scene, body, vertices, progress);
  progress.stage("joint presses");
  const CouplingStudy study = coupling_errors(scene, body, body.tool[t], vertices,
                                              coupling, flags.options, progress);
  progress.finish();
  if (!flags.json) {
    print_study(study);
    return;
  }
  Json report = Json::array();
  for (const CouplingErrors& of : study.by_count) {
    report.push_back({{"contacts", of.contacts},
                      {"sets", of.sets},
                      {"not_coupled", quantiles(of.alone)},
                      {"by_table", quantiles(of.by_table)},
                      {"by_spots", quantiles(of.by_spot)}});
  }
  fmt::print("{}\n", json_text(Json{{"tool", scene.tool[t].name},
                                    {"errors", report},
                                    {"worst_of_sets", study.worst_by_table}}));
}

}  // namespace

void add_pairs_command(Command app) {
  Command command = app.add_subcommand(
      "pairs",
      "Press several places at once: how right are forces that couple by distance?");
  auto flags = std::make_shared<PairsFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  command.add_option("--tool", flags->tool,
                     "Sphere to press with; else the first that couples");
  command.add_option("-n,--sets", flags->options.sets, "Sets of places")
      .in_range(1, 10000)
      .show_default();
  command.add_option("--contacts", flags->options.contacts, "Places of a set")
      .in_range(2, 16)
      .separated_by(',')
      .show_default();
  command
      .add_option("--seed", flags->options.seed,
                  "Of the places' choice; a build takes its sets from 1 on")
      .show_default();
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    std::sort(flags->options.contacts.begin(), flags->options.contacts.end());
    run_pairs(*flags);
  });
}

}  // namespace palpate
