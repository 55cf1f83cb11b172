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

nlohmann::ordered_json to_json(const std::vector<FitFlag>& flags) {
  auto list = nlohmann::ordered_json::array();
  for (const FitFlag flag : flags) {
    list.push_back(flag_name(flag));
  }
  return list;
}

}  // namespace palpate
