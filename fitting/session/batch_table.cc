// The batch as CSV for people's spreadsheets and as JSON for their programs.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fitting/curve/parameter_json.h"
#include "fitting/session/batch.h"
#include "fitting/session/corrections_report.h"
#include "fitting/session/csv_cell.h"
#include "fitting/session/mean_curves.h"
#include "fitting/session/relaxation_json.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

std::string joined_flags(const RunResult& run) {
  std::string text;
  for (const FitFlag flag : run.flags) {
    text += (text.empty() ? "" : " ") + std::string(flag_name(flag));
  }
  return text;
}

std::string joined_words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

// The last columns: specimen, and what was taken off for the machine's sake.
std::string correction_cells(const RunResult& run) {
  const PressCorrections& c = run.corrections;
  std::string cells = "," + csv_text(run.specimen);
  for (const double value :
       {c.frame.deflection_m, c.frame.share, c.frame.depth_sd_m, c.drift.n_per_s,
        c.drift.sd_n_per_s, c.adhesion.pull_off_n, c.adhesion.noise_n}) {
    cells += "," + csv_number(value);
  }
  return cells;
}

std::string csv_row(const RunResult& run) {
  const RatingFeatures& f = run.rating.features;
  std::string row = fmt::format(
      "{},{},{},{},{},{}", csv_text(run.name), csv_text(run.point), run.press,
      verdict_name(run.rating.verdict), csv_number(run.rating.score),
      csv_text(joined_words(run.rating.gates)));
  const FamilyFit* best = run.best();
  if (best == nullptr) {
    return row + std::string(21, ',') + csv_text(run.bad) + "," +
           csv_text(run.specimen) + ",,,,,,,\n";
  }
  const auto& x = run.choice.displacement_m;
  const auto [from, to] = std::minmax_element(x.begin(), x.end());
  for (const double value : {best->contact_point_m, best->contact_point_sd_m, *from,
                             *to, best->depth_max_m}) {
    row += "," + csv_number(value);
  }
  row += "," + best->family;
  for (const double value :
       {best->rms_n, run.choice.noise_sd_n, run.contact.mean_stiffness_n_per_m,
        run.modulus.youngs_modulus_pa, run.modulus.sd_pa, run.loop.loss_factor,
        run.relaxation.refused.empty() ? run.relaxation.g_inf : std::nan(""),
        f.rms_over_noise, f.runs_z, f.near_contact_over_noise, f.repeat_scatter,
        f.correlation_max}) {
    row += "," + csv_number(value);
  }
  return row + "," + joined_flags(run) + "," + csv_text(run.modulus.refused) + "," +
         csv_text(run.bad) + correction_cells(run) + "\n";
}

Json family_json(const FamilyFit& fit) {
  return {{"family", fit.family},
          {"parameters", to_json(fit.parameters)},
          {"contact_point_m", fit.contact_point_m},
          {"contact_point_sd_m", fit.contact_point_sd_m},
          {"depth_max_m", fit.depth_max_m},
          {"rms_n", fit.rms_n},
          {"cross_rms_n", fit.cross_rms_n},
          {"aicc", fit.aicc},
          {"bic", fit.bic},
          {"missed_rms_n", fit.misfit.missed_rms},
          {"misses", fit.misses},
          {"free_parameters", fit.free_parameters},
          {"at_bound", fit.at_bound},
          {"converged", fit.converged}};
}

Json loop_json(const LoopFit& loop) {
  Json json{{"press_work_j", loop.press_work_j},
            {"release_work_j", loop.release_work_j},
            {"loss_factor", loop.loss_factor},
            {"refused", loop.refused}};
  if (loop.refused.empty()) {
    json.update({{"coefficient", loop.coefficient},
                 {"exponent", loop.exponent},
                 {"lambda_s_per_m", loop.lambda_s_per_m},
                 {"lambda_sd_s_per_m", loop.lambda_sd_s_per_m},
                 {"rms_n", loop.rms_n}});
  }
  return json;
}

