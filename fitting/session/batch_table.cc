// The batch as CSV for people's spreadsheets and as JSON for their programs.
#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fitting/curve/parameter_json.h"
#include "fitting/session/batch.h"

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

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

// A cell with a comma, quote or line end in quotes; the quotes inside doubled. What a
// spreadsheet would run as a formula begins with an apostrophe, which it takes for
// text.
std::string quoted(std::string text) {
  if (!text.empty() &&
      std::string_view("=+-@\t\r").find(text[0]) != std::string::npos) {
    text.insert(0, 1, '\'');
  }
  if (text.find_first_of(",\"\n\r") == std::string::npos) {
    return text;
  }
  std::string safe = "\"";
  for (const char c : text) {
    safe += c == '"' ? "\"\"" : std::string(1, c);
  }
  return safe + "\"";
}

// Numbers that are not known are empty cells.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : "";
}

std::string csv_row(const RunResult& run) {
  const RatingFeatures& f = run.rating.features;
  std::string row =
      fmt::format("{},{},{},{},{},{}", quoted(run.name), quoted(run.point), run.press,
                  verdict_name(run.rating.verdict), number(run.rating.score),
                  quoted(joined(run.rating.gates)));
  const FamilyFit* best = run.best();
  if (best == nullptr) {
    return row + std::string(21, ',') + quoted(run.bad) + "\n";
  }
  const auto& x = run.choice.displacement_m;
  const auto [from, to] = std::minmax_element(x.begin(), x.end());
  for (const double value : {best->contact_point_m, best->contact_point_sd_m, *from,
                             *to, best->depth_max_m}) {
    row += "," + number(value);
  }
  row += "," + best->family;
  for (const double value :
       {best->rms_n, run.approach.noise_sd_n, run.contact.mean_stiffness_n_per_m,
        run.modulus.youngs_modulus_pa, run.modulus.sd_pa, run.loop.loss_factor,
        run.relaxation.refused.empty() ? run.relaxation.g_inf : std::nan(""),
        f.rms_over_noise, f.runs_z, f.near_contact_over_noise, f.repeat_scatter,
        f.correlation_max}) {
    row += "," + number(value);
  }
  return row + "," + joined_flags(run) + "," + quoted(run.modulus.refused) + "," +
         quoted(run.bad) + "\n";
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
          {"effective_samples", fit.effective_n},
          {"free_parameters", fit.free_parameters},
          {"at_bound", fit.at_bound},
          {"converged", fit.converged}};
}

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
               {"release", joint.release},
               {"release_rms_relative", joint.release_rms_relative}});
  return json;
}

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

Json run_json(const RunResult& run) {
  Json json{{"run", run.name},
            {"point", run.point},
            {"press", run.press},
            {"presses", run.presses},
            {"rating", rating_json(run.rating)}};
  json["bad"] = run.bad;
  json["seconds"] = run.seconds;
  json["flags"] = to_json(run.flags);
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
  json["noise_sd_n"] = run.approach.noise_sd_n;
  json["mean_stiffness_n_per_m"] = run.contact.mean_stiffness_n_per_m;
  json["youngs_modulus_pa"] = run.modulus.youngs_modulus_pa;
  json["youngs_modulus_sd_pa"] = run.modulus.sd_pa;
  json["youngs_modulus_law"] = run.modulus.law;
  json["youngs_modulus_refused"] = run.modulus.refused;
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
      "flags,modulus_refused,bad\n";
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
  json["results"] = Json::array();
  for (const RunResult& run : report.runs) {
    json["results"].push_back(run_json(run));
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace palpate
