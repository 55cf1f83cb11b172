#include "precompute/build/unit_run.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/press/work_unit_solver.h"
#include "precompute/process/failure_of.h"
#include "precompute/process/parallel.h"
#include "precompute/process/patience.h"
#include "precompute/tets/quality_notes.h"

namespace palpate {
namespace {

std::vector<std::int32_t> vertices_of(std::span<const WorkUnit> units) {
  std::vector<std::int32_t> vertices;
  for (const WorkUnit& unit : units) {
    if (!unit.is_check) {
      vertices.insert(vertices.end(), unit.vertex.begin(), unit.vertex.end());
    }
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

void describe(const SceneSolver& solver, BuildReport& report) {
  if (const CutOutSolver* cut_out = solver.cut_out()) {
    report.notes.push_back(cut_out->text());
  }
  if (const BodyModel* shared = solver.shared()) {
    report.tets = shared->mesh.tet.rows();
    report.unknowns = shared->supports.free;
    report.min_dihedral_deg = shared->min_dihedral_deg;
    const TetQuality quality{.smallest_dihedral_rad =
                                 shared->min_dihedral_deg * std::numbers::pi / 180.0};
    for (const std::string& note : quality_notes(quality)) {
      report.notes.push_back(note);
    }
  }
}

}  // namespace

UnitRun::UnitRun(const Scene& scene, const BuildJob& job, const Checkpoint& checkpoint,
                 const BuildOptions& options, Progress& progress)
    : scene_(scene),
      job_(job),
      checkpoint_(checkpoint),
      options_(options),
      progress_(progress) {}

const std::vector<WorkUnitOutcome>& UnitRun::run(std::span<const WorkUnit> units,
                                                 BuildReport& report) {
  outcome_.resize(units.size());
  std::vector<WorkUnit> open;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (auto kept = checkpoint_.load(units[i].index)) {
      outcome_[i] = std::move(*kept);
      ++report.resumed;
    } else {
      open.push_back(units[i]);
      place.push_back(i);
    }
  }
  if (!open.empty()) {
    solve_all(open, place, report);
  }
  if (wanting_ > 0) {
    throw ResourceError(
        fmt::format("{} of {} units could not be solved: {}; what was solved is kept: "
                    "--resume goes on with it",
                    wanting_.load(), units.size(), want_));
  }
  if (const std::string reason = keep_left(); !reason.empty()) {
    report.notes.push_back(
        fmt::format("{} of {} units are kept nowhere but in the output: {}",
                    unkept_.size(), units.size(), reason));
  }
  return outcome_;
}

std::string UnitRun::keep_left() {
  for (const std::size_t i : std::exchange(unkept_, {})) {
    keep(i);
  }
  return unkept_.empty() ? std::string() : not_kept_;
}

void UnitRun::solve_all(const std::vector<WorkUnit>& open,
                        const std::vector<std::size_t>& place, BuildReport& report) {
  std::optional<SceneSolver> solver;
  with_patience(options_.patience_s, "the body's factor", [&] {
    solver.emplace(scene_, job_.body, job_.strategy, job_.reachable, vertices_of(open),
                   progress_);
  });
  describe(*solver, report);
  progress_.stage("indentation");
  std::atomic<std::size_t> done = 0;
  std::mutex reporting;
  in_parallel(open.size(), [&](std::size_t i) {
    solve(*solver, open[i], place[i]);
    ++done;
    if (reporting.try_lock()) {
      const std::lock_guard lock(reporting, std::adopt_lock);
      progress_.advance(done, open.size(), "units");
    }
  });
}

// Once one has waited in vain, the others do not wait as long again.
void UnitRun::solve(const SceneSolver& solver, const WorkUnit& unit, std::size_t i) {
  const bool all = options_.solve_all || scene_.accuracy.solve == "all";
  try {
    const std::string reason = failure_of("its unit", [&] {
      with_patience(wanting_ > 0 ? 0.0 : options_.patience_s, "its unit", [&] {
        outcome_[i] = solve_unit(scene_, job_.body, job_.strategy, solver, unit, all);
      });
    });
    if (!reason.empty()) {
      outcome_[i] = failed_unit(unit, job_.body.tool.size(), reason);
      return;
    }
  } catch (const ResourceError& error) {
    const std::lock_guard lock(noting_);
    ++wanting_;
    want_ = error.what();
    return;
  }
  keep(i);
}

// What a disk does not take costs nothing that was solved.
void UnitRun::keep(std::size_t i) {
  const auto note = [&](const Error& error) {
    const std::lock_guard lock(noting_);
    unkept_.push_back(i);
    not_kept_ = error.what();
  };
  try {
    checkpoint_.keep(outcome_[i]);
  } catch (const InputError& error) {
    note(error);
  } catch (const ResourceError& error) {
    note(error);
  }
}

}  // namespace palpate
