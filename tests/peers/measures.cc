#include "tests/peers/measures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "formats/mesh/surface_search.h"

namespace palpate::peers {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Triangle that each centre is nearest to, by walking on from the last.
std::vector<std::int32_t> nearest_triangles(const SurfaceMesh& surface,
                                            std::span<const Eigen::Vector3d> centre_m) {
  const SurfaceSearch search(surface);
  std::vector<std::int32_t> nearest;
  for (const Eigen::Vector3d& c : centre_m) {
    nearest.push_back(nearest.empty() ? search.nearest(c).triangle
                                      : search.walk(c, nearest.back()).triangle);
  }
  return nearest;
}

// First and last tick with a true force; the whole hand without one.
std::pair<std::size_t, std::size_t> in_contact(const Hand& hand) {
  std::size_t first = hand.centre_m.size();
  std::size_t last = 0;
  for (const TruePoint& point : hand.truth) {
    if (point.force_n.norm() > 0.0) {
      first = std::min(first, static_cast<std::size_t>(point.tick));
      last = std::max(last, static_cast<std::size_t>(point.tick));
    }
  }
  return first < last ? std::pair{first, last}
                      : std::pair{std::size_t{0}, hand.centre_m.size() - 1};
}

std::vector<double> steps_n(std::span<const Eigen::Vector3d> force_n) {
  std::vector<double> step_n;
  for (std::size_t i = 0; i + 1 < force_n.size(); ++i) {
    step_n.push_back((force_n[i + 1] - force_n[i]).norm());
  }
  return step_n;
}

std::vector<double> turns_rad(std::span<const Eigen::Vector3d> force_n) {
  std::vector<double> turn_rad;
  for (std::size_t i = 0; i + 1 < force_n.size(); ++i) {
    // Of a zero vector: atan2(0, 0) = 0.
    turn_rad.push_back(std::atan2(force_n[i].cross(force_n[i + 1]).norm(),
                                  force_n[i].dot(force_n[i + 1])));
  }
  return turn_rad;
}

// Each value less the median around it, where it is above.
std::vector<double> beyond_usual(const std::vector<double>& values) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  std::vector<double> beyond;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto begin = values.begin() + std::max<std::ptrdiff_t>(0, i - kAround);
    const auto end = values.begin() + std::min(count, i + kAround + 1);
    beyond.push_back(
        std::max(0.0, values[static_cast<std::size_t>(i)] - median({begin, end})));
  }
  return beyond;
}

double largest_near(const std::vector<double>& values, std::size_t crossing) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  const auto i = static_cast<std::ptrdiff_t>(crossing);
  return *std::max_element(values.begin() + std::max<std::ptrdiff_t>(0, i - kAtEdge),
                           values.begin() + std::min(count, i + kAtEdge + 1));
}

}  // namespace

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

ForceError force_error(std::span<const RenderedHand> rendered) {
  ForceError e;
  double true_n = 0.0;
  for (const auto& [hand, force_n] : rendered) {
    for (const TruePoint& point : hand->truth) {
      const Eigen::Vector3d& f = force_n[static_cast<std::size_t>(point.tick)];
      const double size = point.force_n.norm();
      const double off = (f - point.force_n).norm();
      ++e.points;
      e.mean_n += off;
      if (size > 0.0) {
        ++e.contact_points;
        e.contact_mean_n += off;
        e.along_relative += std::abs(f.dot(point.force_n) / size - size);
        true_n += size;
      }
    }
  }
  // Sums until here. Of no points: 0/0, which is NaN.
  e.relative = e.mean_n / true_n;
  e.contact_relative = e.contact_mean_n / true_n;
  e.along_relative /= true_n;
  e.mean_n /= e.points;
  e.contact_mean_n /= e.contact_points;
  return e;
}

EdgeJumps edge_jumps(const SurfaceMesh& surface, const RenderedHand& rendered) {
  const auto [first, last] = in_contact(*rendered.hand);
  const auto force_n = std::span(rendered.force_n).subspan(first, last - first + 1);
  const std::vector<std::int32_t> triangle = nearest_triangles(
      surface, std::span(rendered.hand->centre_m).subspan(first, last - first + 1));
  const std::vector<double> jump_n = beyond_usual(steps_n(force_n));
  const std::vector<double> turn_rad = beyond_usual(turns_rad(force_n));
  EdgeJumps jumps;
  for (std::size_t i = 0; i < jump_n.size(); ++i) {
    if (triangle[i] != triangle[i + 1]) {
      const double jump = largest_near(jump_n, i);
      ++jumps.edges;
      jumps.mean_n += jump;
      jumps.largest_n = std::max(jumps.largest_n, jump);
      jumps.turn_rad = std::max(jumps.turn_rad, largest_near(turn_rad, i));
    }
  }
  const double mean_n =
      std::transform_reduce(force_n.begin(), force_n.end() - 1, 0.0, std::plus<>(),
                            [](const Eigen::Vector3d& f) {
                              return f.norm();
                            }) /
      static_cast<double>(last - first);
  jumps.mean_n /= jumps.edges;  // 0/0, NaN, without an edge
  jumps.relative = jumps.largest_n / mean_n;
  jumps.anywhere_relative =
      jump_n.empty() ? kNaN : *std::max_element(jump_n.begin(), jump_n.end()) / mean_n;
  jumps.turn_anywhere_rad =
      turn_rad.empty() ? kNaN : *std::max_element(turn_rad.begin(), turn_rad.end());
  return jumps;
}

PathEnergy path_energy(std::span<const Eigen::Vector3d> centre_m,
                       std::span<const Eigen::Vector3d> force_n) {
  PathEnergy energy;
  for (std::size_t i = 0; i + 1 < centre_m.size(); ++i) {
    energy.put_in_j -=
        0.5 * (force_n[i] + force_n[i + 1]).dot(centre_m[i + 1] - centre_m[i]);
    energy.created_j = std::max(energy.created_j, -energy.put_in_j);
    energy.largest_j = std::max(energy.largest_j, energy.put_in_j);
  }
  return energy;
}

}  // namespace palpate::peers
