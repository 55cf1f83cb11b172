// runtime_bench: what the fast step, the slow process and wires cost, by hand; one
// subcommand per bench_*.h, and growing_walk.h.
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "formats/base/command_line.h"
#include "formats/hdf5/hdf5_lock.h"
#include "runtime/command/command_bench_allocations.h"
#include "runtime/realtime/stop_signals.h"
#include "runtime/run/render_run.h"
#include "tests/bench/runtime/bench_contacts.h"
#include "tests/bench/runtime/bench_device.h"
#include "tests/bench/runtime/bench_edges.h"
#include "tests/bench/runtime/bench_held.h"
#include "tests/bench/runtime/bench_potential.h"
#include "tests/bench/runtime/bench_search.h"
#include "tests/bench/runtime/bench_signs.h"
#include "tests/bench/runtime/bench_slide.h"
#include "tests/bench/runtime/bench_stream.h"
#include "tests/bench/runtime/growing_walk.h"

namespace palpate {
namespace {

// Which responses of which file, of flags that have both.
template <typename Flags>
void add_body(Command command, Flags& flags) {
  command.add_option("database", flags.database, "Response database (HDF5 or flat)")
      .required();
  command.add_option("--tool", flags.tool,
                     "of the database; may be left out if there is one");
}

// Rows as a table, or as JSON.
template <typename Rows>
void print_rows(const Rows& rows, bool json) {
  fmt::print("{}", json ? to_json(rows) + "\n" : table_text(rows));
}

void add_contacts(Command app) {
  struct Flags : ContactsBenchOptions {
    bool json = false;
  };
  Command command =
      app.add_subcommand("contacts", "time of a tick with 1 to 64 coupled contacts");
  auto flags = std::make_shared<Flags>();
  command.add_option("--ticks", flags->ticks, "of each walk, at 2 kHz")
      .show_default()
      .in_range(100, 100000000);
  command.add_flag("--facets", flags->facets, "the field over facets, to compare");
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const std::vector<ContactsBenchRow> rows =
        run_contacts_bench(*flags, allocations_so_far);
    print_rows(rows, flags->json);
  });
}

void add_potential(Command app) {
  struct Flags : PotentialBenchOptions {
    bool json = false;
  };
  Command command = app.add_subcommand(
      "potential",
      "what the ledger does for the element model and the potential field");
  auto flags = std::make_shared<Flags>();
  command.add_option("database", flags->database,
                     "Response database (HDF5 or flat) to walk too");
  command.add_option("--tool", flags->tool,
                     "of the database; may be left out if there is one");
  command.add_option("--ticks", flags->ticks, "of each walk, at 2 kHz")
      .show_default()
      .in_range(100, 100000000);
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const PotentialBenchReport report = run_potential_bench(*flags);
    print_rows(report, flags->json);
  });
}

void add_grow(Command app) {
  struct Flags : GrowingWalkOptions {
    std::string model_name = "potential";
    bool json = false;
  };
  Command command = app.add_subcommand(
      "grow", "a random walk over a database whose curves are exchanged on the way");
  auto flags = std::make_shared<Flags>();
  add_body(command, *flags);
  command.add_option("--ticks", flags->ticks, "at 2 kHz").show_default();
  command.add_option("--contrast", flags->contrast, "of forces between versions [-]")
      .show_default();
  command.add_option("--model", flags->model_name, "element or potential")
      .show_default();
  command.add_option("--seed", flags->seed, "of the walk").show_default();
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    flags->model = requested_model(flags->model_name);
    flags->stop = &stop_signals();
    const GrowingWalkReport report = run_growing_walk(*flags);
    print_rows(report, flags->json);
  });
}

void add_slide(Command app) {
  struct Flags : SlideBenchOptions {
    std::string model_name = "potential";
    bool json = false;
  };
  Command command = app.add_subcommand(
      "slide", "step time, energy and force error where proxies are measured");
  auto flags = std::make_shared<Flags>();
  command.add_option("--triangles", flags->triangles, "of the bodies")
      .separated_by(',')
      .show_default();
  command.add_option("--radius", flags->tool_radius_m, "of the tools [m]")
      .separated_by(',')
      .show_default();
  command.add_option("--friction", flags->friction, "coefficients [-]")
      .separated_by(',')
      .show_default();
  command.add_option("--rounds", flags->rounds, "of each path").show_default();
  command.add_option("--model", flags->model_name, "element or potential")
      .show_default();
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    flags->model = requested_model(flags->model_name);
    const std::vector<SlideBenchRow> rows = run_slide_bench(*flags);
    print_rows(rows, flags->json);
  });
}

void add_search(Command app) {
  struct Flags : SearchBenchOptions {
    bool json = false;
  };
  Command command =
      app.add_subcommand("search", "time to find the contact on large surfaces");
  auto flags = std::make_shared<Flags>();
  command.add_option("--triangles", flags->triangles, "of the surfaces")
      .separated_by(',')
      .show_default();
  command.add_option("--queries", flags->queries, "of each kind").show_default();
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const std::vector<SearchBenchRow> rows = run_search_bench(*flags);
    print_rows(rows, flags->json);
  });
}

