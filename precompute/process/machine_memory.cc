#include "precompute/process/machine_memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"

namespace palpate {
namespace {

constexpr std::int64_t kUnknown = std::numeric_limits<std::int64_t>::max();
constexpr double kCanBeWrongBy = 1.4;

std::int64_t available_bytes() {
  std::ifstream in("/proc/meminfo");
  std::string name;
  std::int64_t kibibytes = 0;
  std::string unit;
  while (in >> name >> kibibytes) {
    if (name == "MemAvailable:") {
      return 1024 * kibibytes;
    }
    std::getline(in, unit);
  }
  return kUnknown;
}

// A number, or the word "max".
std::int64_t group_value(const char* file) {
  std::ifstream in(file);
  std::int64_t value = 0;
  return in >> value ? value : kUnknown;
}

}  // namespace

std::int64_t free_memory_bytes() {
  const std::int64_t limit = group_value("/sys/fs/cgroup/memory.max");
  const std::int64_t used = group_value("/sys/fs/cgroup/memory.current");
  const std::int64_t left = limit == kUnknown || used == kUnknown
                                ? kUnknown
                                : std::max<std::int64_t>(limit - used, 0);
  return std::min(available_bytes(), left);
}

double expected_memory_bytes(std::int64_t triangles) {
  return 1.40e4 * reproducible::pow(static_cast<double>(triangles), 1.240);
}

void require_memory(std::int64_t triangles) {
  const auto free = static_cast<double>(free_memory_bytes());
  const double needed = expected_memory_bytes(triangles);
  if (needed > kCanBeWrongBy * free) {
    throw InputError(fmt::format(
        "the factor of a body of {} surface triangles needs about {:.3g} GB, {:.3g} GB "
        "are free: solve parts of it ([cutout] radius_m), refine under the tool alone "
        "(accuracy.refine = \"local\"), or make the surface coarser "
        "(palpate-precompute remesh)",
        triangles, 1e-9 * needed, 1e-9 * free));
  }
}

}  // namespace palpate
