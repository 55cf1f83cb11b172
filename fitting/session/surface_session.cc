#include "fitting/session/surface_session.h"

#include <algorithm>

#include <fmt/format.h>

#include "fitting/session/session_probes.h"
#include "fitting/session/session_units.h"
#include "formats/base/error.h"
#include "formats/base/sha256.h"

namespace palpate {
namespace {

// g: of all nodes, or of the least and the most that there is at any.
nlohmann::ordered_json rendered_json(const SurfaceFitReport& report) {
  const Viscoelasticity& v = report.viscoelasticity;
  if (v.empty()) {
    return nullptr;
  }
  nlohmann::ordered_json json{{"probes", v.probes},
                              {"speed_m_per_s", v.speed_m_per_s},
                              {"tau_s", v.tau_s},
                              {"rule", v.rule}};
  const RelaxationFieldReport& field = report.relaxation_field;
  const auto row = [](const auto& values) {
    return std::vector<float>(values.begin(), values.end());
  };
  if (field.taken) {
    json["g_min"] = row(v.g.colwise().minCoeff().eval());
    json["g_max"] = row(v.g.colwise().maxCoeff().eval());
  } else {
    json["g"] = row(v.g.row(0));
  }
  json["field"] = {{"taken", field.taken},
                   {"reason", field.reason},
                   {"places", field.places},
                   {"left_out", field.left_out},
                   {"time_s", field.time_s},
                   {"patches", field.patches},
                   {"rms_share", field.field_rms},
                   {"common_rms_share", field.common_rms},
                   {"coverage_95", field.coverage},
                   {"gain_over_error", field.gain_over_error},
                   {"common_times_error", field.common_times_error},
                   {"error_median", field.error_median}};
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const SurfaceFitReport& report,
                               const std::vector<std::string>& notes) {
  const FieldParameters& p = report.parameters.parameters;
  nlohmann::ordered_json json{{"runs", report.runs},
                              {"probes", report.probes},
                              {"places", report.places},
                              {"laws", report.laws},
                              {"length_m", p.length_m},
                              {"sd_log_force", p.sd},
                              {"nugget_log_force", p.nugget_sd},
                              {"repeatability_log_force", report.repeatability},
                              {"smoothness", p.smoothness},
                              {"at_bound", report.parameters.at_bound},
                              {"converged", report.parameters.converged},
                              {"log_likelihood", report.parameters.log_likelihood},
                              {"seconds", report.parameters.seconds},
                              {"attachment_max_m", report.attachment_max_m},
                              {"error_median", report.error_median},
                              {"far_nodes", report.far_nodes},
                              {"straightened", report.straightened}};
  json["relaxation"] = nullptr;
  if (const ResponseRelaxation& r = report.relaxation; !r.empty()) {
    json["relaxation"] = {{"probes", r.probes},
                          {"speed_m_per_s", r.speed_m_per_s},
                          {"seconds", r.seconds},
                          {"g", {r.terms.g_1[0], r.terms.g_2[0]}},
                          {"tau_s", {r.terms.tau_1_s[0], r.terms.tau_2_s[0]}},
                          {"rule", r.rule}};
  }
  json["rendered"] = rendered_json(report);
  json["left_one_out"] = nlohmann::json::array();
  for (const DepthScore& d : report.depth) {
    json["left_one_out"].push_back({{"depth_m", d.depth_m},
                                    {"probes", d.probes},
                                    {"rms_log_force", d.rms},
                                    {"coverage_95", d.coverage},
                                    {"nearest_rms_log_force", d.nearest_rms}});
  }
  json["left_patches_out"] = {{"patches", report.patches.patches},
                              {"places", report.patches.points},
                              {"rms_log_force", report.patches.rms},
                              {"coverage_95", report.patches.coverage}};
  json["left_out"] = nlohmann::json::array();
  for (const LeftOutProbe& probe : report.left_out) {
    json["left_out"].push_back({{"run", probe.name}, {"reason", probe.reason}});
  }
  json["notes"] = notes;
  return json;
}

SurfaceFit fit_session_surface(const Session& session,
                               std::vector<std::string>& notes) {
  if (!session.tool) {
    throw InputError(fmt::format(
        "{}: [indenter] shape {:?} is no tool that the runtime renders: sphere, "
        "flat-punch or cone",
        session.file.string(), session.indenter.shape));
  }
  const SurfaceMesh body = session_body(session, &notes);
  std::vector<LeftOutProbe> left_out;
  for (const std::string& note : unit_notes(session, body)) {
    notes.push_back(note);
  }
  const std::vector<SurfaceProbe> probes = session_probes(session, left_out, notes);
  if (probes.size() < kProbesMin && !left_out.empty()) {
    throw InputError(fmt::format(
        "{}: {} runs can be read and placed, at least {} are needed; {}: {}",
        session.file.string(), probes.size(), kProbesMin, left_out[0].name,
        left_out[0].reason));
  }
  double deepest_m = 0.0;
  for (const SurfaceProbe& probe : probes) {
    deepest_m = std::max(deepest_m, depth_max_m(probe));
  }
  for (const std::string& note : depth_notes(session, body, deepest_m)) {
    notes.push_back(note);
  }
  SurfaceFit fit = fit_surface(body, *session.tool, probes, {.patches = true});
  fit.report.left_out.insert(fit.report.left_out.begin(), left_out.begin(),
                             left_out.end());
  fit.report.runs = session.run.size();
  Provenance& provenance = fit.database.provenance;
  provenance.writer = "palpate-fit " PALPATE_VERSION;
  provenance.source_file = session.file.filename().string();
  provenance.source_sha256 = sha256_of_file(session.file);
  provenance.left_out =
      fmt::format("{} of {} runs; nodes between the probes are interpolated",
                  fit.report.left_out.size(), session.run.size());
  return fit;
}

}  // namespace palpate
