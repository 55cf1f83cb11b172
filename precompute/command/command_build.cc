#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/command_line.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/base/quantile.h"
#include "formats/database/error_calibration.h"
#include "precompute/build/build.h"
#include "precompute/command/commands.h"
#include "precompute/process/interrupt.h"
#include "precompute/process/supervised_build.h"

namespace palpate {
namespace {

struct BuildFlags {
  std::string scene;
  std::string output;
  std::string shard;
  std::string repair = "off";
  std::string precision;
  int workers = 0;
  double patience_s = BuildOptions{}.patience_s;
  bool resume = false;
  bool solve_all = false;
  bool strict = false;
  bool json = false;
};

bool misses_budget(const Assembly& assembly, double budget) {
  return assembly.over_budget > 0 || assembly.failed > 0 || assembly.truncated > 0 ||
         quantile(assembly.checked, 1.0) > budget;
}

nlohmann::ordered_json report_json(const BuildReport& report) {
  const Assembly& all = report.assembly;
  return {{"nodes", report.nodes},
          {"tets", report.tets},
          {"solved", all.solved},
          {"interpolated", all.interpolated},
          {"failed", all.failed},
          {"truncated", all.truncated},
          {"ended_at_support", all.ended_at_support},
          {"precision", name_of(all.database.storage.precision)},
          {"seconds", report.seconds},
          {"peak_memory_bytes", report.peak_memory_bytes},
          {"unknowns", report.unknowns},
          {"untouched", all.untouched},
          {"outside_reach", all.outside_reach},
          {"over_budget", all.over_budget},
          {"reaching_elsewhere", all.reaching_elsewhere},
          {"tilts_limited", all.tilts_limited},
          {"error_median", quantile(all.error, 0.5)},
          {"error_p95", quantile(all.error, 0.95)},
          {"checked", all.checked},
          {"error_factor", all.error_factor},
          {"hard_error_factor", all.hard_error_factor},
          {"error_covered", all.error_covered},
          {"hard_error_covered", all.hard_error_covered},
          {"checked_in_vain", all.checked_in_vain},
          {"near_singular", all.near_singular},
          {"units", report.units},
          {"resumed", report.resumed},
          {"node_spacing_m", report.node_spacing_m},
          {"min_dihedral_deg", report.min_dihedral_deg},
          {"failures", all.failures},
          {"notes", report.notes}};
}

void print_failures(const std::vector<std::string>& failures) {
  constexpr std::size_t kShown = 5;
  for (std::size_t i = 0; i < std::min(kShown, failures.size()); ++i) {
    fmt::print("failed        {}\n", failures[i]);
  }
  if (failures.size() > kShown) {
    fmt::print("              and {} more (--json lists them)\n",
               failures.size() - kShown);
  }
}

// What estimates were multiplied by, and what says so.
void print_coverage(const Assembly& all) {
  if (all.near_singular > 0) {
    fmt::print(
        "              {:.2g} times estimates where the path was hard to follow, so "
        "that it holds at {:.0f} % of these\n",
        all.hard_error_factor, 100 * all.hard_error_covered);
  }
  if (all.checked.empty()) {
    fmt::print(
        "              {:.2g} times estimates, meant to hold at {:.0f} % of places; "
        "nothing was checked (accuracy.verify)\n",
        all.error_factor, 100 * kErrorCoverage);
  } else {
    fmt::print(
        "              {:.2g} times estimates, so that it holds at {:.0f} % of "
        "places:\n"
        "checked       {} places of the surface, solved better; they differ by "
        "{:.1f} % in the median, {:.1f} % at most\n",
        all.error_factor, 100 * all.error_covered, all.checked.size(),
        100 * quantile(all.checked, 0.5), 100 * quantile(all.checked, 1.0));
  }
  for (const ResponseTable& table : all.database.tools) {
    const AccuracyRecord& accuracy = table.accuracy;
    for (std::size_t i = 0; i < accuracy.depth_share.size(); ++i) {
      fmt::print(
          "              tool {}: 95 % of places within {:.1f} % from {:.2g} mm on\n",
          table.tool.name, 100 * accuracy.covering_relative[i],
          1e3 * accuracy.depth_share[i] * table.depth_max_m());
    }
  }
  if (all.checked_in_vain > 0) {
    fmt::print(
        "warning       {} more checks failed: nobody knows how far off these places "
        "are\n",
        all.checked_in_vain);
  }
}

void print_errors(const Assembly& all, double budget) {
  fmt::print("force error   {:.1f} % median, {:.1f} % at the 95th percentile\n",
             100 * quantile(all.error, 0.5), 100 * quantile(all.error, 0.95));
  print_coverage(all);
  print_failures(all.failures);
  if (all.over_budget > 0) {
    fmt::print("warning       {} of {} responses may miss the budget of {} %\n",
               all.over_budget, all.solved + all.interpolated, 100 * budget);
    const bool between =
        std::any_of(all.database.tools.begin(), all.database.tools.end(),
                    [](const ResponseTable& table) {
                      return table.accuracy.between_nodes > 0;
                    });
    if (between && all.error_factor > 2.0 * kLeastErrorFactor) {
      fmt::print(
          "              most of it lies between the nodes, where the tool comes to "
          "flat triangles: a surface with shorter edges has less\n");
    }
  }
  if (all.near_singular > 0) {
    fmt::print(
        "warning       {} presses were hard to follow: other equilibria may lie near\n",
        all.near_singular);
  }
  if (all.ended_at_support > 0) {
    fmt::print(
        "note          {} curves end early: there the tool meets a held part of the "
        "body\n",
        all.ended_at_support);
  }
  if (all.tilts_limited > 0) {
    fmt::print(
        "note          {:.1f} % of the forces lean by more than 45 degrees, or turn "
        "with "
        "depth too fast for their triangles: limited, and the rest is in their error\n",
        100.0 * static_cast<double>(all.tilts_limited) /
            static_cast<double>(all.error.size()));
  }
  if (all.reaching_elsewhere > 0) {
    fmt::print(
        "warning       at {} nodes the tool also reaches into another part of the body "
        "(a fold, a step, a held face): that contact is not in their force\n",
        all.reaching_elsewhere);
  }
  const auto outside =
      std::count_if(all.checked.begin(), all.checked.end(), [&](double error) {
        return error > budget;
      });
  if (outside > 0) {
    fmt::print("warning       {} of {} checked places are outside the budget of {} %\n",
               outside, all.checked.size(), 100 * budget);
  }
}

void print_report(const BuildReport& report, const BuildFlags& flags, double budget) {
  const Assembly& all = report.assembly;
  fmt::print("wrote {} as {}\n", flags.output, name_of(all.database.storage.precision));
  fmt::print(
      "nodes         {} ({} solved, {} interpolated, {} outside reach, {} untouched, "
      "{} "
      "failed)\n",
      report.nodes, all.solved, all.interpolated, all.outside_reach, all.untouched,
      all.failed);
  if (report.tets > 0) {
    fmt::print("tetrahedra    {} ({} unknowns, smallest dihedral angle {:.1f} deg)\n",
               report.tets, report.unknowns, report.min_dihedral_deg);
    fmt::print("node spacing  {:.3g} mm in the contact\n", 1e3 * report.node_spacing_m);
  }
  print_errors(all, budget);
  fmt::print("time          {:.1f} s\n", report.seconds);
  fmt::print("peak memory   {:.0f} MB\n",
             1e-6 * static_cast<double>(report.peak_memory_bytes));
  for (const std::string& note : report.notes) {
    fmt::print("note          {}\n", note);
  }
}

// "i/n", counted from 0.
void parse_shard(const std::string& text, BuildOptions& options) {
  if (text.empty()) {
    return;
  }
  int shard = 0;
  int shards = 0;
  char slash = 0;
  std::istringstream in(text);
  if (!(in >> shard >> slash >> shards) || slash != '/' || !in.eof() || shards < 1 ||
      shard < 0 || shard >= shards) {
    throw InputError(fmt::format(
        "--shard {:?}: i/n with 0 <= i < n is wanted, for example 0/4", text));
  }
  options.shard = shard;
  options.shards = shards;
}

void run_build(const BuildFlags& flags) {
  note_interrupts();
  const Scene scene = read_scene(flags.scene);
  BuildOptions options{.output = flags.output,
                       .resume = flags.resume,
                       .solve_all = flags.solve_all,
                       .repair = repair_mode(flags.repair),
                       .workers = flags.workers,
                       .patience_s = flags.patience_s};
  parse_shard(flags.shard, options);
  if (!flags.precision.empty()) {
    options.precision = precision_of(flags.precision);
  }
  Progress progress(stderr);
  const BuildReport report = build(scene, options, progress);
  if (flags.json) {
    fmt::print("{}\n", json_text(report_json(report)));
  } else if (options.shards > 1) {
    fmt::print("wrote {}: shard {} of {}, {} units\n", flags.output, options.shard,
               options.shards, report.units);
  } else {
    print_report(report, flags, scene.force_relative);
  }
  if (options.shards == 1 && report.assembly.failed + report.assembly.truncated > 0) {
    fmt::print(
        stderr,
        "palpate-precompute: warning: of {} nodes {} have no response and {} "
        "only a part of it; all others are in {}\n",
        report.assembly.solved + report.assembly.interpolated + report.assembly.failed,
        report.assembly.failed, report.assembly.truncated, flags.output);
  }
  if (flags.strict && options.shards == 1 &&
      misses_budget(report.assembly, scene.force_relative)) {
    throw NumericalError(fmt::format("the budget of {} % is missed: {}",
                                     100 * scene.force_relative,
                                     "see the report above"));
  }
}

}  // namespace

void add_build_command(Command app) {
  Command command = app.add_subcommand(
      "build", "Compute the responses at every reachable node of a scene's body");
  auto flags = std::make_shared<BuildFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  command.add_option("-o,--output", flags->output, "Response database to write (HDF5)")
      .required();
  command.add_option("--shard", flags->shard,
                     "i/n: only every n-th unit of work, from the i-th on; `palpate-db "
                     "merge` puts shards together");
  command
      .add_option("--threads", flags->workers,
                  "Threads; 0: one for each core. The result does not depend on it")
      .in_range(0, 1024);
  command
      .add_option("--patience-s", flags->patience_s,
                  "Seconds to wait for memory, processes or room on the disk, and with "
                  "--resume for another build of OUTPUT; then exit code 75")
      .not_negative();
  command.add_option("--repair", flags->repair,
                     "off, safe or wrap: mend the body's surface first");
  command.add_option("--precision", flags->precision,
                     "float64, float32 or int16: how the database keeps depths and "
                     "forces; by default the cheapest whose error is under a tenth of "
                     "the accuracy budget");
  command.add_flag("--resume", flags->resume,
                   "Go on with what an earlier run left in OUTPUT.partial");
  command.add_flag("--solve-all", flags->solve_all,
                   "Solve every node, interpolate none");
  command.add_flag("--strict", flags->strict,
                   "Fail where the accuracy budget is missed");
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    const int code = run_supervised([&](bool resume) {
      BuildFlags wanted = *flags;
      wanted.resume = wanted.resume || resume;
      return run_reporting("palpate-precompute", [&] {
        run_build(wanted);
        return 0;
      });
    });
    if (code != 0) {  // said by the child
      std::_Exit(code);
    }
  });
}

}  // namespace palpate
