#include "runtime/view/view_curve.h"

#include <array>
#include <cstddef>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

Json at_node(const Points& points, std::int32_t node) {
  return {points(node, 0), points(node, 1), points(node, 2)};
}

std::string_view origin_name(std::uint8_t origin) {
  constexpr std::array<std::string_view, 4> kNames{"none", "simulated", "interpolated",
                                                   "measured"};
  return origin < kNames.size() ? kNames[origin] : "unknown";
}

Json flag_names(std::uint8_t flags) {
  constexpr std::array<std::string_view, kResponseFlags> kNames{
      "falling curve", "force capped", "coarse contact", "error over budget",
      "failed",        "extrapolated", "truncated path", "near-singular load path"};
  Json names = Json::array();
  for (std::size_t bit = 0; bit < kNames.size(); ++bit) {
    if ((flags >> bit & 1U) != 0U) {
      names.push_back(kNames[bit]);
    }
  }
  return names;
}

}  // namespace

std::string curve_text(const ResponseDatabase& database, const ResponseTable& table,
                       std::int32_t node) {
  if (node < 0 || node >= table.nodes()) {
    throw InputError(
        fmt::format("node {} is not there, the body has {}", node, table.nodes()));
  }
  const auto i = static_cast<std::size_t>(node);
  const CurveView curve = table.curve(node);
  Json json{{"type", "curve"},
            {"node", node},
            {"position_m", at_node(database.body.position_m, node)},
            {"normal", at_node(database.normal, node)},
            {"direction", at_node(table.direction, node)},
            {"direction_spread_rad", table.direction_spread_rad[i]},
            {"origin", origin_name(table.origin[i])},
            {"flags", flag_names(table.flags[i])},
            {"error_relative", table.error_relative[i]},
            {"stiffness_max_n_per_m", table.stiffness_max_n_per_m[i]},
            {"touch_offset_m", table.touch_offset_m[i]},
            {"depth_m", Json::array()},
            {"force_n", Json::array()}};
  constexpr int kPoints = 60;  // of the cubic between its samples
  for (int k = 0; k <= kPoints && !curve.depth_m.empty(); ++k) {
    const double depth_m = curve.depth_max_m() * k / kPoints;
    json["depth_m"].push_back(depth_m);
    json["force_n"].push_back(curve.at(depth_m).force_n);
  }
  json["sample_depth_m"] = curve.depth_m;
  json["sample_force_n"] = curve.force_n;
  return json_text(json);
}

}  // namespace palpate
