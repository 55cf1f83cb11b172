#include "fitting/session/session_probes.h"

#include <utility>

#include <fmt/format.h>

#include "fitting/curve/split_presses.h"
#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"

namespace palpate {
namespace {

SurfaceProbe probe_of(const Session& session, const SessionRun& run) {
  SurfaceProbe probe;
  probe.name = run.name;
  probe.position_m = run.position_m.value();
  if (run.normal) {
    probe.direction = *run.normal;
  }
  probe.measurement = read_run(session, run).samples;
  const Measurement press = split_presses(probe.measurement).front();
  probe.approach = select_approach(press, session.fit.range, session.fit.baseline);
  probe.fit = fit_contact(probe.approach,
                          {.noise_relative = session.fit.noise_relative});
  Relaxation relaxation = find_relaxation(press);
  if (relaxation.refused.empty() && relaxation.converged) {
    probe.relaxation = std::move(relaxation);
  }
  const FamilyChoice choice = choose_family(session.fit, probe.approach, probe.fit);
  if (!choice.fits.empty()) {
    probe.curve = choice.fits.front();
  }
  return probe;
}

}  // namespace

FamilyChoice choose_family(const SessionFit& session, const Approach& approach,
                           const ContactFit& reference) {
  FamilyFitOptions options;
  options.cross_validate = session.criterion == "cross-validation";
  return fit_families(approach, reference, session.families, session.criterion,
                      options);
}

std::vector<SurfaceProbe> session_probes(const Session& session,
                                         std::vector<LeftOutProbe>& left_out) {
  std::vector<SurfaceProbe> probes;
  for (const SessionRun& run : session.run) {
    if (!run.position_m) {
      left_out.push_back({run.name, "the session gives it no position_m"});
      continue;
    }
    try {
      probes.push_back(probe_of(session, run));
    } catch (const Error& error) {
      left_out.push_back({run.name, error.what()});
    }
  }
  return probes;
}

SurfaceMesh session_body(const Session& session) {
  if (session.mesh.empty()) {
    throw InputError(fmt::format(
        "{}: has no [body] with mesh and length_unit, which positions refer to",
        session.file.string()));
  }
  SurfaceMesh body = read_surface(session.mesh, session.length_unit);
  const bool closed = triangle_neighbours(body.triangle).minCoeff() >= 0;
  if (closed && enclosed_volume_m3(body) < 0.0) {
    body.triangle.col(1).swap(body.triangle.col(2));
  }
  return body;
}

}  // namespace palpate
