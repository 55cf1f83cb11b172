#include "precompute/build/build.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <mutex>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/sha256.h"
#include "formats/database/error_calibration.h"
#include "formats/database/precision_choice.h"
#include "formats/database/rounded_database.h"
#include "formats/database/table_memory.h"
#include "formats/response/memory_sites.h"
#include "precompute/build/build_coupling.h"
#include "precompute/build/build_job.h"
#include "precompute/build/checkpoint.h"
#include "precompute/material/material_spectrum.h"
#include "precompute/press/contact_coupling.h"
#include "precompute/press/node_yielding.h"
#include "precompute/press/relaxation_shares.h"
#include "precompute/press/surface_displacement.h"
#include "precompute/press/work_unit_solver.h"
#include "precompute/process/failure_of.h"
#include "precompute/process/parallel.h"
#include "precompute/process/peak_memory.h"
#include "precompute/tets/quality_notes.h"
#include "runtime/slow/static_field.h"

namespace palpate {
namespace {

bool relaxes_by_node(const SceneSpectrum& spectrum) {
  return !spectrum.empty() && !spectrum.uniform();
}

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

class UnitRun {
 public:
  UnitRun(const Scene& scene, const BodySource& body, const PressStrategy& strategy,
          const Checkpoint& checkpoint, bool solve_all, Progress& progress)
      : scene_(scene),
        body_(body),
        strategy_(strategy),
        checkpoint_(checkpoint),
        solve_all_(solve_all),
        progress_(progress) {}

  // Solves what is not kept yet; outcomes in the units' order.
  std::vector<WorkUnitOutcome> run(std::span<const std::int32_t> reachable,
                                   std::span<const WorkUnit> units,
                                   BuildReport& report) {
    std::vector<WorkUnitOutcome> outcome(units.size());
    std::vector<WorkUnit> open;
    std::vector<std::size_t> place;
    for (std::size_t i = 0; i < units.size(); ++i) {
      if (auto kept = checkpoint_.load(units[i].index)) {
        outcome[i] = std::move(*kept);
        ++report.resumed;
      } else {
        open.push_back(units[i]);
        place.push_back(i);
      }
    }
    if (open.empty()) {
      return outcome;
    }
    const SceneSolver solver(scene_, body_, strategy_, reachable, vertices_of(open),
                             progress_);
    describe(solver, report);
    progress_.stage("indentation");
    std::atomic<std::size_t> done = 0;
    std::mutex reporting;
    in_parallel(open.size(), [&](std::size_t i) {
      outcome[place[i]] = solved_or_failed(solver, open[i]);
      ++done;
      if (reporting.try_lock()) {
        const std::lock_guard lock(reporting, std::adopt_lock);
        progress_.advance(done, open.size(), "units");
      }
    });
    return outcome;
  }

 private:
  // A unit that cannot be computed at all does not end the build. It is not kept, so
  // that --resume tries again.
  WorkUnitOutcome solved_or_failed(const SceneSolver& solver,
                                   const WorkUnit& unit) const {
    WorkUnitOutcome outcome;
    const std::string reason = failure_of("its unit", [&] {
      outcome = solve_unit(scene_, body_, strategy_, solver, unit, solve_all_);
      checkpoint_.keep(outcome);
    });
    return reason.empty() ? outcome : failed_unit(unit, body_.tool.size(), reason);
  }

