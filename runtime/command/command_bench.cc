#include <filesystem>
#include <memory>
#include <span>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "runtime/bench/bench_fidelity.h"
#include "runtime/bench/bench_rate_trade.h"
#include "runtime/bench/bench_step.h"
#include "runtime/bench/bench_table1.h"
#include "runtime/bench/bench_walk.h"
#include "runtime/bench/rate_trade_page.h"
#include "runtime/command/command_bench_allocations.h"
#include "runtime/command/commands.h"
#include "runtime/realtime/stop_signals.h"
#include "runtime/run/render_run.h"

namespace palpate {
namespace {

struct OutputFlags {
  bool json = false;
  bool csv = false;
};

void add_table1(Command bench) {
  struct Flags : OutputFlags {
    Table1Options options;
    std::string wall = "nonlinear";
  };
  Command command = bench.add_subcommand(
      "table1", "largest stable stiffness by slow rate and local model");
  auto flags = std::make_shared<Flags>();
  command
      .add_option("--preload", flags->options.preload_n,
                  "into the wall [N]; 0.1 leans on its nonlinear part")
      .show_default()
      .in_range(0.001, 100.0);
  command.add_option("--wall", flags->wall, "linear, or the paper's nonlinear one")
      .show_default()
      .one_of({"linear", "nonlinear"});
  command
      .add_option("--relaxing", flags->options.relaxation.share,
                  "shares of the wall's force that relax, of a sudden press")
      .in_range(0.0, 1.0);
  command
      .add_option("--times", flags->options.relaxation.time_s,
                  "in which they do [s], rising")
      .in_range(1e-6, 1e6);
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.add_flag("--csv", flags->csv, "comma-separated values on stdout");
  command.callback([flags] {
    flags->options.wall =
        flags->wall == "linear" ? WallShape::kLinear : WallShape::kNonlinear;
    const Table1Report report = run_table1(flags->options);
    fmt::print("{}", flags->json  ? to_json(report) + "\n"
                     : flags->csv ? table_csv(report)
                                  : table_text(report));
  });
}

void add_fidelity(Command bench) {
  Command command = bench.add_subcommand(
      "fidelity", "force error and energy of pokes by local model");
  auto flags = std::make_shared<OutputFlags>();
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const std::vector<FidelityRow> rows = run_fidelity({});
    fmt::print("{}", flags->json ? to_json(rows) + "\n" : table_text(rows));
  });
}

void add_step(Command bench) {
  Command command =
      bench.add_subcommand("step", "time and allocations of the fast step by model");
  auto flags = std::make_shared<OutputFlags>();
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const std::vector<StepBenchRow> rows = run_step_bench({}, allocations_so_far);
    fmt::print("{}", flags->json ? to_json(rows) + "\n" : table_text(rows));
  });
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

void add_trade(Command bench) {
  struct Flags : OutputFlags {
    RateTradeOptions options;
    std::filesystem::path picture;
    std::filesystem::path page;
  };
  Command command = bench.add_subcommand(
      "trade", "stiffness, error, energy and processor time by rates and local model");
  auto flags = std::make_shared<Flags>();
  command.add_option("--fast", flags->options.fast_hz, "fast rates [Hz]")
      .separated_by(',')
      .show_default();
  command
      .add_option("--slow", flags->options.slow_hz,
                  "slow rates [Hz]; those that divide the fast one")
      .separated_by(',')
      .show_default();
  command.add_option("--preload", flags->options.preload_n, "into the wall [N]")
      .show_default()
      .in_range(0.001, 100.0);
  command.add_option("--picture", flags->picture,
                     "SVG to write: stiffness by slow rate");
  command.add_option("--page", flags->page,
                     "HTML to write: all of it by slow rate, to choose from");
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.add_flag("--csv", flags->csv, "comma-separated values on stdout");
  command.callback([flags] {
    const std::vector<RateTradeRow> rows = run_trade(flags->options);
    if (!flags->picture.empty()) {
      write_text(flags->picture, trade_picture(rows, WallShape::kNonlinear));
    }
    if (!flags->page.empty()) {
      write_text(flags->page, trade_page(rows));
    }
    fmt::print("{}", flags->json  ? to_json(rows) + "\n"
                     : flags->csv ? table_csv(rows)
                                  : table_text(rows));
  });
}

void add_walk(Command bench) {
  struct Flags : WalkBenchOptions {
    std::string model_name = "potential";
    bool json = false;
  };
  Command command = bench.add_subcommand(
      "walk", "a long random walk over a database, under everything that can go wrong");
  auto flags = std::make_shared<Flags>();
  command.add_option("database", flags->database, "Response database (HDF5 or flat)")
      .required();
  command.add_option("--tool", flags->tool,
                     "of the database; may be left out if there is one");
  command.add_option("--ticks", flags->ticks, "at 2 kHz").show_default();
  command.add_option("--model", flags->model_name, known_models()).show_default();
  command.add_option("--seed", flags->seed, "of the walk").show_default();
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    flags->model = requested_model(flags->model_name);
    flags->stop = &stop_signals();
    const WalkBenchReport report = run_walk_bench(*flags);
    fmt::print("{}", flags->json ? to_json(report) + "\n" : table_text(report));
  });
}

}  // namespace

void add_bench_command(Command app) {
  Command command = app.add_subcommand("bench", "measures the fast step");
  command.require_subcommand();
  add_table1(command);
  add_fidelity(command);
  add_step(command);
  add_trade(command);
  add_walk(command);
}

}  // namespace palpate
