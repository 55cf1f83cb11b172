#include "fitting/curve/fitted_response.h"

#include <vector>

#include "formats/base/error.h"
#include "formats/base/sha256.h"

namespace palpate {
namespace {

constexpr int kIntervals = 48;
constexpr double kHalfWidth = 0.05;  // [m]

}  // namespace

NodeResponse fitted_response(const ContactFit& fit, const Eigen::Vector3d& direction) {
  if (fit.has(FitFlag::kEmptyRun)) {
    throw NumericalError("empty run: the force never leaves the noise, no response");
  }
  NodeResponse response;
  response.direction = direction;
  response.origin = ResponseOrigin::kMeasured;
  for (int i = 0; i <= kIntervals; ++i) {
    const double t = static_cast<double>(i) / kIntervals;
    const double d = fit.depth_max_m * t * t;  // a power law bends most at its start
    response.depth_m.push_back(d);
    response.force_n.push_back(contact_force_n(fit, d));
  }
  response.error_relative = fit.rms_n / response.force_n.back();
  return response;
}

ResponseDatabase sample_patch(const ContactFit& fit, const Measurement& measurement,
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
  database.tools.push_back(make_table(tool, std::vector<NodeResponse>(4, response)));
  database.measurement = measurement;
  database.provenance.writer = "palpate-fit " PALPATE_VERSION;
  database.provenance.source_file = source.filename().string();
  database.provenance.source_sha256 = sha256_of_file(source);
  database.provenance.left_out =
      "nothing between the measured point and the rest of the sample: every node has "
      "the measured response";
  return database;
}

}  // namespace palpate
