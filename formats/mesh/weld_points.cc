#include "formats/mesh/weld_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace palpate {
namespace {

using WeldCell = std::array<std::int64_t, 3>;

struct WeldCellHash {
  std::size_t operator()(const WeldCell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

WeldCell weld_cell_of(const Eigen::Vector3d& p, double width) {
  WeldCell cell{};
  for (std::size_t k = 0; k < 3; ++k) {
    cell[k] =
        static_cast<std::int64_t>(std::floor(p[static_cast<Eigen::Index>(k)] / width));
  }
  return cell;
}

}  // namespace

double rounding_of(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kSteps = 4.0;
  double largest = 0.0;
  for (const Eigen::Vector3d& p : points) {
    largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  return kSteps * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest;
}

std::vector<std::size_t> first_within(const std::vector<Eigen::Vector3d>& points,
                                      double tolerance) {
  // Cells so wide that a point is rarely as close as the tolerance to another one.
  const double width = 256.0 * tolerance;
  std::unordered_map<WeldCell, std::vector<std::size_t>, WeldCellHash> kept;
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& p = points[i];
    first.push_back(i);
    if (!p.allFinite() || !(tolerance > 0.0) || !std::isfinite(tolerance)) {
      continue;
    }
    const WeldCell low = weld_cell_of(p.array() - tolerance, width);
    const WeldCell high = weld_cell_of(p.array() + tolerance, width);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto there = kept.find({x, y, z});
          if (there == kept.end()) {
            continue;
          }
          for (const std::size_t j : there->second) {
            if ((p - points[j]).cwiseAbs().maxCoeff() <= tolerance) {
              first[i] = std::min(first[i], j);
            }
          }
        }
      }
    }
    if (first[i] == i) {
      kept[weld_cell_of(p, width)].push_back(i);
    }
  }
  return first;
}

}  // namespace palpate