  static void describe(const SceneSolver& solver, BuildReport& report) {
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

  const Scene& scene_;
  const BodySource& body_;
  const PressStrategy& strategy_;
  const Checkpoint& checkpoint_;
  bool solve_all_;
  Progress& progress_;
};

// Where materials relax differently, nodes do.
void add_relaxation(const Scene& scene, const BodySource& body,
                    const PressStrategy& strategy, const std::vector<double>& tau_s,
                    ResponseDatabase& database, Progress& progress) {
  std::vector<std::vector<std::int32_t>> vertices(database.tools.size());
  for (std::size_t t = 0; t < database.tools.size(); ++t) {
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(body.normal.rows()); ++v) {
      if (!database.tools[t].curve(v).depth_m.empty()) {
        vertices[t].push_back(v);
      }
    }
  }
  std::vector<Viscoelasticity> shares =
      relaxation_shares(scene, body, strategy, vertices, tau_s, progress);
  for (std::size_t t = 0; t < database.tools.size(); ++t) {
    shares[t].rule = fmt::format(
        "correspondence principle, fitted at each node to linear presses at {} rates",
        fitted_rates_per_s(tau_s).size());
    shares[t].yielding = database.tools[t].viscoelasticity.yielding;
    give_memory(database.body, database.normal, shares[t], scene.accuracy.bundles,
                database.tools[t]);
  }
}

// Displacements are for drawing: where they cannot be had the responses are written
// without.
void add_fields_or_note(const Scene& scene, const BodySource& body,
                        const PressStrategy& strategy,
                        std::span<const std::int32_t> reachable, BuildReport& report,
                        Progress& progress) {
  const std::string failure = failure_of("their computation", [&] {
    add_surface_fields(scene, body, strategy, reachable, report.assembly.database,
                       progress);
  });
  if (!failure.empty()) {
    for (ResponseTable& table : report.assembly.database.tools) {
      table.displacement = {};
    }
    report.notes.push_back(
        fmt::format("no displacements for drawing are stored: {}", failure));
  }
}

// The precision that was asked for, if it can hold the responses; else the next.
void choose_possible_precision(std::optional<Precision> wanted, BuildReport& report) {
  ResponseDatabase& database = report.assembly.database;
  choose_precision(database, wanted);
  while (database.storage.precision != Precision::kFloat64) {
    try {
      (void)rounded(database);
      return;
    } catch (const InputError& error) {
      report.notes.push_back(error.what());
      database.storage.precision = database.storage.precision == Precision::kInt16
                                       ? Precision::kFloat32
                                       : Precision::kFloat64;
    }
  }
}

// What needs all responses at once cannot be shared out.
void refuse_in_shards(const Scene& scene, const SceneSpectrum& spectrum) {
  if (scene.drawing.displacement) {
    throw InputError(
        "[drawing] displacement = true needs all responses at once: build without "
        "--shard, or without the displacements");
  }
  if (couples(scene)) {
    throw InputError(
        "tools whose contacts couple need the whole body at once: build without "
        "--shard, or without shape = \"spheres\" and compliance = true");
  }
  if (relaxes_by_node(spectrum)) {
    throw InputError(
        "materials that relax differently need all responses at once: build without "
        "--shard, or give every [[material]] the same relaxation");
  }
}

std::vector<WorkUnit> units_of_shard(const std::vector<WorkUnit>& units,
                                     const BuildOptions& options) {
  std::vector<WorkUnit> mine;
  std::copy_if(units.begin(), units.end(), std::back_inserter(mine),
               [&](const WorkUnit& unit) {
                 return unit.index % options.shards == options.shard;
               });
  return mine;
}

}  // namespace

BuildReport build(const Scene& scene, const BuildOptions& options, Progress& progress) {
  const auto began = std::chrono::steady_clock::now();
  const SceneSpectrum spectrum = spectrum_of(scene);
  if (options.shards > 1) {
    refuse_in_shards(scene, spectrum);
  }
  { const AtomicFile place(options.output); }  // said before the work, not after it
  std::optional<tbb::global_control> limit;
  if (options.workers > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism,
                  static_cast<std::size_t>(options.workers));
  }
  BuildReport report;
  progress.stage("body");
  const BuildJob job =
      build_job(scene, {.repair = options.repair, .solve_all = options.solve_all});
  const auto& [body, reachable, strategy, units, plan] = job;
  const std::vector<WorkUnit> mine = units_of_shard(units, options);
  const Checkpoint checkpoint(options.output, plan, options.resume);
  report.nodes = body.surface.position_m.rows();
  report.units = static_cast<std::int64_t>(mine.size());
  report.node_spacing_m = strategy.spacing_m;
  report.notes = body.notes;
  report.notes.insert(report.notes.end(), strategy.notes.begin(), strategy.notes.end());
  std::vector<WorkUnitOutcome> outcomes =
      UnitRun(scene, body, strategy, checkpoint,
              options.solve_all || scene.accuracy.solve == "all", progress)
          .run(reachable, mine, report);
  progress.finish();
  if (options.shards > 1) {
    write_shard(options.output, {plan, std::move(outcomes)});
  } else {
    report.assembly = assemble(plan, outcomes, stored_forces);
    require_responses(plan, report.assembly);
    if (relaxes_by_node(spectrum)) {
      add_relaxation(scene, body, strategy, spectrum.tau_s, report.assembly.database,
                     progress);
    }
    if (couples(scene)) {
      add_coupling(scene, body, reachable, report.assembly.database, progress);
    }
    if (scene.drawing.displacement) {
      add_fields_or_note(scene, body, strategy, reachable, report, progress);
    }
    choose_possible_precision(options.precision, report);
    write_database(options.output, report.assembly.database);
  }
  checkpoint.remove();
  report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  report.peak_memory_bytes = peak_memory_bytes();
  return report;
}

}  // namespace palpate
