// palpate-db export: a database as VTU, CSV or JSON, its pressure laws, the taxels
// under its tool, the whole of it in the other form, flat or HDF5, or a page that
// presses it.
#include <charconv>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/json_text.h"
#include "formats/command/commands.h"
#include "formats/report/database_export.h"
#include "formats/report/page_export.h"
#include "formats/report/pressure_export.h"
#include "formats/report/taxel_export.h"

namespace palpate {
namespace {

struct ExportFlags {
  std::string file;
  std::string output;
  std::string flat;
  std::string hdf5;
  std::string page;
  std::string module;
  std::vector<std::string> tools;
  std::vector<int> inverse_ports{InversePorts{}.states, InversePorts{}.events};
  bool pressure_law = false;
  std::string taxels;  // "16x16": columns, rows
  double pitch_m = 0.001;
  std::vector<double> at_m;
  double depth_m = 0.0;
  bool json = false;
};

using Export =
    std::function<std::string(const ResponseDatabase&, const ResponseTable&)>;

TaxelGrid grid_of(const ExportFlags& flags) {
  TaxelGrid grid{.rows = 0, .columns = 0, .pitch_m = flags.pitch_m};
  const char* const end = flags.taxels.data() + flags.taxels.size();
  const auto columns = std::from_chars(flags.taxels.data(), end, grid.columns);
  if (columns.ec == std::errc() && columns.ptr != end && *columns.ptr == 'x') {
    const auto rows = std::from_chars(columns.ptr + 1, end, grid.rows);
    if (rows.ec == std::errc() && rows.ptr == end) {
      return grid;
    }
  }
  throw InputError(
      fmt::format("--taxels is {:?}, must be COLUMNSxROWS: \"16x16\"", flags.taxels));
}

// Under the tool where it is pressed.
Export taxels_of(const ExportFlags& flags, const std::string& extension) {
  const TaxelGrid grid = grid_of(flags);
  if (flags.at_m.empty()) {
    throw InputError("--taxels needs --at x,y,z: where the tool is pressed");
  }
  if (flags.pressure_law) {
    throw InputError("--taxels and --pressure-law exclude each other");
  }
  if (extension != ".csv" && extension != ".json") {
    throw InputError(
        fmt::format("{}: the extension is {:?}, must be .csv or .json of taxels",
                    flags.output, extension));
  }
  return [flags, grid, extension](const ResponseDatabase& database,
                                  const ResponseTable& table) {
    const SurfaceSearch search(database.body);
    const double depth_m = flags.depth_m > 0.0 ? flags.depth_m : table.depth_max_m();
    const Taxels taxels =
        taxels_at(database.body, database.normal, search, table,
                  pressed_position_m(database.body, database.normal, search, table.tool,
                                     Eigen::Vector3d(flags.at_m.data()), depth_m),
                  grid);
    return extension == ".csv" ? taxel_csv(taxels, grid) : taxel_json(taxels, grid);
  };
}

Export export_of(const ExportFlags& flags) {
  const std::string& output = flags.output;
  const std::string extension = std::filesystem::path(output).extension().string();
  if (!flags.taxels.empty() || !flags.at_m.empty()) {
    return taxels_of(flags, extension);
  }
  if (flags.pressure_law) {
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

void print_export(const std::string& output, const ResponseDatabase& database,
                  bool json) {
  const std::uintmax_t bytes = std::filesystem::file_size(output);
  const auto nodes = database.body.position_m.rows();
  if (json) {
    const nlohmann::ordered_json report = {
        {"output", output}, {"nodes", nodes}, {"bytes", bytes}};
    fmt::print("{}\n", json_text(report));
  } else {
    fmt::print("wrote {}: {} nodes, {} bytes\n", output, nodes, bytes);
  }
}

void write_text(const std::string& output, std::string_view text) {
  AtomicFile file(output);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

// The whole database, all tools.
void run_form(const ExportFlags& flags) {
  if (!flags.output.empty() || !flags.page.empty() || !flags.tools.empty() ||
      flags.pressure_law || !flags.taxels.empty() ||
      (!flags.flat.empty() && !flags.hdf5.empty())) {
    throw InputError(
        "--flat and --hdf5 write the whole database: each goes without the other, "
        "--output, --page, --tool, --pressure-law and --taxels");
  }
  const bool flat = !flags.flat.empty();
  const std::string& output = flat ? flags.flat : flags.hdf5;
  const ResponseDatabase database = read_database(flags.file);
  write_database(output, database, flat ? StoredForm::kFlat : StoredForm::kHdf5);
  print_export(output, database, flags.json);
}

// The runtime that pages hold: named, or where it was built or installed.
std::string page_module(const ExportFlags& flags) {
  std::error_code none;
  const std::filesystem::path module =
      flags.module.empty()
          ? std::filesystem::read_symlink("/proc/self/exe", none).parent_path() /
                "../share/palpate/palpate.wasm"
          : std::filesystem::path(flags.module);
  if (!std::filesystem::exists(module, none)) {
    throw InputError(
        fmt::format("{}: is not there, a page holds it: build it by ./bootstrap page, "
                    "or name one by --module",
                    module.lexically_normal().string()));
  }
  return read_file(module);
}

void run_page(const ExportFlags& flags) {
  if (!flags.output.empty() || flags.pressure_law || !flags.taxels.empty()) {
    throw InputError(
        "--page writes a page: it goes without --output, --pressure-law and --taxels");
  }
  const std::string module = page_module(flags);
  const ResponseDatabase database = read_database(flags.file);
  const PageExport page =
      page_of(database, std::filesystem::path(flags.file).filename().string(),
              flags.tools, std::as_bytes(std::span(module)),
              {static_cast<std::uint16_t>(flags.inverse_ports[0]),
               static_cast<std::uint16_t>(flags.inverse_ports[1])});
  write_text(flags.page, page.html);
  if (!page.left_out.empty()) {
    fmt::print(stderr, "{}\n", page.left_out);
  }
  if (page.html.size() > kPageBytes) {
    fmt::print(stderr,
               "{}: has {} bytes, more than {}: write a part of the body, by "
               "palpate-db slice\n",
               flags.page, page.html.size(), kPageBytes);
  }
  print_export(flags.page, database, flags.json);
}

// The one that is named, if any.
std::string tool_of(const ExportFlags& flags) {
  if (flags.tools.size() > 1) {
    throw InputError(
        fmt::format("--tool names {} tools: one is written, pages of two "
                    "hands take two",
                    flags.tools.size()));
  }
  return flags.tools.empty() ? "" : flags.tools.front();
}

void run_export(const ExportFlags& flags) {
  if (!flags.page.empty() && flags.flat.empty() && flags.hdf5.empty()) {
    run_page(flags);
    return;
  }
  if (!flags.flat.empty() || !flags.hdf5.empty()) {
    run_form(flags);
    return;
  }
  if (flags.output.empty()) {
    throw InputError(
        "where to write must be named: --output, --flat, --hdf5 or --page FILE");
  }
  const Export text_of = export_of(flags);
  const ResponseDatabase database = read_database(flags.file);
  write_text(flags.output, text_of(database, find_tool(database, tool_of(flags))));
  print_export(flags.output, database, flags.json);
}

}  // namespace

void add_export_command(Command app) {
  Command command =
      app.add_subcommand("export", "Write a tool's responses as VTU, CSV or JSON");
  auto flags = std::make_shared<ExportFlags>();
  command.add_option("file", flags->file, "Response database (HDF5 or flat)")
      .required();
  command.add_option("-o,--output", flags->output,
                     "File to write: .vtu, .csv or .json");
  command.add_option("--flat", flags->flat,
                     "Write the whole database as a flat file instead: FLAT.md");
  command.add_option("--hdf5", flags->hdf5,
                     "Write the whole database as an HDF5 file instead");
  command.add_option("--page", flags->page,
                     "Write a page that presses the body instead, with all that it "
                     "needs in one file: PAGE.md");
  command.add_option(
      "--module", flags->module,
      "Of pages: their runtime, palpate.wasm; if not given, the one that "
      "was built or installed");
  command
      .add_option("--inverse-ports", flags->inverse_ports,
                  "Of pages: STATES,EVENTS of Haply's service at the reader's computer")
      .separated_by(',')
      .values(2)
      .in_range(1, 65535)
      .show_default();
  command
      .add_option("--tool", flags->tools,
                  "Tool, if there are several; of pages also two for two hands: a,b")
      .separated_by(',')
      .one_value_each();
  command.add_flag(
      "--pressure-law", flags->pressure_law,
      "Write pressure by depth of a sphere's presses instead: .csv or .json");
  command.add_option("--taxels", flags->taxels,
                     "Write the pressures that COLUMNSxROWS taxels under the pressed "
                     "tool read instead: .csv or .json");
  command
      .add_option("--at", flags->at_m,
                  "Of taxels: press where the surface is nearest to x,y,z [m]")
      .separated_by(',')
      .values(3);
  command
      .add_option("--depth-m", flags->depth_m,
                  "Of taxels: normal penetration [m]; if not given, the largest")
      .positive();
  command.add_option("--pitch-m", flags->pitch_m, "Of taxels: from one to the next [m]")
      .positive()
      .show_default();
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_export(*flags);
  });
}

}  // namespace palpate
