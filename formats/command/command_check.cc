#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/base/printable.h"
#include "formats/command/commands.h"
#include "formats/database/database_summary.h"
#include "formats/database/response_database.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct CheckFlags {
  std::string file;
  bool json = false;
};

void print_json(const Json& report) {
  fmt::print("{}\n", json_text(report));
}

void run_check(const CheckFlags& flags) {
  try {
    const ResponseDatabase database = read_in_file_order(flags.file);
    std::int64_t responses = 0;
    std::int64_t falling = 0;
    std::vector<std::string> notes;
    for (const ResponseTable& table : database.tools) {
      const ToolSummary summary = summarise(table);
      responses += summary.responses;
      falling += summary.falling;
      if (const std::string doubts = doubts_of_puncture(summary); !doubts.empty()) {
        notes.push_back(fmt::format("tool {}: {}", table.tool.name, doubts));
      }
    }
    if (flags.json) {
      print_json({{"ok", true},
                  {"nodes", database.body.position_m.rows()},
                  {"responses", responses},
                  {"falling", falling},
                  {"notes", notes}});
    } else {
      fmt::print("ok: {} nodes, {} tools, {} responses ({} falling)\n",
                 database.body.position_m.rows(), database.tools.size(), responses,
                 falling);
    }
    for (const std::string& note : notes) {
      fmt::print(stderr, "palpate-db: warning: {}\n", printable(note));
    }
  } catch (const FormatError& error) {
    if (flags.json) {
      print_json({{"ok", false}, {"violation", error.what()}});
    }
    throw;
  }
}

}  // namespace

void add_check_command(Command app) {
  Command command = app.add_subcommand(
      "check", "Verify a response database: format, digest, physics of every curve");
  auto flags = std::make_shared<CheckFlags>();
  command.add_option("file", flags->file, "Response database (HDF5 or flat)")
      .required();
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_check(*flags);
  });
}

}  // namespace palpate
