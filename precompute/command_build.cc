#include "precompute/command_build.h"

#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/atomic_file.h"
#include "precompute/build.h"
#include "precompute/interrupt.h"

namespace palpate {
namespace {

struct Flags {
  std::string scene;
  std::string output;
  bool json = false;
};

nlohmann::ordered_json to_json(const BuildReport& report) {
  return {{"nodes", report.nodes},
          {"tets", report.tets},
          {"solved", report.solved},
          {"interpolated", report.interpolated},
          {"failed", report.failed},
          {"seconds", report.seconds},
          {"peak_memory_bytes", report.peak_memory_bytes},
          {"unknowns", report.unknowns},
          {"untouched", report.untouched},
          {"outside_reach", report.outside_reach},
          {"over_budget", report.over_budget},
          {"error_median", report.error_median},
          {"error_p95", report.error_p95},
          {"node_spacing_m", report.node_spacing_m},
          {"min_dihedral_deg", report.min_dihedral_deg},
          {"notes", report.notes}};
}

void print(const BuildReport& report, const Flags& flags) {
  fmt::print("wrote {}\n", flags.output);
  fmt::print(
      "nodes         {} ({} solved, {} outside reach, {} untouched, {} failed)\n",
      report.nodes, report.solved, report.outside_reach, report.untouched,
      report.failed);
  fmt::print("tetrahedra    {} ({} unknowns, smallest dihedral angle {:.1f} deg)\n",
             report.tets, report.unknowns, report.min_dihedral_deg);
  fmt::print("node spacing  {:.3g} mm in the contact\n", 1e3 * report.node_spacing_m);
  fmt::print(
      "force error   {:.1f} % median, {:.1f} % at the 95th percentile (estimate)\n",
      100 * report.error_median, 100 * report.error_p95);
  fmt::print("time          {:.1f} s\n", report.seconds);
  fmt::print("peak memory   {:.0f} MB\n",
             1e-6 * static_cast<double>(report.peak_memory_bytes));
  for (const std::string& note : report.notes) {
    fmt::print("note          {}\n", note);
  }
  if (report.over_budget > 0) {
    fmt::print(
        "warning       {} of {} responses are estimated outside the accuracy budget\n",
        report.over_budget, report.solved);
  }
}

void run(const Flags& flags) {
  note_interrupts();
  const Scene scene = read_scene(flags.scene);

  { const AtomicFile place(flags.output); }  // said before the work, not after it
  Progress progress(stderr);
  BuildReport report;
  const ResponseDatabase database = build_database(scene, progress, report);
  write_database(flags.output, database);
  if (flags.json) {
    fmt::print("{}\n", to_json(report).dump());
  } else {
    print(report, flags);
  }
}

}  // namespace

void add_build_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "build", "Compute the responses at every reachable node of a scene's body");
  auto flags = std::make_shared<Flags>();
  command->add_option("scene", flags->scene, "Scene file (TOML)")->required();
  command->add_option("-o,--output", flags->output, "Response database to write (HDF5)")
      ->required();
  command->add_flag("--json", flags->json, "Print the report as one JSON object");
  command->callback([flags] {
    run(*flags);
  });
}

}  // namespace palpate