Json rating_json(const Rating& rating) {
  const RatingFeatures& f = rating.features;
  return {{"verdict", verdict_name(rating.verdict)},
          {"score", rating.score},
          {"gates", rating.gates},
          {"rms_over_noise", f.rms_over_noise},
          {"runs_z", f.runs_z},
          {"near_contact_over_noise", f.near_contact_over_noise},
          {"repeat_scatter", f.repeat_scatter},
          {"correlation_max", f.correlation_max},
          {"samples_in_contact", f.samples_in_contact}};
}

Json cycle_json(const CycleSummary& cycle) {
  return {{"bad", cycle.bad},
          {"peak_force_n", cycle.peak_force_n},
          {"press_work_j", cycle.press_work_j},
          {"loss_j", cycle.loss_j},
          {"loss_factor", cycle.loss_factor},
          {"contact_point_m", cycle.contact_point_m},
          {"contact_point_sd_m", cycle.contact_point_sd_m},
          {"contact_shift_m", cycle.contact_shift_m},
          {"contact_shift_sd_m", cycle.contact_shift_sd_m}};
}

Json mean_json(const MeanCurve& mean) {
  Json json{{"mean", mean.name}, {"runs", mean.runs}};
  json["points"] = Json::array();
  for (std::size_t i = 0; i < mean.depth_m.size(); ++i) {
    const RandomEffects& e = mean.force_n[i];
    json["points"].push_back({{"depth_m", mean.depth_m[i]},
                              {"force_n", e.mean},
                              {"mean_sd_n", e.mean_sd},
                              {"lower_95_n", e.lower},
                              {"upper_95_n", e.upper},
                              {"degrees_of_freedom", e.degrees_of_freedom},
                              {"repeat_sd_n", e.repeat_sd},
                              {"between_points_sd_n", e.point_sd},
                              {"between_specimens_sd_n", e.specimen_sd}});
  }
  return json;
}

Json machine_json(const Session& session, const BatchReport& report) {
  Json json{{"frame", nullptr}, {"registration", nullptr}};
  if (report.frame) {
    const FrameRun& run = *report.frame;
    json["frame"] = {{"stiffness_n_per_m", run.frame.stiffness_n_per_m},
                     {"stiffness_sd_n_per_m", run.frame.stiffness_sd_n_per_m},
                     {"linear", run.frame.linear},
                     {"force_n", run.frame.force_n},
                     {"deflection_m", run.frame.deflection_m},
                     {"samples", run.samples},
                     {"rms_n", run.rms_n}};
  }
  if (session.registration) {
    const Registration& r = *session.registration;
    Json& registration = json["registration"] = {
        {"rms_m", r.rms_m}, {"localisation_sd_m", r.localisation_sd_m}};
    for (Eigen::Index i = 0; i < 3; ++i) {
      registration["rotation"].push_back(
          {r.rotation(i, 0), r.rotation(i, 1), r.rotation(i, 2)});
      registration["shift_m"].push_back(r.shift_m[i]);
    }
    for (std::size_t i = 0; i < r.pairs.size(); ++i) {
      registration["pairs"].push_back(
          {{"name", r.pairs[i].name}, {"residual_m", r.residual_m[i]}});
    }
  }
  return json;
}

