// palpate-db merge: the tools of several databases of one body in one file, or the
// shards of one build in a database.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/command/commands.h"
#include "formats/database/database_slice.h"
#include "formats/database/merge_shards.h"
#include "formats/database/precision_choice.h"
#include "runtime/slow/static_field.h"

namespace palpate {
namespace {

struct MergeFlags {
  std::vector<std::string> files;
  std::string output;
  std::string precision;
  bool json = false;
};

void print_merged(const nlohmann::ordered_json& report) {
  fmt::print("{}\n", json_text(report));
}

nlohmann::ordered_json names_of(const ResponseDatabase& database) {
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const ResponseTable& table : database.tools) {
    names.push_back(table.tool.name);
  }
  return names;
}

std::optional<Precision> wanted_precision(const MergeFlags& flags) {
  return flags.precision.empty() ? std::nullopt
                                 : std::optional(precision_of(flags.precision));
}

void run_databases(const MergeFlags& flags) {
  const std::optional<Precision> precision = wanted_precision(flags);
  std::vector<ResponseDatabase> databases;
  for (const std::string& file : flags.files) {
    databases.push_back(read_database(file));
  }
  ResponseDatabase merged = merge(databases);
  merged.storage.precision = precision.value_or(merged.storage.precision);
  write_database(flags.output, merged);
  const std::uintmax_t bytes = std::filesystem::file_size(flags.output);
  if (flags.json) {
    print_merged(
        {{"output", flags.output}, {"tools", names_of(merged)}, {"bytes", bytes}});
  } else {
    fmt::print("wrote {}: {} tools, {} bytes\n", flags.output, merged.tools.size(),
               bytes);
  }
}

void run_shards(const MergeFlags& flags) {
  const std::vector<std::filesystem::path> files(flags.files.begin(),
                                                 flags.files.end());
  const std::optional<Precision> precision = wanted_precision(flags);
  Assembly all = merge_shards(files, stored_forces);
  choose_precision(all.database, precision);
  write_database(flags.output, all.database);
  const std::uintmax_t bytes = std::filesystem::file_size(flags.output);
  if (flags.json) {
    print_merged({{"output", flags.output},
                  {"tools", names_of(all.database)},
                  {"bytes", bytes},
                  {"precision", name_of(all.database.storage.precision)},
                  {"shards", files.size()},
                  {"solved", all.solved},
                  {"interpolated", all.interpolated},
                  {"failed", all.failed},
                  {"truncated", all.truncated},
                  {"ended_at_support", all.ended_at_support},
                  {"untouched", all.untouched},
                  {"outside_reach", all.outside_reach},
                  {"over_budget", all.over_budget},
                  {"checked", all.checked},
                  {"error_factor", all.error_factor},
                  {"hard_error_factor", all.hard_error_factor},
                  {"near_singular", all.near_singular},
                  {"failures", all.failures}});
  } else {
    fmt::print(
        "wrote {} from {} shards: {} responses solved, {} interpolated, {} failed, {} "
        "over budget, {} bytes\n",
        flags.output, files.size(), all.solved, all.interpolated, all.failed,
        all.over_budget, bytes);
  }
  if (all.failed + all.truncated > 0) {
    fmt::print(
        stderr,
        "palpate-db: warning: of {} nodes {} have no response and {} only a part "
        "of it; all others are in {}\n",
        all.solved + all.interpolated + all.failed, all.failed, all.truncated,
        flags.output);
  }
}

void run_merge(const MergeFlags& flags) {
  const bool any_shard =
      std::any_of(flags.files.begin(), flags.files.end(), [](const std::string& file) {
        return is_shard(file);
      });
  if (any_shard) {
    run_shards(flags);
  } else {
    run_databases(flags);
  }
}

}  // namespace

void add_merge_command(Command app) {
  Command command =
      app.add_subcommand("merge",
                         "Put the tools of databases of one body in one file, or the "
                         "shards of one build in a database");
  auto flags = std::make_shared<MergeFlags>();
  command
      .add_option("files", flags->files,
                  "Response databases, numbered from 0, or shards")
      .required()
      .values_at_least(2);
  command.add_option("-o,--output", flags->output, "Database to write").required();
  command.add_option("--precision", flags->precision,
                     "float64, float32 or int16; by default that of the databases, "
                     "for shards the cheapest within a tenth of the accuracy budget");
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_merge(*flags);
  });
}

}  // namespace palpate
