#include "precompute/build/kept_output.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/patience.h"

namespace palpate {
namespace {

bool has_response(const WorkUnitNode& node) {
  return node.response.origin != ResponseOrigin::kNone;
}

std::optional<ResponseDatabase> database_of_plan(const std::filesystem::path& output,
                                                 const std::string& plan_digest) {
  try {
    ResponseDatabase database = read_database(output);
    if (database.provenance.plan_sha256 == plan_digest) {
      return database;
    }
  } catch (const InputError&) {
    // It is not there.
  } catch (const FormatError&) {
    // It is something else.
  }
  return std::nullopt;
}

Assembly assembly_of(ResponseDatabase database) {
  Assembly assembly;
  for (const ResponseTable& table : database.tools) {
    for (std::size_t i = 0; i < table.origin.size(); ++i) {
      const auto origin = static_cast<ResponseOrigin>(table.origin[i]);
      assembly.interpolated += origin == ResponseOrigin::kInterpolated ? 1 : 0;
      assembly.solved += origin == ResponseOrigin::kSimulated ? 1 : 0;
      assembly.failed += (table.flags[i] & kFailed) != 0 ? 1 : 0;
      assembly.near_singular += (table.flags[i] & kNearSingular) != 0 ? 1 : 0;
      assembly.over_budget += (table.flags[i] & kErrorOverBudget) != 0 ? 1 : 0;
      if (origin != ResponseOrigin::kNone) {
        assembly.error.push_back(table.error_relative[i]);
      }
    }
    assembly.error_factor =
        std::max(assembly.error_factor, table.accuracy.error_factor);
    assembly.hard_error_factor =
        std::max(assembly.hard_error_factor, table.accuracy.hard_error_factor);
  }
  std::sort(assembly.error.begin(), assembly.error.end());
  assembly.database = std::move(database);
  return assembly;
}

}  // namespace

std::int64_t responses_of(const Shard& shard) {
  std::int64_t count = 0;
  for (const WorkUnitOutcome& unit : shard.unit) {
    count += unit.is_check ? 0 : std::ranges::count_if(unit.node, has_response);
  }
  return count;
}

std::optional<std::int64_t> responses_there(const std::filesystem::path& output,
                                            const std::string& plan_digest) {
  try {
    if (is_shard(output)) {
      const Shard shard = read_shard(output);
      return shard.plan.digest == plan_digest ? std::optional(responses_of(shard))
                                              : std::nullopt;
    }
  } catch (const Error&) {
    return std::nullopt;  // it is not there, or damaged
  }
  const auto database = database_of_plan(output, plan_digest);
  if (!database) {
    return std::nullopt;
  }
  const Assembly assembly = assembly_of(*database);
  return std::ssize(assembly.error);
}

std::optional<Assembly> assembled_already(const std::filesystem::path& output,
                                          const std::string& plan_digest,
                                          std::optional<Precision> precision) {
  auto database = database_of_plan(output, plan_digest);
  if (!database || (precision && database->storage.precision != *precision)) {
    return std::nullopt;
  }
  return assembly_of(std::move(*database));
}

void write_unless_worse(const std::filesystem::path& output,
                        const std::string& plan_digest, std::int64_t responses,
                        double patience_s, const std::function<void()>& write) {
  const auto there = responses_there(output, plan_digest);
  if (there && *there > responses) {
    throw NumericalError(
        fmt::format("{} holds {} responses of the same scene, this build has {}: it is "
                    "not replaced",
                    output.string(), *there, responses));
  }
  with_patience(patience_s, output.string(), write);
}

}  // namespace palpate
