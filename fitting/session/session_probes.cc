#include "fitting/session/session_probes.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "fitting/curve/corrected_press.h"
#include "fitting/curve/split_presses.h"
#include "fitting/session/session_machine.h"
#include "formats/base/error.h"
#include "formats/base/named_message.h"
#include "formats/mesh/surface_reader.h"

namespace palpate {
namespace {

void refuse_all(const Session& session) {
  if (session.fit.cycle && session.fit.cycle->kind == CycleChoice::Kind::kAll) {
    throw InputError(fmt::format(
        "{}: one press of each run is taken here: cycle must be first, last "
        "or a number, not all ([fit] cycle, or --cycle)",
        session.file.string()));
  }
}

void refuse_sticking(const CorrectedPress& press) {
  if (press.contact.has(FitFlag::kEmptyRun)) {
    return;
  }
  const Adhesion& a = press.corrections.adhesion;
  const double pull =
      std::max(a.pulls_off ? a.pull_off_n : 0.0, a.snaps_in ? a.snap_in_n : 0.0);
  const double largest = contact_force_n(press.contact, press.contact.depth_max_m);
  if (pull > kAdhesionShareMax * largest) {
    throw InputError(fmt::format(
        "adhesion: the specimen pulls with {:.3g} N (noise {:.2g} N), {:.0f} % of the "
        "largest force, so that contact point and law are off",
        pull, a.noise_n, 100.0 * pull / largest));
  }
}

// What was taken off the probes, counted.
struct Counts {
  std::size_t drifts = 0, sticking = 0;
  double frame_share = 0.0;

  void add(const PressCorrections& c) {
    drifts += c.drift.significant ? 1 : 0;
    sticking += c.adhesion.seen() ? 1 : 0;
    frame_share = std::max(frame_share, c.frame.share);
  }
};

SurfaceProbe probe_of(const Session& session, const SessionRun& run,
                      const FrameCompliance* frame, Counts& counts) {
  SurfaceProbe probe;
  probe.name = run.name;
  probe.position_m = run.position_m.value();
  if (run.normal) {
    probe.direction = *run.normal;
  }
  probe.measurement = read_run(session, run).samples;
  const CorrectedPress press =
      correct_press(chosen_press(session, probe.measurement), frame, session.fit.range,
                    session.fit.baseline, session.fit.noise_relative);
  refuse_sticking(press);
  counts.add(press.corrections);
  probe.approach = press.approach;
  probe.fit = press.contact;
  Relaxation relaxation = find_relaxation(press.samples);
  if (relaxation.refused.empty() && relaxation.converged) {
    probe.relaxation = std::move(relaxation);
  }
  const FamilyChoice choice = choose_family(session.fit, probe.approach, probe.fit);
  if (!choice.fits.empty()) {
    probe.curve = choice.fits.front();
  }
  return probe;
}

void tell(const std::optional<FrameRun>& frame, const Counts& counts,
          std::vector<std::string>& notes) {
  if (frame) {
    notes.push_back(
        fmt::format("frame {}; takes at most {:.2g} % of the travel in "
                    "contact",
                    describe_frame(frame), 100.0 * counts.frame_share));
  }
  if (counts.drifts > 0) {
    notes.push_back(fmt::format("{} runs drift with time; taken off", counts.drifts));
  }
  if (counts.sticking > 0) {
    notes.push_back(
        fmt::format("{} probes stick by less than {:.0f} % of their force; kept",
                    counts.sticking, 100.0 * kAdhesionShareMax));
  }
}

}  // namespace

FamilyChoice choose_family(const SessionFit& session, const Approach& approach,
                           const ContactFit& reference) {
  FamilyFitOptions options;
  options.cross_validate = session.criterion == "cross-validation";
  return fit_families(approach, reference, session.families, session.criterion,
                      options);
}

Measurement chosen_press(const Session& session, const Measurement& measurement) {
  refuse_all(session);
  const auto presses = split_presses(measurement);
  const CycleChoice cycle =
      session.fit.cycle.value_or(CycleChoice{CycleChoice::Kind::kFirst});
  return presses.at(chosen_cycles(cycle, presses.size()).front() - 1);
}

std::vector<SurfaceProbe> session_probes(const Session& session,
                                         std::vector<LeftOutProbe>& left_out,
                                         std::vector<std::string>& notes) {
  refuse_all(session);
  const std::optional<FrameRun> frame = session_frame(session);
  std::vector<SurfaceProbe> probes;
  Counts counts;
  for (const SessionRun& run : session.run) {
    if (!run.position_m) {
      left_out.push_back({run.name, "the session gives it no position_m"});
      continue;
    }
    try {
      probes.push_back(probe_of(session, run, frame ? &frame->frame : nullptr, counts));
    } catch (const Error& error) {
      left_out.push_back({run.name, std::string(without_name(error.what(), run.name))});
    }
  }
  tell(frame, counts, notes);
  return probes;
}

SurfaceMesh session_body(const Session& session, std::vector<std::string>* notes) {
  if (session.mesh.empty()) {
    throw InputError(fmt::format(
        "{}: has no [body] with mesh and length_unit, which positions refer to",
        session.file.string()));
  }
  SurfaceMesh body = read_surface(session.mesh, session.length_unit, notes);
  const bool closed = triangle_neighbours(body.triangle).minCoeff() >= 0;
  if (closed && enclosed_volume_m3(body) < 0.0) {
    body.triangle.col(1).swap(body.triangle.col(2));
  }
  return body;
}

}  // namespace palpate
