// palpate-db export: a database as VTU, CSV or JSON, or its pressure laws.
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/command/commands.h"
#include "formats/report/database_export.h"
#include "formats/report/pressure_export.h"

namespace palpate {
namespace {

struct ExportFlags {
  std::string file;
  std::string output;
  std::string tool;
  bool pressure_law = false;
  bool json = false;
};

using Export = std::string (*)(const ResponseDatabase&, const ResponseTable&);

Export export_of(const std::string& output, bool pressure_law) {
  const std::string extension = std::filesystem::path(output).extension().string();
  if (pressure_law) {
    if (extension == ".csv" || extension == ".json") {
      return extension == ".csv" ? pressure_csv : pressure_json;
    }
    throw InputError(
        fmt::format("{}: the extension is {:?}, must be .csv or .json of pressure laws",
                    output, extension));
  }
  if (extension == ".vtu") {
    return to_vtu;
  }
  if (extension == ".csv") {
    return to_csv;
  }
  if (extension == ".json") {
    return to_json_text;
  }
  throw InputError(fmt::format("{}: the extension is {:?}, must be .vtu, .csv or .json",
                               output, extension));
}

void run_export(const ExportFlags& flags) {
  const Export text_of = export_of(flags.output, flags.pressure_law);
  const ResponseDatabase database = read_database(flags.file);
  const std::string text = text_of(database, find_tool(database, flags.tool));
  AtomicFile file(flags.output);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
  if (flags.json) {
    const nlohmann::ordered_json report = {{"output", flags.output},
                                           {"nodes", database.body.position_m.rows()},
                                           {"bytes", text.size()}};
    fmt::print("{}\n", json_text(report));
  } else {
    fmt::print("wrote {}: {} nodes, {} bytes\n", flags.output,
               database.body.position_m.rows(), text.size());
  }
}

}  // namespace

void add_export_command(Command app) {
  Command command =
      app.add_subcommand("export", "Write a tool's responses as VTU, CSV or JSON");
  auto flags = std::make_shared<ExportFlags>();
  command.add_option("file", flags->file, "Response database (HDF5)").required();
  command.add_option("-o,--output", flags->output, "File to write: .vtu, .csv or .json")
      .required();
  command.add_option("--tool", flags->tool, "Tool, if there are several");
  command.add_flag(
      "--pressure-law", flags->pressure_law,
      "Write pressure by depth of a sphere's presses instead: .csv or .json");
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_export(*flags);
  });
}

}  // namespace palpate
