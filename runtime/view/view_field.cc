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
#include "formats/response/displaced_surface.h"

namespace palpate {
std::string field_text(const ResponseTable& table, std::int32_t node) {
  if (node < 0 || node >= table.nodes()) {
    throw InputError(
        fmt::format("node {} is not there, the body has {}", node, table.nodes()));
  }
  const DisplacementField& field = table.displacement;
  nlohmann::json json{{"type", "field"}, {"node", node}, {"depth_m", nullptr}};
  const Eigen::Index row = deepest_field(field, node);
  if (row < 0) {
    return json_text(json);
  }
  const PressedField whole{row, field.depth_m[static_cast<std::size_t>(row)]};
  const Points moved_m = displaced_m(field, std::span(&whole, 1));
  constexpr double kSteps = std::numeric_limits<std::int16_t>::max();
  const double scale_m = moved_m.cwiseAbs().maxCoeff() / kSteps;
  std::vector<std::int16_t> steps;
  steps.reserve(static_cast<std::size_t>(moved_m.size()));
  for (const double x_m : moved_m.reshaped<Eigen::RowMajor>()) {
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
