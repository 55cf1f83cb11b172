#include "fitting/session/press_fit.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "fitting/curve/fit_rating.h"
#include "fitting/curve/parameter_json.h"
#include "fitting/session/batch.h"
#include "fitting/session/corrections_report.h"
#include "fitting/session/relaxation_json.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

nlohmann::ordered_json curve_json(const FamilyChoice& choice) {
  if (choice.fits.empty()) {
    return nullptr;
  }
  const FamilyFit& best = choice.fits.front();
  nlohmann::ordered_json json{
      {"family", best.family}, {"parameters", to_json(best.parameters)},
      {"rms_n", best.rms_n},   {"missed_rms_n", best.misfit.missed_rms},
      {"misses", best.misses}, {"features", nlohmann::json::array()}};
  for (const CurveFeature& feature : choice.features) {
    json["features"].push_back(to_json(feature));
  }
  return json;
}

}  // namespace

PressFit fit_press(const Measurement& press, const PressFitOptions& options) {
  PressFit fit;
  fit.samples = press.force_n.size();
  fit.frame = options.frame;
  CorrectedPress corrected = correct_press(
      press, fit.frame ? &fit.frame->frame : nullptr, options.range, options.baseline);
  model_adhesion(options.indenter, corrected);
  fit.corrections = corrected.corrections;
  fit.approach = corrected.approach;
  fit.contact = corrected.contact;
  const std::vector<std::string> all(kFamilyNames.begin(), kFamilyNames.end());
  fit.choice =
      fit_families(fit.approach, fit.contact, all, "aicc", {.cross_validate = false});
  fit.flags = fit.contact.flags;
  take_misfit(fit.choice, fit.flags);
  fit.modulus = corrected_modulus(corrected, options.indenter);
  for (const FitFlag flag : fit.modulus.flags) {
    if (std::find(fit.flags.begin(), fit.flags.end(), flag) == fit.flags.end()) {
      fit.flags.push_back(flag);
    }
  }
  return fit;
}

const FamilyFit& best_of(const PressFit& fit) {
  if (fit.choice.fits.empty()) {
    throw NumericalError("empty run: the force never leaves the noise, no response");
  }
  return fit.choice.fits.front();
}

nlohmann::ordered_json to_json(const PressFit& fit, const Indenter& indenter) {
  nlohmann::ordered_json json;
  json["family"] = fit.contact.family;
  json["parameters"] = to_json(fit.contact.parameters);
  json["contact_point_m"] = fit.contact.contact.m;
  json["contact_point_sd_m"] = fit.contact.contact.sd_m;
  json["rms_n"] = fit.contact.rms_n;
  json["curve"] = curve_json(fit.choice);
  json["flags"] = to_json(fit.flags);
  json["youngs_modulus_pa"] = fit.modulus.youngs_modulus_pa;
  json["youngs_modulus_sd_pa"] = fit.modulus.sd_pa;
  json["youngs_modulus_refused"] = fit.modulus.refused;
  json["poissons_ratio"] = indenter.poissons_ratio;
  json["mean_stiffness_n_per_m"] = fit.contact.mean_stiffness_n_per_m;
  json["depth_max_m"] = fit.contact.depth_max_m;
  json["noise_sd_n"] = fit.choice.noise_sd_n;
  json["press_work_j"] = fit.approach.press_work_j;
  json["release_work_j"] = fit.approach.release_work_j;
  json["samples"] = fit.samples;
  json["samples_used"] = fit.contact.samples_used;
  json["outliers"] = fit.contact.outliers;
  json["spikes"] = fit.approach.spikes;
  json["hold_samples"] = fit.approach.hold_samples;
  json["retract_samples"] = fit.approach.retract_samples;
  json["frame"] = nullptr;
  if (fit.frame) {
    json["frame"] = {{"stiffness_n_per_m", fit.frame->frame.stiffness_n_per_m},
                     {"stiffness_sd_n_per_m", fit.frame->frame.stiffness_sd_n_per_m},
                     {"linear", fit.frame->frame.linear}};
  }
  json["corrections"] = corrections_json(fit.corrections, indenter);
  json["seconds"] = fit.contact.seconds;
  if (fit.relaxation) {
    json["relaxation"] = relaxation_json(*fit.relaxation);
  }
  return json;
}

}  // namespace palpate
