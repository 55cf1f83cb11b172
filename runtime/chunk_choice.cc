#include "runtime/chunk_choice.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/loaded_chunk.h"

namespace palpate {
namespace {

constexpr double kWayShare = 0.1;
constexpr double kDiagonalShare = 0.25;

struct Near {
  double distance_m = 0.0;
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
  std::vector<Near> near(static_cast<std::size_t>(index.chunks()));
  Near nearest{.distance_m = std::numeric_limits<double>::infinity()};
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    const Eigen::AlignedBox3d box = chunk_box(index, k);
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kPlaces; ++i) {
      const double share = static_cast<double>(i) / kPlaces;
      const double distance =
          box.exteriorDistance(Eigen::Vector3d(motion.position_m + share * way));
      best = std::min(best, distance + kWayShare * share * way.norm());
    }
    near[static_cast<std::size_t>(k)] = {best, k};
    if (best < nearest.distance_m) {
      nearest = {best, k};
    }
  }
  if (near.empty()) {
    return {};
  }
  const double reach_m =
      nearest.distance_m + kWayShare * way.norm() +
      kDiagonalShare * chunk_box(index, nearest.chunk).diagonal().norm();
  std::erase_if(near, [reach_m](const Near& entry) {
    return !(entry.distance_m <= reach_m);
  });
  std::stable_sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
    return a.distance_m < b.distance_m;
  });
  std::vector<std::int64_t> chunks;
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
  // Sweep along x: boxes that meet overlap there.
  std::vector<std::int64_t> order(static_cast<std::size_t>(index.chunks()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int64_t a, std::int64_t b) {
    return index.box_min_m(a, 0) < index.box_min_m(b, 0);
  });
  std::vector<std::size_t> bytes(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    bytes[i] = bytes_in_use(index, tool, order[i]);
  }
  std::vector<std::size_t> around = bytes;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Eigen::AlignedBox3d box = chunk_box(index, order[i]);
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Eigen::AlignedBox3d other = chunk_box(index, order[j]);
      if (other.min().x() > box.max().x()) {
        break;
      }
      if (box.intersects(other)) {
        around[i] += bytes[j];
        around[j] += bytes[i];
      }
    }
  }
  return around.empty()
             ? 0
             : 2 * (around.size() + *std::max_element(around.begin(), around.end()));
}

}  // namespace palpate
