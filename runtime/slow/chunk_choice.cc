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

// Chunks that this contact is near, in any order.
std::vector<Near> near_motion(const DatabaseIndex& index, const ToolMotion& motion,
                              double horizon_s) {
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
  return near;
}

// The most chunks that may be within that distance of a chunk, which is one.
std::size_t most_within(const DatabaseIndex& index, double distance_m) {
  std::size_t most = 1;
  for (std::int64_t k = 0; distance_m > 0.0 && k < index.chunks(); ++k) {
    std::size_t within = 0;
    for (std::int64_t j = 0; j < index.chunks(); ++j) {
      within += chunk_box(index, k).exteriorDistance(chunk_box(index, j)) <= distance_m
                    ? 1U
                    : 0U;
    }
    most = std::max(most, within);
  }
  return most;
}

std::size_t largest_of(std::vector<std::size_t> bytes, std::size_t count) {
  std::sort(bytes.begin(), bytes.end(), std::greater<>());
  bytes.resize(std::min(count, bytes.size()));
  return std::accumulate(bytes.begin(), bytes.end(), std::size_t{0});
}

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
                                      std::span<const ToolMotion> contacts,
                                      double horizon_s) {
  constexpr double kNotNear = std::numeric_limits<double>::infinity();
  std::vector<double> urgency_m(static_cast<std::size_t>(index.chunks()), kNotNear);
  for (const ToolMotion& motion : contacts) {
    for (const Near& near : near_motion(index, motion, horizon_s)) {
      double& most = urgency_m[static_cast<std::size_t>(near.chunk)];
      most = std::min(most, near.urgency_m);
    }
  }
  std::vector<std::int64_t> chunks;
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    if (urgency_m[static_cast<std::size_t>(k)] < kNotNear) {
      chunks.push_back(k);
    }
  }
  std::stable_sort(chunks.begin(), chunks.end(), [&](std::int64_t a, std::int64_t b) {
    return urgency_m[static_cast<std::size_t>(a)] <
           urgency_m[static_cast<std::size_t>(b)];
  });
  return chunks;
}

std::size_t bytes_in_use(const DatabaseIndex& index, const ChunkContent& content,
                         std::int64_t chunk) {
  return chunk_bytes(index, content, chunk) + piece_bytes(index, chunk);
}

std::size_t least_budget(const DatabaseIndex& index, const ChunkContent& content,
                         const ContactSpread& spread) {
  std::vector<std::size_t> bytes(static_cast<std::size_t>(index.chunks()));
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    bytes[k] = bytes_in_use(index, content, static_cast<std::int64_t>(k));
  }
  const std::size_t all = std::accumulate(bytes.begin(), bytes.end(), std::size_t{0});
  constexpr std::size_t kAround = 8;
  const std::size_t chunks =
      std::min((1 + kAround) * static_cast<std::size_t>(spread.contacts),
               most_within(index, spread.extent_m) + kAround);
  const std::size_t hand = largest_of(bytes, chunks);
  return 2 *
         (bytes.size() + std::min(all, hand * static_cast<std::size_t>(spread.hands)));
}

}  // namespace palpate
