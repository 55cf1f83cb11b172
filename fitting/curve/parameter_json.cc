#include "fitting/curve/parameter_json.h"

#include <cmath>

namespace palpate {

nlohmann::ordered_json to_json(const std::vector<FitParameter>& parameters) {
  auto list = nlohmann::ordered_json::array();
  for (const FitParameter& p : parameters) {
    list.push_back({{"name", p.name},
                    {"value", p.value},
                    {"unit", p.unit},
                    {"standard_deviation", p.sd},
                    {"held", p.held}});
  }
  return list;
}

nlohmann::ordered_json to_json(const CurveFeature& feature) {
  return {{"kind", feature_name(feature.kind)},
          {"depth_m", feature.depth_m},
          {"depth_end_m", feature.depth_end_m},
          {"change", feature.change},
          {"text", describe(feature)}};
}

nlohmann::ordered_json to_json(const std::vector<FitFlag>& flags) {
  auto list = nlohmann::ordered_json::array();
  for (const FitFlag flag : flags) {
    list.push_back(flag_name(flag));
  }
  return list;
}

nlohmann::ordered_json to_json(const IntervalEstimate& estimate) {
  nlohmann::ordered_json json;
  if (!estimate.refused.empty()) {
    json["value"] = nullptr;
    json["refused"] = estimate.refused;
    if (std::isfinite(estimate.above)) {
      json["above"] = estimate.above;
    }
    return json;
  }
  json["value"] = estimate.value;
  json["standard_deviation"] = estimate.sd;
  json["interval_95"] = {estimate.low, estimate.high};
  return json;
}

}  // namespace palpate
