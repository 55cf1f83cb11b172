// palpate-db report: a database as a page for a browser.
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/atomic_file.h"
#include "formats/base/json_text.h"
#include "formats/command/commands.h"
#include "formats/report/database_page.h"

namespace palpate {
namespace {

struct ReportFlags {
  std::string file;
  std::string output;
  std::int64_t nodes = kReportNodes;
  bool json = false;
};

void run_report(const ReportFlags& flags) {
  const ResponseDatabase database = read_database(flags.file);
  const std::string page = report_page(
      database, std::filesystem::path(flags.file).filename().string(), flags.nodes);
  AtomicFile atomic(flags.output);
  atomic.write(std::as_bytes(std::span(page)));
  atomic.commit();
  if (flags.json) {
    fmt::print("{}\n", json_text(nlohmann::ordered_json{{"output", flags.output},
                                                        {"bytes", page.size()}}));
  } else {
    fmt::print("wrote {} ({} bytes)\n", flags.output, page.size());
  }
}

}  // namespace

void add_report_command(Command app) {
  Command command = app.add_subcommand(
      "report", "Write a page for a browser: turnable body, curves, provenance");
  auto flags = std::make_shared<ReportFlags>();
  command.add_option("file", flags->file, "Response database (HDF5 or flat)")
      .required();
  command.add_option("-o,--output", flags->output, "Page to write (HTML)").required();
  command
      .add_option("--nodes", flags->nodes,
                  "Nodes to show at most, over all tools; a larger body is thinned")
      .in_range(std::int64_t{100}, std::int64_t{1000000})
      .show_default();
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_report(*flags);
  });
}

}  // namespace palpate
