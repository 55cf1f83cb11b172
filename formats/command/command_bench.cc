// palpate-db bench precision: what each way of storing a database costs.
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/command/commands.h"
#include "formats/database/precision_choice.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct BenchFlags {
  std::string file;
  double budget_relative = 0.0;
  bool json = false;
};

Json precision_json(const RelativeError& error) {
  return {{"largest", error.largest}, {"rms", error.rms}};
}

Json precision_json(const PrecisionRow& row) {
  return {{"precision", name_of(row.storage.precision)},
          {"compressed", row.storage.compress},
          {"possible", row.possible},
          {"bytes", row.bytes},
          {"load_s", row.load_s},
          {"evaluate_s", row.evaluate_s},
          {"force", precision_json(row.force)},
          {"stiffness", precision_json(row.stiffness)},
          {"energy", precision_json(row.energy)}};
}

void print_row(const PrecisionRow& row) {
  const std::string name = fmt::format("{}{}", name_of(row.storage.precision),
                                       row.storage.compress ? " deflate" : "");
  if (!row.possible) {
    fmt::print("{:<16} cannot tell depths apart\n", name);
    return;
  }
  fmt::print(
      "{:<16} {:>12} {:>10.2f} {:>8.1f}   {:>8.1e} {:>8.1e}   {:>8.1e} {:>8.1e}   "
      "{:>8.1e} {:>8.1e}\n",
      name, row.bytes, 1e3 * row.load_s, 1e9 * row.evaluate_s, row.force.largest,
      row.force.rms, row.stiffness.largest, row.stiffness.rms, row.energy.largest,
      row.energy.rms);
}

void run_bench(const BenchFlags& flags) {
  const ResponseDatabase database = read_database(flags.file);
  const double budget =
      flags.budget_relative > 0.0 ? flags.budget_relative : budget_relative(database);
  const std::string choice = name_of(cheapest_precision(database, budget));
  const std::vector<PrecisionRow> rows = measure_precisions(database);
  if (flags.json) {
    Json report = {{"stored", name_of(database.storage.precision)},
                   {"budget_relative", budget},
                   {"cheapest", choice},
                   {"rows", Json::array()}};
    for (const PrecisionRow& row : rows) {
      report["rows"].push_back(precision_json(row));
    }
    fmt::print("{}\n", json_text(report));
    return;
  }
  fmt::print("errors against {}, relative to the curve's largest\n",
             name_of(database.storage.precision));
  fmt::print("{:<16} {:>12} {:>10} {:>8}   {:>17}   {:>17}   {:>17}\n", "", "bytes",
             "load ms", "eval ns", "force max, rms", "slope max, rms",
             "energy max, rms");
  for (const PrecisionRow& row : rows) {
    print_row(row);
  }
  fmt::print("cheapest under a tenth of the budget {}: {}\n", budget, choice);
}

}  // namespace

void add_bench_command(Command app) {
  Command command = app.add_subcommand("bench", "Measure");
  command.require_subcommand();
  Command precision = command.add_subcommand(
      "precision", "Size, time and error of every way to store a database");
  auto flags = std::make_shared<BenchFlags>();
  precision.add_option("file", flags->file, "Response database (HDF5 or flat)")
      .required();
  precision
      .add_option(
          "--budget", flags->budget_relative,
          "Relative force error allowed; else what the database states, or 0.07")
      .positive();
  precision.add_flag("--json", flags->json, "Print the report as one JSON object");
  precision.callback([flags] {
    run_bench(*flags);
  });
}

}  // namespace palpate
