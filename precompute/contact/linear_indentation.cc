#include "precompute/contact/linear_indentation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "precompute/contact/complementarity.h"
#include "precompute/contact/contact_gap.h"
#include "precompute/contact/gaps_along.h"

namespace palpate {
namespace {

// Faces turned more than this from the press are another side of the body.
constexpr double kFacingCosine = 0.1;

bool is_supported(const Supports& supports, const ContactNode& node) {
  return supports.free_index[3 * static_cast<std::size_t>(node.mesh_node)] < 0;
}

// Penetration at which the first gap closes. Nearly always gaps are linear in the
// penetration, because the height of the tool's near side above a point is; where the
// distance to the tool counts instead (contact_gap.h) they are convex, and Newton's
// steps come closer from the side that is open.
double first_touch_m(const ContactSurface& surface, std::span<const std::int32_t> patch,
                     const IndentationPath& path) {
  constexpr int kSteps = 30;
  constexpr double kClosed = 1e-9;  // [-] of the largest depth
  double touch = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    const Gaps gaps = gaps_at(surface, patch, path, touch);
    double further = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < gaps.distance_m.size(); ++i) {
      const double rate = gaps.by_centre.row(i).dot(path.outward);
      if (rate > 0.0) {
        further = std::min(further, gaps.distance_m[i] / rate);
      }
    }
    touch += further;
    if (!(std::abs(further) > kClosed * path.depth_max_m) || !std::isfinite(touch)) {
      break;
    }
  }
  return touch;
}

// Pressure at the faces' corners only, from that at all nodes: the hat of a corner on
// the whole faces is its own hat plus half of those on the middles of its edges. (n x
// n_corners), columns scaled to 1 N.
Eigen::SparseMatrix<double> corner_pressures(const ContactSurface& surface,
                                             std::span<const std::int32_t> patch) {
  const auto n = static_cast<Eigen::Index>(patch.size());
  // The neighbours of a corner are the middles of its edges.
  std::unordered_map<std::int32_t, Eigen::Index> row;
  for (Eigen::Index i = 0; i < n; ++i) {
    row.emplace(patch[static_cast<std::size_t>(i)], i);
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index corners = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const ContactNode& corner = node_of(surface, patch[static_cast<std::size_t>(i)]);
    if (!corner.is_corner) {
      continue;
    }
    std::vector<std::pair<Eigen::Index, double>> column{{i, corner.area_m2}};
    for (const std::int32_t v : corner.neighbours) {
      const auto at = row.find(v);
      if (at != row.end()) {
        column.emplace_back(at->second, 0.5 * node_of(surface, v).area_m2);
      }
    }
    double sum = 0.0;
    for (const auto& [at, area] : column) {
      sum += area;
    }
    for (const auto& [at, area] : column) {
      entries.emplace_back(at, corners, area / sum);
    }
    ++corners;
  }
  Eigen::SparseMatrix<double> P(n, corners);
  P.setFromTriplets(entries.begin(), entries.end());
  return P;
}

// The same contact on a mesh of pressures twice as coarse.
class CoarseContact {
 public:
  CoarseContact(const ContactSurface& surface, std::span<const std::int32_t> patch,
                const Eigen::MatrixXd& A)
      : P_(corner_pressures(surface, patch)),
        A_(P_.transpose() * (A * P_)),
        f_(Eigen::VectorXd::Zero(P_.cols())) {}

  double force_n(const Gaps& gaps) {
    if (P_.cols() == 0) {
      return 0.0;
    }
    solve_complementarity(A_, P_.transpose() * gaps.distance_m, f_);
    return (gaps.by_centre.transpose() * (P_ * f_)).norm();
  }

 private:
  Eigen::SparseMatrix<double> P_;  // (n x n_corners)
  Eigen::MatrixXd A_;
  Eigen::VectorXd f_;
};

bool faces(const ContactNode& node, const Eigen::Vector3d& outward) {
  return node.normal.dot(outward) > kFacingCosine;
}

// Of the force, the share that nodes bear whose neighbours were left out of the patch
// for their distance alone: neighbours that face away end a contact, as an edge does.
// @param f (n) forces. @param pushed (n x 3) direction of each.
double edge_share(const ContactSurface& surface, std::span<const std::int32_t> patch,
                  const IndentationPath& path, const Eigen::VectorXd& f,
                  const Eigen::MatrixX3d& pushed) {
  const auto away_m = [&](std::int32_t v) {
    return (node_of(surface, v).position_m - path.vertex_m).norm();
  };
  double reach_m = 0.0;
  for (const std::int32_t v : patch) {
    reach_m = std::max(reach_m, away_m(v));
  }
  Eigen::Vector3d edge = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const auto& neighbours = node_of(surface, patch[i]).neighbours;
    if (std::any_of(neighbours.begin(), neighbours.end(), [&](std::int32_t v) {
          return away_m(v) > reach_m && faces(node_of(surface, v), path.outward);
        })) {
      const auto k = static_cast<Eigen::Index>(i);
      edge += f[k] * pushed.row(k).transpose();
    }
  }
  const double whole = (pushed.transpose() * f).norm();
  return whole > 0.0 ? edge.norm() / whole : 0.0;
}

