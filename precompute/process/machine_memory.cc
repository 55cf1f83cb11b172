#include "precompute/process/machine_memory.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "precompute/process/patience.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kUnknown = std::numeric_limits<std::int64_t>::max();
constexpr double kCanBeWrongBy = 1.4;

// The number after a word that begins a line; that of none is not known.
std::int64_t value_after(const fs::path& file, const std::string& word) {
  std::ifstream in(file);
  std::string name;
  std::int64_t value = 0;
  std::string rest;
  while (in >> name >> value) {
    if (name == word) {
      return value;
    }
    std::getline(in, rest);
  }
  return kUnknown;
}

std::int64_t system_bytes(const MemoryFiles& files, const std::string& word) {
  const std::int64_t kibibytes = value_after(files.proc / "meminfo", word);
  return kibibytes == kUnknown ? kUnknown : 1024 * kibibytes;
}

// A number, or the word "max".
std::int64_t group_value(const fs::path& file) {
  std::ifstream in(file);
  std::int64_t value = 0;
  return in >> value ? value : kUnknown;
}

// Names of one version's files in a group's folder.
struct GroupFiles {
  const char* limit;
  const char* used;
  const char* dropped_first;  // in memory.stat
};
constexpr GroupFiles kVersion1{"memory.limit_in_bytes", "memory.usage_in_bytes",
                               "total_inactive_file"};
constexpr GroupFiles kVersion2{"memory.max", "memory.current", "inactive_file"};

using OfGroup =
    std::function<std::int64_t(const fs::path& folder, const GroupFiles& names)>;

// The least of a group and all around it, up to the root of its tree.
std::int64_t least_upwards(const fs::path& root, const std::string& group,
                           const GroupFiles& names, const OfGroup& of) {
  std::int64_t least = of(root, names);
  fs::path folder = root;
  for (const fs::path& part : fs::path(group).relative_path()) {
    folder /= part;
    least = std::min(least, of(folder, names));
  }
  return least;
}

// Over the groups of this process: "0::/a/b" in version 2, "4:memory:/a/b" in 1.
std::int64_t least_of_groups(const MemoryFiles& files, const OfGroup& of) {
  std::int64_t least = of(files.groups, kVersion2);
  std::ifstream in(files.proc / "self" / "cgroup");
  std::string line;
  while (std::getline(in, line)) {
    const std::size_t name = line.find(':');
    const std::size_t path = line.find(':', name == line.npos ? name : name + 1);
    if (path == line.npos || line.find("..", path) != line.npos) {
      continue;  // no group, or none of those that are seen here
    }
    const std::string controllers = "," + line.substr(name + 1, path - name - 1) + ",";
    const std::string group = line.substr(path + 1);
    if (controllers == ",,") {
      least = std::min(least, least_upwards(files.groups, group, kVersion2, of));
    } else if (controllers.find(",memory,") != line.npos) {
      least =
          std::min(least, least_upwards(files.groups / "memory", group, kVersion1, of));
    }
  }
  return least;
}

std::int64_t left_of(const fs::path& folder, const GroupFiles& names) {
  const std::int64_t limit = group_value(folder / names.limit);
  const std::int64_t used = group_value(folder / names.used);
  if (limit == kUnknown || used == kUnknown) {
    return kUnknown;
  }
  const std::int64_t dropped = value_after(folder / "memory.stat", names.dropped_first);
  const std::int64_t kept =
      used - (dropped == kUnknown ? 0 : std::clamp<std::int64_t>(dropped, 0, used));
  return std::max<std::int64_t>(limit - kept, 0);
}

}  // namespace

std::int64_t free_memory_bytes(const MemoryFiles& files) {
  return std::min(system_bytes(files, "MemAvailable:"),
                  least_of_groups(files, left_of));
}

std::int64_t most_memory_bytes(const MemoryFiles& files) {
  return std::min(system_bytes(files, "MemTotal:"),
                  least_of_groups(files, [](const fs::path& folder, auto& names) {
                    return group_value(folder / names.limit);
                  }));
}

void require_free_memory(double bytes, double least_bytes, const std::string& what,
                         const std::string& advice, const MemoryFiles& files) {
  const auto most = static_cast<double>(most_memory_bytes(files));
  if (least_bytes > most) {
    throw InputError(
        fmt::format("{} needs about {:.3g} GB, this machine has {:.3g} GB: {}", what,
                    1e-9 * bytes, 1e-9 * most, advice));
  }
  with_patience(kMomentS, what, [&] {
    const auto free = static_cast<double>(free_memory_bytes(files));
    if (least_bytes > free) {
      throw ResourceError(
          fmt::format("{} needs about {:.3g} GB, {:.3g} GB are free at present: end "
                      "what else takes "
                      "memory, or give fewer --threads",
                      what, 1e-9 * bytes, 1e-9 * free));
    }
  });
}

double expected_memory_bytes(std::int64_t triangles) {
  return 1.40e4 * reproducible::pow(static_cast<double>(triangles), 1.240);
}

void require_memory(std::int64_t triangles) {
  const double needed = expected_memory_bytes(triangles);
  require_free_memory(
      needed, needed / kCanBeWrongBy,
      fmt::format("the factor of a body of {} surface triangles", triangles),
      "solve parts of it ([cutout] radius_m), refine under the tool alone "
      "(accuracy.refine = \"local\"), or make the surface coarser "
      "(palpate-precompute remesh)");
}

}  // namespace palpate
