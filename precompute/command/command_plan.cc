// palpate-precompute plan: what a build will do, leave out and take.
#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "precompute/build/plan.h"
#include "precompute/command/commands.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

struct PlanFlags {
  std::string scene;
  bool solve_all = false;
  int workers = 0;
  std::string repair = "off";
  bool json = false;
};

nlohmann::ordered_json plan_json(const PlanReport& plan) {
  nlohmann::ordered_json costs = nlohmann::ordered_json::array();
  for (const PlanCost& cost : plan.cost) {
    costs.push_back({{"work", cost.work},
                     {"count", cost.count},
                     {"timed", cost.timed},
                     {"timed_seconds", cost.timed_seconds},
                     {"seconds", cost.seconds}});
  }
  return {{"nodes", plan.nodes},
          {"reachable", plan.reachable},
          {"held", plan.held},
          {"outside_reach", plan.outside_reach},
          {"tools", plan.tools},
          {"units", plan.units},
          {"checks", plan.checks},
          {"nonlinear", plan.nonlinear},
          {"shared_mesh", plan.shared_mesh},
          {"cut_out", plan.cut_out},
          {"graded", plan.graded},
          {"subdivisions", plan.subdivisions},
          {"node_spacing_m", plan.spacing_m},
          {"tets", plan.tets},
          {"unknowns", plan.unknowns},
          {"columns", plan.columns},
          {"depths", plan.depths},
          {"nonlinear_depths", plan.nonlinear_depths},
          {"solved_at_least", plan.solved_at_least},
          {"solved_expected", plan.solved_expected},
          {"interpolated_expected", plan.interpolated_expected},
          {"cost", costs},
          {"seconds", plan.seconds},
          {"peak_memory_bytes", plan.peak_memory_bytes},
          {"plan_seconds", plan.plan_seconds},
          {"left_out", plan.left_out},
          {"notes", plan.notes}};
}

void print_meshes(const PlanReport& plan) {
  if (plan.shared_mesh) {
    fmt::print(
        "shared mesh   {} tets, {} unknowns, {} columns; surface subdivided {} times, "
        "contact nodes {:.3g} mm apart\n",
        plan.tets, plan.unknowns, plan.columns, plan.subdivisions,
        1e3 * plan.spacing_m);
  } else if (plan.cut_out) {
    fmt::print(
        "parts         cut out around groups of neighbours, about {} tets, {} unknowns "
        "each; contact nodes {:.3g} mm apart\n",
        plan.tets, plan.unknowns, 1e3 * plan.spacing_m);
  } else {
    fmt::print(
        "own meshes    of groups of neighbours, about {} tets, {} unknowns each; "
        "contact nodes {:.3g} mm apart at the finest\n",
        plan.tets, plan.unknowns, 1e3 * plan.spacing_m);
  }
  fmt::print("presses       {}{}\n",
             plan.nonlinear ? "linear, then nonlinear" : "linear",
             plan.graded ? " on meshes graded to the contact" : "");
  fmt::print(
      "depths        {}{}\n", plan.depths,
      plan.nonlinear ? fmt::format(" ({} nonlinear)", plan.nonlinear_depths) : "");
}

void print_plan(const PlanReport& plan) {
  fmt::print("nodes         {} ({} reachable, {} held, {} outside reach), {} tools\n",
             plan.nodes, plan.reachable, plan.held, plan.outside_reach, plan.tools);
  print_meshes(plan);
  fmt::print("responses     {} solved at least, about {}; about {} interpolated\n",
             plan.solved_at_least, plan.solved_expected, plan.interpolated_expected);
  fmt::print("units         {} ({} of them checks)\n", plan.units, plan.checks);
  for (const PlanCost& cost : plan.cost) {
    fmt::print("  {:8.2f} s  {} {}\n", cost.seconds, cost.count, cost.work);
  }
  fmt::print("time          {:.3g} s (planning took {:.1f} s)\n", plan.seconds,
             plan.plan_seconds);
  fmt::print("memory        {:.0f} MB\n",
             1e-6 * static_cast<double>(plan.peak_memory_bytes));
  for (const std::string& line : plan.left_out) {
    fmt::print("left out      {}\n", line);
  }
  for (const std::string& note : plan.notes) {
    fmt::print("note          {}\n", note);
  }
}

void run_plan(const PlanFlags& flags) {
  note_interrupts();
  const Scene scene = read_scene(flags.scene);
  Progress progress(stderr);
  const PlanReport report = plan(scene,
                                 {.solve_all = flags.solve_all,
                                  .workers = flags.workers,
                                  .repair = repair_mode(flags.repair)},
                                 progress);
  if (flags.json) {
    fmt::print("{}\n", json_text(plan_json(report)));
  } else {
    print_plan(report);
  }
}

}  // namespace

void add_plan_command(Command app) {
  Command command = app.add_subcommand(
      "plan", "Say what a build will compute and leave out, its time and memory");
  auto flags = std::make_shared<PlanFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  command.add_flag("--solve-all", flags->solve_all,
                   "Every node solved, none interpolated");
  command.add_option("--threads", flags->workers, "Threads; 0: one for each core")
      .in_range(0, 1024);
  command.add_option("--repair", flags->repair,
                     "off, safe or wrap: mend the body's surface first");
  command.add_flag("--json", flags->json, "Print the plan as one JSON object");
  command.callback([flags] {
    run_plan(*flags);
  });
}

}  // namespace palpate
