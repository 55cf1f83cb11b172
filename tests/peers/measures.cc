#include "tests/peers/measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

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

EdgeJumps edge_jumps(const SurfaceMesh& surface,
                     std::span<const Eigen::Vector3d> centre_m,
                     std::span<const Eigen::Vector3d> force_n) {
  const std::vector<std::int32_t> triangle = nearest_triangles(surface, centre_m);
  std::vector<double> step_n;
  double force_sum_n = 0.0;
  int in_contact = 0;
  for (std::size_t i = 0; i + 1 < force_n.size(); ++i) {
    step_n.push_back((force_n[i + 1] - force_n[i]).norm());
    force_sum_n += force_n[i].norm();
    in_contact += force_n[i].norm() > 0.0 ? 1 : 0;
  }
  EdgeJumps jumps;
  const auto count = static_cast<std::ptrdiff_t>(step_n.size());
  const auto slice = [&](std::ptrdiff_t middle, std::ptrdiff_t half) {
    return std::vector<double>(
        step_n.begin() + std::max<std::ptrdiff_t>(0, middle - half),
        step_n.begin() + std::min(count, middle + half + 1));
  };
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (triangle[at + 1] == triangle[at] || force_n[at].norm() == 0.0) {
      continue;
    }
    const std::vector<double> near = slice(i, kAtEdge);
    const double jump = std::max(
        0.0, *std::max_element(near.begin(), near.end()) - median(slice(i, kAround)));
    ++jumps.edges;
    jumps.mean_n += jump;
    jumps.largest_n = std::max(jumps.largest_n, jump);
  }
  jumps.mean_n = jumps.edges > 0 ? jumps.mean_n / jumps.edges : kNaN;
  jumps.largest_n = jumps.edges > 0 ? jumps.largest_n : kNaN;
  jumps.relative = jumps.largest_n / (force_sum_n / in_contact);
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
