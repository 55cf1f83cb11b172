#include "runtime/slow/chunk_choice.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/slow/loaded_chunk.h"

namespace palpate {
namespace {

constexpr double kWayShare = 0.1;
constexpr double kUrgencyShare = 0.5;
constexpr double kDiagonalShare = 0.4;

struct Near {
  double distance_m = std::numeric_limits<double>::infinity();
  double urgency_m = std::numeric_limits<double>::infinity();
  std::int64_t chunk = 0;
};

}  // namespace

Eigen::AlignedBox3d chunk_box(const DatabaseIndex& index, std::int64_t chunk) {
  return {Eigen::Vector3d(index.box_min_m.row(chunk).transpose()),
          Eigen::Vector3d(index.box_max_m.row(chunk).transpose())};
}

std::size_t find_tool(const DatabaseIndex& index, const std::string& name) {
  std::string names;
  for (std::size_t i = 0; i < index.tools.size(); ++i) {
    const std::string& tool = index.tools[i].tool.name;
    if (tool == name || (name.empty() && index.tools.size() == 1)) {
      return i;
    }
    names += (names.empty() ? "" : ", ") + tool;
  }
  throw InputError(name.empty()
                       ? fmt::format("several tools, name one of: {}", names)
                       : fmt::format("no tool \"{}\", there are: {}", name, names));
}

std::vector<std::int64_t> chunks_near(const DatabaseIndex& index,
                                      const ToolMotion& motion, double horizon_s) {
  constexpr int kPlaces = 8;
  const Eigen::Vector3d way = motion.velocity_m_per_s * horizon_s;
  const double way_m = way.norm();
  Eigen::AlignedBox3d path(motion.position_m);
  path.extend(Eigen::Vector3d(motion.position_m + way));
  std::vector<Near> near;
  double reach_m = std::numeric_limits<double>::infinity();
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    const Eigen::AlignedBox3d box = chunk_box(index, k);
    if (box.exteriorDistance(path) > reach_m + kWayShare * way_m) {
      continue;
    }
    Near entry{.chunk = k};
    for (int i = 0; i <= kPlaces; ++i) {
      const double share = static_cast<double>(i) / kPlaces;
      const double distance_m =
          box.exteriorDistance(Eigen::Vector3d(motion.position_m + share * way));
      entry.distance_m =
          std::min(entry.distance_m, distance_m + kWayShare * share * way_m);
      entry.urgency_m =
          std::min(entry.urgency_m, distance_m + kUrgencyShare * share * way_m);
    }
    near.push_back(entry);
    // A chunk that spans a gap is near everywhere; the compact ones say what near is,
    // but for the last, which may have few nodes.
    if (k == 0 || k + 1 < index.chunks()) {
      reach_m =
          std::min(reach_m, entry.distance_m + kDiagonalShare * box.diagonal().norm());
    }
  }
  reach_m += kWayShare * way_m;
  std::erase_if(near, [reach_m](const Near& entry) {
    return !(entry.distance_m <= reach_m);
  });
  std::stable_sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
    return a.urgency_m < b.urgency_m;
  });
  std::vector<std::int64_t> chunks;
  chunks.reserve(near.size());
  for (const Near& entry : near) {
    chunks.push_back(entry.chunk);
  }
  return chunks;
}

std::size_t bytes_in_use(const DatabaseIndex& index, std::size_t tool,
                         std::int64_t chunk) {
  return chunk_bytes(index, tool, chunk) + piece_bytes(index, chunk);
}

std::size_t least_budget(const DatabaseIndex& index, std::size_t tool) {
  constexpr std::ptrdiff_t kNeighbourhood = 9;
  std::vector<std::size_t> bytes(static_cast<std::size_t>(index.chunks()));
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    bytes[k] = bytes_in_use(index, tool, static_cast<std::int64_t>(k));
  }
  std::sort(bytes.begin(), bytes.end(), std::greater<>());
  const auto end = bytes.begin() + std::min(kNeighbourhood, std::ssize(bytes));
  return 2 * std::accumulate(bytes.begin(), end, bytes.size());
}

}  // namespace palpate
