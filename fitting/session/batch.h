// All runs of a session, each fitted in full; a bad one is listed with its reason.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fitting/curve/corrected_press.h"
#include "fitting/curve/family_fit.h"
#include "fitting/curve/fit_rating.h"
#include "fitting/curve/frame_run.h"
#include "fitting/curve/press_cycles.h"
#include "fitting/curve/segments.h"
#include "fitting/curve/time_effects.h"
#include "fitting/material/moduli.h"
#include "fitting/session/session.h"

namespace palpate {

struct RunResult {
  std::string name, point, specimen;
  std::string run_name;                ///< the session's: of all presses of the file
  std::size_t press = 1, presses = 1;  ///< which of how many in the file
  std::optional<Eigen::Vector3d> position_m;  ///< (3) [m] the session's
  std::string bad;  ///< why there is nothing more; empty for a run that was fitted
  std::vector<CycleSummary>
      cycles;                    ///< of all presses of the file, at its first result
  PressCorrections corrections;  ///< what was taken off for the machine's sake
  Approach approach;
  ContactFit contact;   ///< the power law's
  FamilyChoice choice;  ///< best first
  Modulus modulus;
  Relaxation relaxation;
  LoopFit loop;
  std::vector<Segment> segments;
  std::vector<FitFlag> flags;  ///< of the approach, the contact fit and the modulus
  Rating rating;
  double seconds = 0.0;  ///< [s] wall time

  [[nodiscard]] const FamilyFit* best() const {
    return choice.fits.empty() ? nullptr : &choice.fits.front();
  }
};

/// One result for each press of the file (split_presses) that the session's cycle
/// chooses, all where it chooses none; at least one. Names of presses after the first
/// end with " press 2", ...; those of one file share its point, so that they are
/// repeats. Never throws for what a file holds: `bad` says it.
/// @param frame of the machine (session_frame()); null without.
[[nodiscard]] std::vector<RunResult> fit_run(const Session& session,
                                             const SessionRun& run,
                                             const FrameCompliance* frame = nullptr);

/// The law of Johnson, Kendall and Roberts, fitted where a sphere pressed a thick
/// specimen that sticks.
void model_adhesion(const Indenter& indenter, CorrectedPress& press);

/// The modulus of a corrected press; its standard deviation with what the frame's own
/// makes of it.
[[nodiscard]] Modulus corrected_modulus(const CorrectedPress& press,
                                        const Indenter& indenter);

struct BatchReport {
  std::optional<FrameRun> frame;  ///< the machine's
  std::vector<RunResult> runs;  ///< in the session's order, each file's presses in turn
  double seconds = 0.0;         ///< [s] wall time
};

/// @param threads 0: as many as there are processors. @param progress called now and
/// then, from one thread at a time, with the number of files done. What `progress`
/// throws ends the work, and comes out.
/// @throws InputError as session_frame().
[[nodiscard]] BatchReport fit_session(const Session& session, unsigned threads,
                                      const std::function<void(std::size_t)>& progress);

/// One line per press of a run: verdict, score, contact point, range, family, modulus,
/// flags, ...
[[nodiscard]] std::string batch_csv(const Session& session, const BatchReport& report);

/// The same and more, for programs.
[[nodiscard]] std::string batch_json(const Session& session, const BatchReport& report);

/// One HTML file that needs nothing else. The file has a table of all runs and, of at
/// most `most`, plots of data, fit, band and residuals. Where the session names a mesh,
/// the file shows the measured places on the mesh (batch_map).
[[nodiscard]] std::string batch_page(const Session& session, const BatchReport& report,
                                     std::size_t most = 200);

}  // namespace palpate
