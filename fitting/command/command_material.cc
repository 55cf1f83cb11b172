// palpate-fit material: measured curves against a sweep over material parameters.
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fitting/command/commands.h"
#include "fitting/curve/corrected_press.h"
#include "fitting/material/material_fit.h"
#include "fitting/session/session_machine.h"
#include "fitting/session/session_probes.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/base/named_message.h"

namespace palpate {
namespace {

struct MaterialOptions {
  std::string sweep;
  std::string session;
  bool json = false;
};

struct MaterialResult {
  MaterialFit fit;
  std::vector<std::string> run;
  std::vector<LeftOutProbe> left_out;
};

// The sweep's vertex nearest to the run; the only one, if there is one.
std::size_t place_of(const ResponseSweep& sweep, const SurfaceMesh& body,
                     const SessionRun& run) {
  if (sweep.vertex.size() == 1) {
    return 0;
  }
  if (!run.position_m) {
    throw InputError("the sweep has several vertices, the run no position_m");
  }
  std::size_t best = 0;
  double closest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sweep.vertex.size(); ++i) {
    if (sweep.vertex[i] < 0 || sweep.vertex[i] >= body.position_m.rows()) {
      throw InputError(fmt::format("the sweep's vertex {} is not one of the body's {}",
                                   sweep.vertex[i], body.position_m.rows()));
    }
    const double distance_m =
        (body.position_m.row(sweep.vertex[i]).transpose() - *run.position_m).norm();
    if (distance_m < closest_m) {
      closest_m = distance_m;
      best = i;
    }
  }
  return best;
}

MaterialCurve curve_of(const ResponseSweep& sweep, const SurfaceMesh& body,
                       const Session& session, const SessionRun& run,
                       const FrameCompliance* frame) {
  MaterialCurve curve;
  curve.place = place_of(sweep, body, run);
  const CorrectedPress press =
      correct_press(chosen_press(session, read_run(session, run).samples), frame,
                    session.fit.range, session.fit.baseline);
  curve.approach = press.approach;
  const ContactFit& contact = press.contact;
  if (contact.has(FitFlag::kEmptyRun)) {
    throw InputError("empty run");
  }
  curve.contact_point_m = contact.contact_point_m;
  return curve;
}

MaterialResult compute_material(const MaterialOptions& options) {
  const ResponseSweep sweep = read_sweep(options.sweep);
  const Session session = read_session(options.session);
  const SurfaceMesh body =
      sweep.vertex.size() > 1 ? session_body(session) : SurfaceMesh{};
  const std::optional<FrameRun> frame = session_frame(session);
  MaterialResult result;
  std::vector<MaterialCurve> curves;
  for (const SessionRun& run : session.run) {
    try {
      curves.push_back(
          curve_of(sweep, body, session, run, frame ? &frame->frame : nullptr));
      result.run.push_back(run.name);
    } catch (const Error& error) {
      result.left_out.push_back(
          {run.name, std::string(without_name(error.what(), run.name))});
    }
  }
  if (curves.empty()) {
    throw InputError(fmt::format("{}: no run can be used; {}: {}", options.session,
                                 result.left_out[0].name, result.left_out[0].reason));
  }
  result.fit = fit_material(sweep, curves);
  if (!result.fit.converged) {
    throw NumericalError(fmt::format("{}: the fit did not converge in {} iterations",
                                     options.session, result.fit.iterations));
  }
  return result;
}

nlohmann::ordered_json to_json(const MaterialResult& result) {
  const MaterialFit& fit = result.fit;
  nlohmann::ordered_json json;
  json["parameters"] = nlohmann::json::array();
  for (std::size_t j = 0; j < fit.parameter.size(); ++j) {
    const MaterialParameter& p = fit.parameter[j];
    nlohmann::ordered_json entry{
        {"name", p.name},      {"value", p.value},  {"sd_log", p.sd_log},
        {"low_95", p.low},     {"high_95", p.high}, {"identifiable", p.identifiable},
        {"why_not", p.why_not}};
    for (const ProfilePoint& point : p.profile) {
      entry["profile"].push_back({point.value, point.deviance});
    }
    for (std::size_t k = 0; k < fit.parameter.size(); ++k) {
      entry["correlation"].push_back(
          fit.correlation(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)));
    }
    json["parameters"].push_back(entry);
  }
  json["runs"] = nlohmann::json::array();
  for (std::size_t c = 0; c < result.run.size(); ++c) {
    json["runs"].push_back({{"run", result.run[c]},
                            {"contact_point_m", fit.contact_point_m[c]},
                            {"rms_n", fit.rms_n[c]}});
  }
  json["left_out"] = nlohmann::json::array();
  for (const LeftOutProbe& run : result.left_out) {
    json["left_out"].push_back({{"run", run.name}, {"reason", run.reason}});
  }
  json["seconds"] = fit.seconds;
  return json;
}

void print_material(const MaterialResult& result) {
  const MaterialFit& fit = result.fit;
  for (const MaterialParameter& p : fit.parameter) {
    fmt::print("{:<32} {:>12.6g}  95 % [{:.6g}, {:.6g}]  {}\n", p.name, p.value, p.low,
               p.high, p.identifiable ? "identifiable" : p.why_not);
  }
  for (Eigen::Index j = 0; j < fit.correlation.rows(); ++j) {
    for (Eigen::Index k = 0; k < j; ++k) {
      fmt::print("correlation of {} and {}: {:.3f}\n",
                 fit.parameter[static_cast<std::size_t>(k)].name,
                 fit.parameter[static_cast<std::size_t>(j)].name,
                 fit.correlation(j, k));
    }
  }
  for (std::size_t c = 0; c < result.run.size(); ++c) {
    fmt::print("{}: contact point {:.4f} mm, residual {:.3g} N rms\n", result.run[c],
               1e3 * fit.contact_point_m[c], fit.rms_n[c]);
  }
  for (const LeftOutProbe& run : result.left_out) {
    fmt::print("left out {}: {}\n", run.name, run.reason);
  }
}

void run_material(const MaterialOptions& options) {
  const MaterialResult result = compute_material(options);
  if (options.json) {
    fmt::print("{}\n", json_text(to_json(result)));
  } else {
    print_material(result);
  }
}

}  // namespace

void add_material_command(Command app) {
  auto options = std::make_shared<MaterialOptions>();
  Command command = app.add_subcommand(
      "material",
      "Material parameters of measured curves, and whether they tell them.");
  command
      .add_option("SWEEP", options->sweep,
                  "responses over the parameters, of palpate-precompute sweep")
      .required();
  command.add_option("SESSION", options->session, "session file (TOML)").required();
  command.add_flag("--json", options->json, "report for programs");
  command.callback([options] {
    run_material(*options);
  });
}

}  // namespace palpate