void add_edges(Command app) {
  struct Flags {
    std::filesystem::path database;
    std::string tool;
    bool json = false;
  };
  Command command = app.add_subcommand(
      "edges", "steps of the force where the tool crosses an edge of the surface");
  auto flags = std::make_shared<Flags>();
  add_body(command, *flags);
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const ResponseDatabase database = read_database(flags->database);
    const std::vector<EdgesBenchRow> rows =
        run_edges_bench(database, find_tool(database, flags->tool));
    print_rows(rows, flags->json);
  });
}

void add_held(Command app) {
  struct Flags : HeldBenchOptions {
    std::filesystem::path database;
    std::string tool;
    bool json = false;
  };
  Command command = app.add_subcommand(
      "held", "what forces that are held for a tick give a hand, over K dx^2 / 2");
  auto flags = std::make_shared<Flags>();
  add_body(command, *flags);
  command.add_option("--edges", flags->edges, "at most, evenly among them")
      .in_range(1, 100000000);
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const ResponseDatabase database = read_database(flags->database);
    const std::vector<HeldBenchRow> rows =
        run_held_bench(database, find_tool(database, flags->tool), *flags);
    print_rows(rows, flags->json);
  });
}

void add_signs(Command app) {
  struct Flags : SignsBenchOptions {
    std::filesystem::path database;
    std::string tool;
  };
  Command command = app.add_subcommand(
      "signs",
      "hunts for places where the smooth field pulls, or its energy is below "
      "zero");
  auto flags = std::make_shared<Flags>();
  add_body(command, *flags);
  command.add_option("--places", flags->places, "of the body").show_default();
  command.add_option("--seed", flags->seed, "of the places").show_default();
  command
      .add_option("--discord", flags->discord,
                  "of the nodes' forces, by e^(+-discord); leans too")
      .show_default();
  command
      .add_option("--databases", flags->databases,
                  "of that surface, with curves, touches and tilts by chance")
      .show_default();
  command.callback([flags] {
    fmt::print("{}", table_text(run_signs_bench(read_database(flags->database),
                                                flags->tool, *flags)));
  });
}

void add_stream(Command app) {
  struct Flags : StreamBenchOptions {
    bool json = false;
    double budget_mib = 48.0;
  };
  Command command = app.add_subcommand(
      "stream", "memory and starved updates of a body that stays in its file");
  auto flags = std::make_shared<Flags>();
  command.add_option("--nodes", flags->nodes, "of the generated body").show_default();
  command.add_option("--database", flags->database,
                     "a file that --keep left, instead of generating one");
  command.add_flag("--keep", flags->keep,
                   "leave the generated file in the present folder");
  command.add_option("--seconds", flags->seconds, "of each run [s]").show_default();
  command.add_option("--speed", flags->speed_m_per_s, "of the tool [m/s]")
      .show_default();
  command.add_option("--budget", flags->budget_mib, "of responses in memory [MiB]")
      .show_default()
      .in_range(0.001, 1e6);
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    flags->budget_bytes =
        static_cast<std::size_t>(flags->budget_mib * static_cast<double>(kMebibyte));
    const StreamBenchReport report = run_stream_bench(*flags);
    print_rows(report, flags->json);
  });
}

void add_device(Command app) {
  struct Flags : DeviceBenchOptions {
    bool json = false;
  };
  Command command = app.add_subcommand(
      "device",
      "the renderer on an emulated device: transactions, and energy by its motors");
  auto flags = std::make_shared<Flags>();
  // A driver's process is the tool beside this program.
  flags->driver_program =
      std::filesystem::read_symlink("/proc/self/exe").replace_filename("palpate-run");
  command
      .add_option("--device", flags->device,
                  "emulated-falcon, -haply, -inverse or -inverse3")
      .show_default();
  command.add_option("--seconds", flags->duration_s, "of the run [s]").show_default();
  command.add_option("--fast-hz", flags->fast_hz, "rate of the fast step [Hz]")
      .show_default();
  command.add_option("--stiffness", flags->stiffness_n_per_m, "of the cylinder [N/m]")
      .show_default();
  command.add_option("--friction", flags->friction, "Coulomb coefficient [-]")
      .show_default();
  command.add_flag("--event-character", flags->event_character,
                   "the chip sends a reply at its last byte");
  command.add_flag("--json", flags->json, "one JSON object on stdout");
  command.callback([flags] {
    const DeviceBenchReport report = run_device_bench(*flags);
    print_rows(report, flags->json);
  });
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  skip_hdf5_exit_cleanup();
  return run_tool("runtime_bench", "Measures the runtime.",
                  {&add_contacts, &add_potential, &add_edges, &add_held, &add_signs,
                   &add_grow, &add_slide, &add_search, &add_stream, &add_device},
                  argc, argv);
}