Json run_json(const RunResult& run, const Session& session) {
  Json json{{"run", run.name},          {"point", run.point},
            {"specimen", run.specimen}, {"press", run.press},
            {"presses", run.presses},   {"rating", rating_json(run.rating)}};
  json["bad"] = run.bad;
  json["seconds"] = run.seconds;
  json["flags"] = to_json(run.flags);
  for (const CycleSummary& cycle : run.cycles) {
    json["cycles"].push_back(cycle_json(cycle));
  }
  if (session.registration && run.position_m) {
    json["registration_error_m"] =
        registration_error_m(*session.registration, *run.position_m);
  }
  const FamilyFit* best = run.best();
  if (best == nullptr) {
    return json;
  }
  json.update(family_json(*best));
  json["runners_up"] = Json::array();
  for (std::size_t i = 1; i < run.choice.fits.size(); ++i) {
    json["runners_up"].push_back(family_json(run.choice.fits[i]));
  }
  const auto& x = run.choice.displacement_m;
  const auto [from, to] = std::minmax_element(x.begin(), x.end());
  json["fit_from_m"] = *from;
  json["fit_to_m"] = *to;
  json["samples_used"] = x.size();
  json["outliers"] = run.choice.outliers;
  json["spikes"] = run.approach.spikes;
  json["noise_sd_n"] = run.choice.noise_sd_n;
  json["independent_samples"] = run.choice.independent_samples;
  json["features"] = Json::array();
  for (const CurveFeature& feature : run.choice.features) {
    json["features"].push_back(to_json(feature));
  }
  json["mean_stiffness_n_per_m"] = run.contact.mean_stiffness_n_per_m;
  json["youngs_modulus_pa"] = run.modulus.youngs_modulus_pa;
  json["youngs_modulus_sd_pa"] = run.modulus.sd_pa;
  json["youngs_modulus_errors_pa"] = Json::object();
  for (const ModulusError& error : run.modulus.error) {
    json["youngs_modulus_errors_pa"][error.name] = error.sd_pa;
  }
  json["youngs_modulus_law"] = run.modulus.law;
  json["youngs_modulus_refused"] = run.modulus.refused;
  json["corrections"] = corrections_json(run.corrections, session.indenter);
  json["relaxation"] = relaxation_json(run.relaxation);
  json["loop"] = loop_json(run.loop);
  json["segments"] = Json::array();
  for (const Segment& s : run.segments) {
    json["segments"].push_back(
        {{"kind", segment_name(s.kind)}, {"begin", s.begin}, {"end", s.end}});
  }
  return json;
}

}  // namespace

std::string batch_csv(const Session&, const BatchReport& report) {
  std::string text =
      "run,point,press,verdict,score,gates,contact_point_m,contact_point_sd_m,fit_from_"
      "m,"
      "fit_to_m,depth_max_m,family,rms_n,noise_sd_n,mean_stiffness_n_per_m,"
      "youngs_modulus_pa,youngs_modulus_sd_pa,loss_factor,relaxation_g_inf,"
      "rms_over_noise,runs_z,near_contact_over_noise,repeat_scatter,correlation_max,"
      "flags,modulus_refused,bad,specimen,frame_deflection_m,frame_share,"
      "frame_depth_sd_m,drift_n_per_s,drift_sd_n_per_s,pull_off_n,pull_off_noise_n\n";
  for (const RunResult& run : report.runs) {
    text += csv_row(run);
  }
  return text;
}

std::string batch_json(const Session& session, const BatchReport& report) {
  Json json{{"session", session.name}, {"criterion", session.fit.criterion}};
  std::size_t bad = 0, use = 0, check = 0;
  for (const RunResult& run : report.runs) {
    bad += run.bad.empty() ? 0 : 1;
    use += run.rating.verdict == Verdict::kUse ? 1 : 0;
    check += run.rating.verdict == Verdict::kCheck ? 1 : 0;
  }
  json["runs"] = report.runs.size();
  json["use"] = use;
  json["check"] = check;
  json["skip"] = report.runs.size() - use - check;
  json["bad"] = bad;
  json["seconds"] = report.seconds;
  json["machine"] = machine_json(session, report);
  json["results"] = Json::array();
  for (const RunResult& run : report.runs) {
    json["results"].push_back(run_json(run, session));
  }
  json["mean_curves"] = Json::array();
  const MeanCurves means = mean_curves(report);
  json["means_left_out"] = means.left_out;
  json["means_from_first_sample"] = means.from_first_sample;
  for (const MeanCurve& mean : means.curves) {
    json["mean_curves"].push_back(mean_json(mean));
  }
  return json_text(json);
}

}  // namespace palpate
