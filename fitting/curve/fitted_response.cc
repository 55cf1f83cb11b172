#include "fitting/curve/fitted_response.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "fitting/curve/law_error.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"
#include "formats/base/sha256.h"

namespace palpate {
namespace {

constexpr int kCurveIntervals = 48, kErrorDepths = 46;
constexpr double kDepthShareMin = 0.1, kForceShareMin = 0.1;
constexpr double kHalfWidth = 0.05;  // [m]

std::vector<double> depths_of(const FamilyFit& fit) {
  std::vector<double> depth_m;
  for (const double knot : fit.curve->knots()) {
    if (fit.length_m * knot < fit.depth_max_m * (1.0 - 1e-9)) {
      depth_m.push_back(fit.length_m * knot);
    }
  }
  if (!depth_m.empty()) {
    depth_m.push_back(fit.depth_max_m);
    return depth_m;
  }
  for (int i = 0; i <= kCurveIntervals; ++i) {
    const double t = static_cast<double>(i) / kCurveIntervals;
    depth_m.push_back(fit.depth_max_m * t * t);  // a power law bends most at its start
  }
  return depth_m;
}

double error_relative_of(const FamilyFit& fit, const NodeResponse& response) {
  Eigen::VectorXd depth_m(kErrorDepths);
  for (int k = 0; k < kErrorDepths; ++k) {
    depth_m[k] = fit.depth_max_m *
                 (kDepthShareMin + (1.0 - kDepthShareMin) * k / (kErrorDepths - 1.0));
  }
  const double most =
      *std::max_element(response.force_n.begin(), response.force_n.end());
  const Eigen::VectorXd log_sd = log_force_errors(fit, depth_m);
  const double missed = is_sure(fit.misfit, most) ? fit.misfit.missed_rms : 0.0;
  // 95 % of hypot(sd, what the law misses) over the force; small forces count as a
  // share of the largest.
  double worst = 0.0;
  for (int k = 0; k < kErrorDepths; ++k) {
    const double force = family_point(fit, depth_m[k]).force;
    const double sd = force > 0.0 ? log_sd[k] * force : 0.0;
    worst = std::max(worst,
                     std::hypot(sd, missed) / std::max(force, kForceShareMin * most));
  }
  return kNormal95 * worst;
}

}  // namespace

NodeResponse fitted_response(const FamilyFit& fit, const Eigen::Vector3d& direction) {
  NodeResponse response;
  response.direction = direction;
  response.origin = ResponseOrigin::kMeasured;
  response.depth_m = depths_of(fit);
  for (const double d : response.depth_m) {
    response.force_n.push_back(family_point(fit, d).force);
  }
  response.error_relative = error_relative_of(fit, response);
  return response;
}

ResponseDatabase sample_patch(const FamilyFit& fit, const Measurement& measurement,
                              const ToolShape& tool,
                              const std::filesystem::path& source) {
  check(tool);
  ResponseDatabase database;
  const double w = kHalfWidth;
  database.body.position_m.resize(4, 3);
  database.body.position_m << -w, -w, 0, w, -w, 0, w, w, 0, -w, w, 0;
  database.body.triangle.resize(2, 3);
  database.body.triangle << 0, 1, 2, 0, 2, 3;
  database.normal = vertex_normals(database.body);
  const NodeResponse response = fitted_response(fit, Eigen::Vector3d::UnitZ());
  if (!std::isfinite(response.error_relative)) {
    throw NumericalError(fmt::format(
        "no database of this curve: its samples do not tell the parameters of {} "
        "apart, so that its error is not known; need more samples in contact",
        fit.family));
  }
  database.tools.push_back(make_table(tool, std::vector<NodeResponse>(4, response)));
  database.measurement = measurement;
  database.provenance.writer = "palpate-fit " PALPATE_VERSION;
  if (!source.empty()) {
    database.provenance.source_file = source.filename().string();
    database.provenance.source_sha256 = sha256_of_file(source);
  }
  database.provenance.left_out =
      "nothing between the measured point and the rest of the sample: every node has "
      "the measured response";
  return database;
}

}  // namespace palpate
