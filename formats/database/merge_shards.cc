#include "formats/database/merge_shards.h"

#include <iterator>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

void require_shard(const fs::path& file) {
  if (!fs::exists(file)) {
    throw InputError(fmt::format("{} cannot be read", file.string()));
  }
  if (!is_shard(file)) {
    throw InputError(
        fmt::format("{} is no shard: shards and databases cannot be merged with each "
                    "other",
                    file.string()));
  }
}

}  // namespace

Assembly merge_shards(std::span<const fs::path> files, const StoredForces& stored) {
  std::optional<JobDescription> plan;
  std::vector<WorkUnitOutcome> units;
  std::map<std::int64_t, fs::path> origin;
  for (const fs::path& file : files) {
    require_shard(file);
    Shard shard = read_shard(file);
    // Shards belong together where their plans have one digest.
    if (plan && shard.plan.digest != plan->digest) {
      throw InputError(
          fmt::format("{} and {} are shards of different computations: another scene, "
                      "body, version or another choice of nodes to solve",
                      files.front().string(), file.string()));
    }
    for (const WorkUnitOutcome& unit : shard.unit) {
      const auto [place, is_new] = origin.try_emplace(unit.index, file);
      if (!is_new) {
        throw InputError(fmt::format("unit {} comes twice: in {} and in {}", unit.index,
                                     place->second.string(), file.string()));
      }
    }
    std::move(shard.unit.begin(), shard.unit.end(), std::back_inserter(units));
    if (!plan) {
      plan = std::move(shard.plan);
    }
  }
  if (!plan) {
    throw InputError("no shards were given");
  }
  Assembly assembly = assemble(*plan, units, stored);
  require_responses(*plan, assembly);
  return assembly;
}

}  // namespace palpate
