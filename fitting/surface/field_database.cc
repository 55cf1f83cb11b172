#include "fitting/surface/field_database.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kNormalWeight = 0.05;  // of the bare normal, against one probe's

NodeResponse response_of(const SurfaceFields& fields, Eigen::Index node,
                         const Eigen::Vector3d& direction) {
  NodeResponse response;
  response.direction = direction;
  response.origin = fields.measured[static_cast<std::size_t>(node)] != 0
                        ? ResponseOrigin::kMeasured
                        : ResponseOrigin::kInterpolated;
  if (fields.far[static_cast<std::size_t>(node)] != 0) {
    response.flags = kExtrapolated;
  }
  response.depth_m = {0.0};
  response.force_n = {0.0};
  const Eigen::Index depths = fields.depth_m.size();
  double highest = -std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < depths; ++k) {
    // Fields of the depths are independent: where they would fall with depth, they
    // stay.
    highest = std::max(highest, fields.log_force(node, k));
    response.depth_m.push_back(fields.depth_m[k]);
    response.force_n.push_back(std::exp(highest));
    if (fields.depth_m[k] >= 0.5 * fields.depth_m[depths - 1]) {
      response.error_relative = std::max(response.error_relative, fields.sd(node, k));
    }
  }
  return response;
}

}  // namespace

Points node_directions(const SurfaceMesh& body, std::span<const ProbeDirection> probes,
                       double width_m) {
  const Points normal = vertex_normals(body);
  Points deviation = Points::Zero(normal.rows(), 3);
  Eigen::ArrayXd weight = Eigen::ArrayXd::Constant(normal.rows(), kNormalWeight);
  for (const ProbeDirection& probe : probes) {
    Eigen::RowVector3d outward = Eigen::RowVector3d::Zero();
    for (Eigen::Index c = 0; c < 3; ++c) {
      outward += probe.at.weight[c] * normal.row(body.triangle(probe.at.triangle, c));
    }
    // Deviations of the probes' directions from the normal are averaged with Gaussian
    // weights of the distance. The constant kNormalWeight lets far nodes keep their
    // normal.
    const Eigen::RowVector3d off = probe.direction.transpose() - outward.normalized();
    const Eigen::RowVector3d p = position_m(body, probe.at).transpose();
    const Eigen::ArrayXd w =
        (-(body.position_m.rowwise() - p).rowwise().squaredNorm().array() /
         (2.0 * width_m * width_m))
            .exp();
    deviation += w.matrix() * off;
    weight += w;
  }
  Points result = normal + weight.inverse().matrix().asDiagonal() * deviation;
  result.rowwise().normalize();
  return result;
}

ResponseDatabase surface_database(const SurfaceMesh& body, const ToolShape& tool,
                                  const Points& direction,
                                  const SurfaceFields& fields) {
  check(tool);
  ResponseDatabase database;
  database.body = body;
  database.normal = vertex_normals(body);
  std::vector<NodeResponse> responses;
  for (Eigen::Index i = 0; i < body.position_m.rows(); ++i) {
    responses.push_back(response_of(fields, i, direction.row(i)));
  }
  ResponseTable table = make_table(tool, responses);
  const auto samples = static_cast<std::size_t>(fields.depth_m.size() + 1);
  table.force_errors_n.assign(table.force_n.size(), 0.0);
  for (std::size_t s = 0; s < table.force_n.size(); ++s) {
    if (s % samples > 0) {
      table.force_errors_n[s] =
          table.force_n[s] * fields.sd(static_cast<Eigen::Index>(s / samples),
                                       static_cast<Eigen::Index>(s % samples - 1));
    }
  }
  database.tools.push_back(std::move(table));
  return database;
}

std::size_t straightened(const SurfaceFields& fields) {
  std::size_t count = 0;
  for (Eigen::Index i = 0; i < fields.log_force.rows(); ++i) {
    bool falls = false;
    for (Eigen::Index k = 1; k < fields.log_force.cols(); ++k) {
      falls = falls || fields.log_force(i, k) < fields.log_force(i, k - 1);
    }
    count += falls ? 1 : 0;
  }
  return count;
}

}  // namespace palpate