double contact_area_m2(const ContactSurface& surface,
                       std::span<const std::int32_t> nodes, const Eigen::VectorXd& f) {
  double area = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    area += f[static_cast<Eigen::Index>(i)] > 0.0 ? node_of(surface, nodes[i]).area_m2
                                                  : 0.0;
  }
  return area;
}

double mean_spacing_m(const ContactSurface& surface, std::int32_t v) {
  const ContactNode& node = node_of(surface, v);
  double sum = 0.0;
  for (const std::int32_t w : node.neighbours) {
    sum += (node_of(surface, w).position_m - node.position_m).norm();
  }
  return sum / static_cast<double>(node.neighbours.size());
}

}  // namespace

double patch_radius_m(const IndentationPath& path, double node_spacing_m) {
  // 1.2 times the radius at which a sphere stands depth_max_m above its lowest point.
  const double depth_m = 1.44 * path.depth_max_m;
  return shadow_radius_m(tool_at(path, 0.0), depth_m) + 2.0 * node_spacing_m;
}

std::vector<std::int32_t> contact_patch(const ContactSurface& surface,
                                        const Supports& supports, std::int32_t start,
                                        const Eigen::Vector3d& outward,
                                        double radius_m) {
  const ContactNode& centre = node_of(surface, start);
  const auto faces_tool = [&](const ContactNode& node) {
    return faces(node, outward);
  };
  std::vector<std::int32_t> patch;
  std::vector<std::int32_t> queue{start};
  std::unordered_map<std::int32_t, bool> seen{{start, true}};
  while (!queue.empty()) {
    const std::int32_t v = queue.back();
    queue.pop_back();
    const ContactNode& node = node_of(surface, v);
    // Held nodes carry no contact, but the search goes on over them to free nodes
    // beyond.
    if (!is_supported(supports, node) && faces_tool(node)) {
      patch.push_back(v);
    }
    for (const std::int32_t w : node.neighbours) {
      const ContactNode& next = node_of(surface, w);
      if ((next.position_m - centre.position_m).norm() <= radius_m &&
          faces_tool(next) && seen.emplace(w, true).second) {
        queue.push_back(w);
      }
    }
  }
  std::sort(patch.begin(), patch.end());
  return patch;
}

Indentation indent(const ContactSurface& surface, const SurfaceCompliance& compliance,
                   std::span<const std::int32_t> patch, const IndentationPath& path) {
  Indentation result;
  if (patch.empty()) {
    return result;
  }
  const double touch = first_touch_m(surface, patch, path);
  if (!std::isfinite(touch)) {
    return result;
  }
  result.sample.push_back({.penetration_m = touch});
  if (!(touch < path.depth_max_m)) {
    return result;
  }
  // At each depth: w = g_0 + A f >= 0, f >= 0, w . f = 0. The forces f [N] of one depth
  // are the start of the next.
  const Eigen::MatrixXd A = compliance.among(patch);
  const GapsAlong gaps_along(surface, patch, path, touch);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(A.rows());
  CoarseContact coarse(surface, patch, A);
  for (int k = 1; k <= path.samples && !result.force_capped; ++k) {
    // Depths past the touch grow with the square of the share: samples lie closer
    // together near the touch.
    const double share = static_cast<double>(k) / path.samples;
    IndentationSample sample;
    sample.penetration_m = touch + (path.depth_max_m - touch) * share * share;
    const Gaps gaps = gaps_along.at(sample.penetration_m);
    const ComplementarityReport report = solve_complementarity(A, gaps.distance_m, f);
    result.iterations += report.iterations;
    result.converged = result.converged && report.converged;
    // Force on the tool: sum_v f_v dg_v/d(reference).
    sample.force_n = gaps.by_centre.transpose() * f;
    sample.energy_j = -0.5 * f.dot(gaps.distance_m);  // A f closes the gaps under f
    sample.pressure_n = f;
    result.edge_share = edge_share(surface, patch, path, f, gaps.by_centre);
    sample.coarse_force_n = coarse.force_n(gaps);
    sample.contact_radius_m =
        std::sqrt(contact_area_m2(surface, patch, f) / std::numbers::pi);
    result.force_capped = sample.force_n.norm() > path.force_max_n;
    result.sample.push_back(sample);
  }
  std::int32_t nearest = patch.front();
  for (const std::int32_t v : patch) {
    if ((node_of(surface, v).position_m - path.vertex_m).squaredNorm() <
        (node_of(surface, nearest).position_m - path.vertex_m).squaredNorm()) {
      nearest = v;
    }
  }
  result.node_spacing_m = mean_spacing_m(surface, nearest);
  return result;
}

std::string broken_rule(const Indentation& indentation) {
  for (std::size_t k = 0; k < indentation.sample.size(); ++k) {
    const IndentationSample& sample = indentation.sample[k];
    const double at_m = sample.penetration_m;
    if (!std::isfinite(at_m) ||
        (k > 0 && !(at_m > indentation.sample[k - 1].penetration_m))) {
      return fmt::format("its penetration at sample {} is {} m, must grow", k, at_m);
    }
    for (const double value : {sample.force_n.norm(), sample.energy_j,
                               sample.contact_radius_m, sample.coarse_force_n}) {
      if (!std::isfinite(value)) {
        return fmt::format("a force or energy at {:.4g} mm is not finite", 1e3 * at_m);
      }
    }
  }
  return std::isfinite(indentation.exterior_error_relative)
             ? ""
             : "the error of what is left out around it is not finite";
}

}  // namespace palpate
