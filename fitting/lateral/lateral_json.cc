#include "fitting/lateral/lateral_json.h"

#include <cmath>

#include "fitting/curve/parameter_json.h"

namespace palpate {
namespace {

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value)
                              : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json loss_json(const RunFit& run) {
  nlohmann::ordered_json json;
  json["measured_j"] = to_json(run.loss_j);
  json["modelled_j"] = to_json(run.modelled_loss_j);
  json["cycles"] = nlohmann::ordered_json::array();
  for (const LoopCycle& cycle : run.cycle) {
    json["cycles"].push_back({{"amplitude_m", cycle.amplitude_m},
                              {"measured_j", cycle.measured_j},
                              {"standard_deviation_j", cycle.sd_j},
                              {"modelled_j", cycle.modelled_j}});
  }
  return json;
}

nlohmann::ordered_json lateral_run_json(const RunFit& run) {
  nlohmann::ordered_json json;
  json["name"] = run.name;
  json["depth_m"] = number_or_null(run.depth_m);
  json["normal_n"] = number_or_null(run.normal_n);
  json["stiffness_n_per_m"] = to_json(run.stiffness_n_per_m);
  json["slip_force_n"] = to_json(run.slip_force_n);
  json["friction"] = to_json(run.friction);
  json["presliding_m"] = to_json(run.presliding_m);
  json["loss"] = loss_json(run);
  json["offset_n"] = run.offset_n;
  json["drift_n"] = to_json(run.drift_n);
  json["zero_m"] = run.zero_m;
  json["rms_n"] = run.rms_n;
  json["samples"] = {{"stick", run.samples.sticks}, {"slide", run.samples.slides()}};
  json["notes"] = run.notes;
  return json;
}

nlohmann::ordered_json law_json(const LawFit& fit, double deviance) {
  nlohmann::ordered_json json;
  json["law"] = law_name(fit.law);
  json["rms_n"] = fit.rms_n;
  json["deviance"] = deviance;
  json["friction"] = to_json(fit.friction);
  json["presliding_m"] = to_json(fit.presliding_m);
  json["stiffness_n_per_m"] = nlohmann::ordered_json::array();
  for (const RunFit& run : fit.runs) {
    json["stiffness_n_per_m"].push_back(to_json(run.stiffness_n_per_m));
  }
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const LateralFit& fit) {
  nlohmann::ordered_json json;
  json["law"] = law_name(fit.better.law);
  json["laws_differ"] = fit.laws_differ();
  json["friction"] = to_json(fit.better.friction);
  json["frictions_differ"] = fit.better.frictions_differ;
  json["presliding_m"] = to_json(fit.better.presliding_m);
  json["runs"] = nlohmann::ordered_json::array();
  for (const RunFit& run : fit.better.runs) {
    json["runs"].push_back(lateral_run_json(run));
  }
  json["laws"] = {law_json(fit.better, 0.0), law_json(fit.other, fit.deviance)};
  return json;
}

nlohmann::ordered_json to_json(const PlaneFit& fit) {
  nlohmann::ordered_json json;
  json["name"] = fit.name;
  json["law"] = law_name(fit.law);
  json["deviance"] = fit.deviance;
  json["depth_m"] = number_or_null(fit.depth_m);
  json["normal_n"] = number_or_null(fit.normal_n);
  json["stiffness_n_per_m"] = {{"xx", to_json(fit.xx_n_per_m)},
                               {"xy", to_json(fit.xy_n_per_m)},
                               {"yy", to_json(fit.yy_n_per_m)}};
  json["slip_force_n"] = to_json(fit.slip_force_n);
  json["friction"] = to_json(fit.friction);
  json["presliding_m"] = to_json(fit.presliding_m);
  json["rms_n"] = fit.rms_n;
  json["other_rms_n"] = fit.other_rms_n;
  return json;
}

}  // namespace palpate
