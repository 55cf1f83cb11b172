// palpate-db diff: how far two databases of one body are apart in force.
#include <algorithm>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/command/commands.h"
#include "formats/database/database_diff.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct DiffFlags {
  std::string first;
  std::string second;
  double tolerance_relative = 0.0;
  std::size_t worst = 5;
  bool json = false;
};

Json difference_json(const ToolDifference& tool) {
  Json worst = Json::array();
  for (const NodeDifference& node : tool.worst) {
    worst.push_back({{"node", node.node},
                     {"depth_m", node.curve.depth_m},
                     {"largest_n", node.curve.largest_n},
                     {"rms_n", node.curve.rms_n},
                     {"relative_rms", node.relative_rms},
                     {"largest_relative", node.largest_relative},
                     {"direction_rad", node.direction_rad}});
  }
  return {{"tool", tool.tool},
          {"compared", tool.compared},
          {"only_first", tool.only_first},
          {"only_second", tool.only_second},
          {"largest_n", tool.largest_n},
          {"rms_n", tool.rms_n},
          {"largest_relative_rms", tool.largest_relative_rms},
          {"largest_depth_m", tool.largest_depth_m},
          {"largest_direction_rad", tool.largest_direction_rad},
          {"largest_relaxation", tool.largest_relaxation},
          {"same_memory", tool.same_memory},
          {"same_puncture", tool.same_puncture},
          {"largest_compliance", tool.largest_compliance},
          {"largest_contact", tool.largest_contact},
          {"stated_errors",
           {{"covered", tool.stated.covered},
            {"stated_over_found", tool.stated.stated_over_found},
            {"found_median", tool.stated.found_median},
            {"found_p95", tool.stated.found_p95}}},
          {"worst", worst}};
}

void print_difference(const ToolDifference& tool) {
  fmt::print(
      "tool       {}: {} nodes compared, {} only in the first, {} only in the second\n",
      tool.tool, tool.compared, tool.only_first, tool.only_second);
  fmt::print(
      "force      largest difference {:.4g} N, rms {:.4g} N, worst node {:.4g} of its "
      "own force\n",
      tool.largest_n, tool.rms_n, tool.largest_relative_rms);
  fmt::print(
      "also       direction {:.4g} rad, largest depth {:.4g} mm, relaxation {:.4g} of "
      "the force held, coupling {:.4g} of its largest, pressure's radius or lateral "
      "stiffness {:.4g}{}{}\n",
      tool.largest_direction_rad, 1e3 * tool.largest_depth_m, tool.largest_relaxation,
      tool.largest_compliance, tool.largest_contact,
      tool.same_memory ? ""
                       : "; memory: other sites, bundles, kind of curve or yielding",
      tool.same_puncture ? "" : "; puncture: other numbers or layers");
  if (tool.compared > 0) {
    fmt::print(
        "stated     {:.1f} % of nodes differ by no more than the first's stated error, "
        "which is {:.2g} times the difference in the median; differences are {:.2g} % "
        "in "
        "the median, {:.2g} % at the 95th percentile\n",
        100.0 * tool.stated.covered, tool.stated.stated_over_found,
        100.0 * tool.stated.found_median, 100.0 * tool.stated.found_p95);
  }
  for (const NodeDifference& node : tool.worst) {
    fmt::print(
        "  node {:<8} {:.4g} relative, rms {:.4g} N, largest {:.4g} N to {:.4g} mm\n",
        node.node, node.relative_rms, node.curve.rms_n, node.curve.largest_n,
        1e3 * node.curve.depth_m);
  }
}

void run_diff(const DiffFlags& flags) {
  const std::vector<ToolDifference> tools =
      difference(read_database(flags.first), read_database(flags.second), flags.worst);
  const bool agree = std::all_of(tools.begin(), tools.end(), [&](const auto& tool) {
    return tool.agrees(flags.tolerance_relative);
  });
  Json report = {{"agree", agree},
                 {"tolerance_relative", flags.tolerance_relative},
                 {"tools", Json::array()}};
  for (const ToolDifference& tool : tools) {
    if (flags.json) {
      report["tools"].push_back(difference_json(tool));
    } else {
      print_difference(tool);
    }
  }
  if (flags.json) {
    fmt::print("{}\n", json_text(report));
  }
  if (!agree) {
    throw Difference(fmt::format("{} and {} differ by more than {} of force",
                                 flags.first, flags.second, flags.tolerance_relative));
  }
}

}  // namespace

void add_diff_command(Command app) {
  Command command = app.add_subcommand(
      "diff", "Compare the forces of two databases of one body; exit 6 if they differ");
  auto flags = std::make_shared<DiffFlags>();
  command.add_option("first", flags->first, "Response database (HDF5 or flat)")
      .required();
  command.add_option("second", flags->second, "Response database (HDF5 or flat)")
      .required();
  command
      .add_option("--tolerance", flags->tolerance_relative,
                  "Relative rms difference of a node's force that counts as none")
      .not_negative();
  command.add_option("--worst", flags->worst, "How many nodes to list per tool");
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_diff(*flags);
  });
}

}  // namespace palpate
