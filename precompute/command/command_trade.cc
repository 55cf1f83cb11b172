// palpate-precompute trade: what accuracy costs on a scene.
#include <cstdio>
#include <memory>
#include <span>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/atomic_file.h"
#include "formats/base/json_text.h"
#include "precompute/build/accuracy_trade.h"
#include "precompute/command/commands.h"
#include "precompute/press/scene_solver.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

struct TradeFlags {
  std::string scene;
  std::string output;
  AccuracyTradeOptions options;
  std::string repair = "off";
  bool json = false;
};

nlohmann::ordered_json trade_json(const TradeReport& report) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const AccuracyTradeRow& row : report.row) {
    rows.push_back({{"contact_resolution", row.resolution},
                    {"method", row.nonlinear ? "nonlinear" : "linear"},
                    {"solve", row.interpolated ? "interpolated" : "all"},
                    {"depths", row.depths},
                    {"compared", row.compared},
                    {"error_rms", row.error_rms},
                    {"error_largest", row.error_largest},
                    {"cpu_seconds", row.cpu_seconds},
                    {"peak_memory_bytes", row.peak_memory_bytes},
                    {"response_bytes", row.response_bytes},
                    {"pareto", row.pareto}});
  }
  return {{"nodes", report.reachable},
          {"vertices", report.vertex},
          {"reference_resolution", report.reference_resolution},
          {"reference_depths", report.reference_depths},
          {"budget_resolution", report.budget_resolution},
          {"force_relative", report.force_relative},
          {"rows", rows},
          {"notes", report.notes}};
}

void print_trade(const TradeReport& report) {
  fmt::print(
      "{} reachable nodes; {} of them pressed in every way, compared with resolution "
      "{:.3g}, every depth of {}\n",
      report.reachable, report.vertex.size(), report.reference_resolution,
      report.reference_depths);
  fmt::print("{:>10} {:>9} {:>12} {:>6} {:>8} {:>8} {:>11} {:>9} {:>9} {:>9}\n",
             "resolution", "method", "solve", "depths", "rms [%]", "max [%]",
             "CPU s, all", "s / node", "mem [MB]", "file [kB]");
  for (const AccuracyTradeRow& row : report.row) {
    fmt::print(
        "{:>10.3g} {:>9} {:>12} {:>6} {:>8.2f} {:>8.2f} {:>11.4g} {:>9.3g} {:>9.0f} "
        "{:>9.0f}{}\n",
        row.resolution, row.nonlinear ? "nonlinear" : "linear",
        row.interpolated ? "interpolated" : "all", row.depths, 100 * row.error_rms,
        100 * row.error_largest, row.cpu_seconds,
        row.cpu_seconds / static_cast<double>(report.reachable),
        1e-6 * static_cast<double>(row.peak_memory_bytes),
        1e-3 * static_cast<double>(row.response_bytes), row.pareto ? "  *" : "");
  }
  fmt::print("* no other way is both cheaper and more exact\n");
  fmt::print("the scene's budget of {:.3g} % leads to resolution {:.3g}\n",
             100 * report.force_relative, report.budget_resolution);
  for (const std::string& note : report.notes) {
    fmt::print("note: {}\n", note);
  }
}

void write_text(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

void run_trade(const TradeFlags& flags) {
  note_interrupts();
  const Scene scene = read_scene(flags.scene);
  require_whole_body(scene, "trade");
  { const AtomicFile place(flags.output + ".csv"); }  // said before the work
  Progress progress(stderr);
  AccuracyTradeOptions options = flags.options;
  options.repair = repair_mode(flags.repair);
  const TradeReport report = trade(scene, options, progress);
  write_text(flags.output + ".csv", trade_csv(report));
  write_text(flags.output + ".svg", trade_picture(report));
  if (flags.json) {
    fmt::print("{}\n", json_text(trade_json(report)));
  } else {
    print_trade(report);
  }
}

}  // namespace

void add_trade_command(Command app) {
  Command command = app.add_subcommand(
      "trade", "Compute a scene's responses in many ways: error beside cost");
  auto flags = std::make_shared<TradeFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  command
      .add_option("-o,--output", flags->output,
                  "Where to write: PREFIX.csv and PREFIX.svg")
      .required();
  command.add_option("--repair", flags->repair,
                     "off, safe or wrap: mend the body's surface first");
  command
      .add_option("--samples", flags->options.samples,
                  "Vertices that are pressed in every way")
      .in_range(2, 1000)
      .show_default();
  command
      .add_option("--resolutions", flags->options.resolution,
                  "Elements that the radius of the contact spans, of each mesh")
      .in_range(0.5, 16.0)
      .separated_by(',')
      .show_default();
  command.add_option("--depths", flags->options.depths, "Samples of a curve")
      .in_range(2, 64)
      .separated_by(',')
      .show_default();
  command
      .add_option("--reference-finer", flags->options.reference_finer,
                  "The reference's resolution over the largest of the others")
      .in_range(1.0, 8.0)
      .show_default();
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_trade(*flags);
  });
}

}  // namespace palpate
