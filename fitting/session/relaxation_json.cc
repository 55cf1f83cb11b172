#include "fitting/session/relaxation_json.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json joint_json(const JointRelaxation& joint) {
  if (!joint.refused.empty()) {
    return {{"refused", joint.refused}};
  }
  Json json{{"g_inf", joint.g_inf}, {"g_inf_sd", joint.g_inf_sd}};
  for (const RelaxationTerm& term : joint.terms) {
    json["terms"].push_back({{"g", term.g},
                             {"g_sd", term.g_sd},
                             {"tau_s", term.tau_s},
                             {"tau_sd_s", term.tau_sd_s},
                             {"not_claimed", term.not_claimed}});
  }
  json["curve"] = {{"family", joint.curve},
                   {"displacement_m", joint.displacement_m},
                   {"force_n", joint.force_n},
                   {"force_sd_n", joint.force_sd_n}};
  json.update({{"seen_from_s", joint.seen_from_s},
               {"baseline_n", joint.baseline_n},
               {"rms_relative", joint.rms_relative},
               {"samples", joint.samples},
               {"holds", joint.holds},
               {"holds_used", joint.holds_used},
               {"release", joint.release},
               {"release_rms_relative", joint.release_rms_relative}});
  return json;
}

}  // namespace

Json relaxation_json(const Relaxation& r) {
  if (!r.refused.empty()) {
    return {{"refused", r.refused}};
  }
  return {{"force_n", r.force_n},
          {"g_inf", r.g_inf},
          {"g", r.g},
          {"tau_s", r.tau_s},
          {"tau_sd_s", r.tau_sd_s},
          {"end_over_start", r.end_over_start},
          {"rms_relative", r.rms_relative},
          {"seconds", r.seconds},
          {"speed_m_per_s", r.speed_m_per_s},
          {"press_and_hold", joint_json(r.joint)}};
}

}  // namespace palpate
