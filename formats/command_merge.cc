#include "formats/command_merge.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/database_slice.h"

namespace palpate {
namespace {

struct Flags {
  std::vector<std::string> files;
  std::string output;
  bool json = false;
};

void run(const Flags& flags) {
  std::vector<ResponseDatabase> databases;
  for (const std::string& file : flags.files) {
    databases.push_back(read_database(file));
  }
  const ResponseDatabase merged = merge(databases);
  write_database(flags.output, merged);
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const ResponseTable& table : merged.tools) {
    names.push_back(table.tool.name);
  }
  const std::uintmax_t bytes = std::filesystem::file_size(flags.output);
  if (flags.json) {
    const nlohmann::ordered_json report = {
        {"output", flags.output}, {"tools", names}, {"bytes", bytes}};
    fmt::print("{}\n",
               report.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("wrote {}: {} tools, {} bytes\n", flags.output, merged.tools.size(),
               bytes);
  }
}

}  // namespace

void add_merge_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("merge", "Put the tools of databases of one body in one file");
  auto flags = std::make_shared<Flags>();
  command->add_option("files", flags->files, "Response databases, numbered from 0")
      ->required()
      ->expected(2, -1);
  command->add_option("-o,--output", flags->output, "Database to write")->required();
  command->add_flag("--json", flags->json, "Print the report as one JSON object");
  command->callback([flags] {
    run(*flags);
  });
}

}  // namespace palpate
