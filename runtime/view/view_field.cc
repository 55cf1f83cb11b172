#include "runtime/view/view_field.h"

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/report/html_page.h"

namespace palpate {
namespace {

// Row of the deepest field of the node; -1: none.
Eigen::Index row_of(const DisplacementField& field, std::int32_t node) {
  Eigen::Index best = -1;
  double deepest_m = 0.0;
  for (std::size_t j = 0; j < field.node.size(); ++j) {
    if (field.node[j] == node && field.depth_m[j] > deepest_m) {
      deepest_m = field.depth_m[j];
      best = static_cast<Eigen::Index>(j);
    }
  }
  return best;
}

// (3 n) [m]. In double precision: singles of a foreign file may overflow.
Eigen::VectorXd displacement_m(const DisplacementField& field, Eigen::Index row) {
  const Eigen::VectorXd coefficient_m =
      field.coefficient.row(row).transpose().cast<double>();
  Eigen::VectorXd moved_m(field.basis.rows());
  for (Eigen::Index i = 0; i < moved_m.size(); ++i) {
    moved_m[i] = field.basis.row(i).transpose().cast<double>().dot(coefficient_m);
  }
  return moved_m;
}

}  // namespace

std::string field_text(const ResponseTable& table, std::int32_t node) {
  if (node < 0 || node >= table.nodes()) {
    throw InputError(
        fmt::format("node {} is not there, the body has {}", node, table.nodes()));
  }
  const DisplacementField& field = table.displacement;
  nlohmann::json json{{"type", "field"}, {"node", node}, {"depth_m", nullptr}};
  const Eigen::Index row = row_of(field, node);
  if (row < 0) {
    return json_text(json);
  }
  const Eigen::VectorXd moved_m = displacement_m(field, row);
  constexpr double kSteps = std::numeric_limits<std::int16_t>::max();
  const double scale_m = moved_m.cwiseAbs().maxCoeff() / kSteps;
  std::vector<std::int16_t> steps;
  steps.reserve(static_cast<std::size_t>(moved_m.size()));
  for (const double x_m : moved_m) {
    steps.push_back(scale_m > 0.0
                        ? static_cast<std::int16_t>(std::lround(x_m / scale_m))
                        : std::int16_t{0});
  }
  json["depth_m"] = field.depth_m[static_cast<std::size_t>(row)];
  json["error_relative"] = field.error_relative[static_cast<std::size_t>(row)];
  json["scale_m"] = scale_m;
  json["displacement"] = base64(std::as_bytes(std::span(steps)));
  return json_text(json);
}

}  // namespace palpate
