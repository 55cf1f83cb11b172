#include "fitting/insertion/insertion_json.h"

#include <cmath>

#include "fitting/curve/parameter_json.h"

namespace palpate {
namespace {

nlohmann::ordered_json rupture_json(const FittedRupture& rupture) {
  nlohmann::ordered_json json;
  json["pass"] = rupture.pass + 1;
  json["measured_m"] = rupture.measured_m;
  json["depth_m"] = to_json(rupture.depth_m);
  json["boundary_m"] = to_json(rupture.boundary_m);
  json["force_n"] = to_json(rupture.force_n);
  json["fall_n"] = rupture.fall_n;
  json["fall_deviations"] = rupture.deviations;
  return json;
}

nlohmann::ordered_json layer_json(const FittedLayer& layer) {
  nlohmann::ordered_json json;
  json["cutting_n"] = to_json(layer.cutting_n);
  json["friction_n_per_m"] = to_json(layer.friction_n_per_m);
  json["start_n"] = to_json(layer.start_n);
  json["slope_n_per_m"] = to_json(layer.slope_n_per_m);
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const NeedleFit& fit) {
  nlohmann::ordered_json json;
  json["samples"] = fit.samples;
  json["converged"] = fit.converged;
  json["curve"] = {{"coefficient_n_per_m_to_n", to_json(fit.coefficient)},
                   {"exponent", to_json(fit.exponent)},
                   {"contact_point_m", to_json(fit.contact_m)}};
  json["ruptures"] = nlohmann::ordered_json::array();
  for (const FittedRupture& rupture : fit.ruptures) {
    json["ruptures"].push_back(rupture_json(rupture));
  }
  json["layers"] = nlohmann::ordered_json::array();
  for (const FittedLayer& layer : fit.layers) {
    json["layers"].push_back(layer_json(layer));
  }
  json["static_ratio"] = to_json(fit.static_ratio);
  json["presliding_n_per_m"] = to_json(fit.presliding_n_per_m);
  json["baselines"] = nlohmann::ordered_json::array();
  for (const NeedleBaseline& baseline : fit.baselines) {
    json["baselines"].push_back(
        {{"offset_n", baseline.offset_n}, {"drift_n", to_json(baseline.drift_n)}});
  }
  json["rms_n"] = fit.rms_n;
  json["free_rms_n"] = std::isfinite(fit.free_rms_n)
                           ? nlohmann::ordered_json(fit.free_rms_n)
                           : nlohmann::ordered_json(nullptr);
  json["misses"] = fit.misses;
  json["falls_dropped"] = fit.dropped;
  json["notes"] = fit.notes;
  return json;
}

}  // namespace palpate
