#include "fitting/session/corrections_report.h"

#include <cmath>

#include <fmt/format.h>

namespace palpate {
namespace {

double plane(const Indenter& indenter) {
  return 1.0 - indenter.poissons_ratio * indenter.poissons_ratio;
}

std::string jkr_text(const JkrFit& jkr, const Indenter& indenter) {
  if (!jkr.refused.empty()) {
    return fmt::format("JKR not fitted: {}. ", jkr.refused);
  }
  return fmt::format(
      "JKR fitted to the approach: contact point {:.6g} +- {:.2g} mm, Young's modulus "
      "{:.4g} +- {:.2g} Pa, work of adhesion {:.3g} +- {:.2g} J/m^2. ",
      1e3 * jkr.contact_point_m, 1e3 * jkr.contact_point_sd_m,
      plane(indenter) * jkr.reduced_modulus_pa,
      plane(indenter) * jkr.reduced_modulus_sd_pa, jkr.work_j_per_m2,
      jkr.work_sd_j_per_m2);
}

nlohmann::ordered_json jkr_json(const JkrFit& jkr, const Indenter& indenter) {
  return {{"refused", jkr.refused},
          {"contact_point_m", jkr.contact_point_m},
          {"contact_point_sd_m", jkr.contact_point_sd_m},
          {"youngs_modulus_pa", plane(indenter) * jkr.reduced_modulus_pa},
          {"youngs_modulus_sd_pa", plane(indenter) * jkr.reduced_modulus_sd_pa},
          {"work_of_adhesion_j_per_m2", jkr.work_j_per_m2},
          {"work_of_adhesion_sd_j_per_m2", jkr.work_sd_j_per_m2},
          {"rms_n", jkr.rms_n}};
}

}  // namespace

std::string corrections_text(const PressCorrections& corrections,
                             const Indenter& indenter) {
  const auto& [frame, drift, adhesion, jkr] = corrections;
  std::string text;
  if (frame.deflection_m > 0.0) {
    text += fmt::format(
        "The frame takes {:.3g} mm at the largest force, {:.2g} % of the "
        "travel in contact",
        1e3 * frame.deflection_m, 100.0 * frame.share);
    text +=
        std::isfinite(frame.depth_sd_m)
            ? fmt::format("; its uncertainty moves the largest depth by {:.2g} mm. ",
                          1e3 * frame.depth_sd_m)
            : ". ";
  }
  if (drift.refused.empty() && drift.significant) {
    text += fmt::format("The force drifts by {:.3g} +- {:.2g} N/s; taken off. ",
                        drift.n_per_s, drift.sd_n_per_s);
  } else if (drift.leaps) {
    text += "Drift with time: " + drift.refused + ". ";
  }
  if (adhesion.seen()) {
    text +=
        fmt::format("Pull-off {:.3g} N, jump into contact {:.3g} N, noise {:.2g} N. ",
                    adhesion.pull_off_n, adhesion.snap_in_n, adhesion.noise_n);
  }
  if (adhesion.pulls_off && indenter.shape == "sphere") {
    text += fmt::format(
        "Work of adhesion {:.3g} J/m^2 (JKR: soft and large), {:.3g} J/m^2 (DMT: hard "
        "and small). ",
        jkr_work_of_adhesion(adhesion.pull_off_n, indenter.radius_m),
        dmt_work_of_adhesion(adhesion.pull_off_n, indenter.radius_m));
  }
  return jkr ? text + jkr_text(*jkr, indenter) : text;
}

nlohmann::ordered_json corrections_json(const PressCorrections& corrections,
                                        const Indenter& indenter) {
  const auto& [frame, drift, adhesion, jkr] = corrections;
  nlohmann::ordered_json json{{"frame_deflection_m", frame.deflection_m},
                              {"frame_share", frame.share},
                              {"frame_depth_sd_m", frame.depth_sd_m},
                              {"time_drift_n_per_s", drift.n_per_s},
                              {"time_drift_sd_n_per_s", drift.sd_n_per_s},
                              {"time_drift_removed", drift.significant},
                              {"time_drift_refused", drift.refused},
                              {"pull_off_n", adhesion.pull_off_n},
                              {"snap_in_n", adhesion.snap_in_n},
                              {"pull_off_noise_n", adhesion.noise_n},
                              {"adhesion", adhesion.seen()}};
  if (adhesion.pulls_off && indenter.shape == "sphere") {
    json["work_of_adhesion_jkr_j_per_m2"] =
        jkr_work_of_adhesion(adhesion.pull_off_n, indenter.radius_m);
    json["work_of_adhesion_dmt_j_per_m2"] =
        dmt_work_of_adhesion(adhesion.pull_off_n, indenter.radius_m);
  }
  if (jkr) {
    json["jkr"] = jkr_json(*jkr, indenter);
  }
  return json;
}

}  // namespace palpate
