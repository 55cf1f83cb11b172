#include "precompute/build/build.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

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
#include "precompute/build/kept_output.h"
#include "precompute/build/unit_run.h"
#include "precompute/material/material_spectrum.h"
#include "precompute/press/contact_coupling.h"
#include "precompute/press/needle_curve.h"
#include "precompute/press/node_yielding.h"
#include "precompute/press/relaxation_shares.h"
#include "precompute/press/surface_displacement.h"
#include "precompute/process/failure_of.h"
#include "precompute/process/parallel.h"
#include "precompute/process/patience.h"
#include "precompute/process/peak_memory.h"
#include "runtime/slow/static_field.h"

namespace palpate {
namespace {

bool relaxes_by_node(const SceneSpectrum& spectrum) {
  return !spectrum.empty() && !spectrum.uniform();
}

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

// Whether a run before this one, or while this one waited, has finished the output.
bool is_done_already(const BuildOptions& options, const JobDescription& plan,
                     BuildReport& report) {
  if (options.shards > 1) {
    return is_shard(options.output) && responses_there(options.output, plan.digest);
  }
  auto there = assembled_already(options.output, plan.digest, options.precision);
  if (there) {
    report.assembly = std::move(*there);
  }
  return there.has_value();
}

// From all units to the database.
void finish_database(const Scene& scene, const BuildOptions& options,
                     const SceneSpectrum& spectrum, const BuildJob& job,
                     const std::vector<WorkUnitOutcome>& outcomes, BuildReport& report,
                     Progress& progress) {
  const auto& [body, reachable, strategy, units, plan] = job;
  report.assembly = assemble(plan, outcomes, stored_forces);
  require_responses(plan, report.assembly);
  if (relaxes_by_node(spectrum)) {
    add_relaxation(scene, body, strategy, spectrum.tau_s, report.assembly.database,
                   progress);
  }
  if (couples(scene)) {
    for (std::string& note :
         add_coupling(scene, body, reachable, report.assembly.database, progress)) {
      report.notes.push_back(std::move(note));
    }
  }
  if (scene.drawing.displacement) {
    add_fields_or_note(scene, body, strategy, reachable, report, progress);
  }
  choose_possible_precision(options.precision, report);
  write_unless_worse(options.output, plan.digest,
                     report.assembly.solved + report.assembly.interpolated,
                     options.patience_s, [&] {
                       write_database(options.output, report.assembly.database);
                     });
}

void finish_shard(const BuildOptions& options, const JobDescription& plan,
                  const std::vector<WorkUnitOutcome>& outcomes) {
  const Shard shard{plan, outcomes};
  write_unless_worse(options.output, plan.digest, responses_of(shard),
                     options.patience_s, [&] {
                       write_shard(options.output, shard);
                     });
}

}  // namespace

BuildReport build(const Scene& scene, const BuildOptions& options, Progress& progress) {
  const auto began = std::chrono::steady_clock::now();
  const SceneSpectrum spectrum = spectrum_of(scene);
  if (options.shards > 1) {
    refuse_in_shards(scene, spectrum);
  }
  { const AtomicFile place(options.output); }  // said before the work, not after it
  const Workers workers(options.workers);
  BuildReport report;
  progress.stage("body");
  const BuildJob job =
      build_job(scene, {.repair = options.repair, .solve_all = options.solve_all});
  const auto& [body, reachable, strategy, units, plan] = job;
  const std::vector<WorkUnit> mine = units_of_shard(units, options);
  std::optional<Checkpoint> checkpoint;
  with_patience(options.resume ? options.patience_s : 0.0, "its folder", [&] {
    checkpoint.emplace(options.output, job.plan, options.resume, options.folder_use);
  });
  report.nodes = body.surface.position_m.rows();
  report.units = static_cast<std::int64_t>(mine.size());
  report.node_spacing_m = strategy.spacing_m;
  report.notes = body.notes;
  report.notes.insert(report.notes.end(), strategy.notes.begin(), strategy.notes.end());
  const std::vector<std::string> needles = needle_notes(scene);
  report.notes.insert(report.notes.end(), needles.begin(), needles.end());
  if (options.resume && !checkpoint->holds_units() &&
      is_done_already(options, plan, report)) {
    report.resumed = report.units;
    report.notes.emplace_back("it was there already, of the same scene and program");
  } else {
    UnitRun run(scene, job, *checkpoint, options, progress);
    try {
      const std::vector<WorkUnitOutcome>& outcomes = run.run(mine, report);
      progress.finish();
      if (options.shards > 1) {
        finish_shard(options, plan, outcomes);
      } else {
        finish_database(scene, options, spectrum, job, outcomes, report, progress);
      }
    } catch (...) {
      (void)run.keep_left();
      throw;
    }
  }
  checkpoint->remove();
  report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  report.peak_memory_bytes = peak_memory_bytes();
  return report;
}

}  // namespace palpate
