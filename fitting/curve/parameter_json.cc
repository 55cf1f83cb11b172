#include "fitting/curve/parameter_json.h"

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

}  // namespace palpate
