// `runtime_bench potential`: what the ledger has to do for the element model and
// for the potential field, and what that costs in force.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/account/local_model.h"

namespace palpate {

struct PotentialBenchOptions {
  int ticks = 200000;  ///< of each walk, at 2 kHz
  int ticks_per_slow = 20;
  std::vector<double> contrasts{1.0, 10.0, 100.0};
  std::vector<double> frictions{0.0, 0.3, 1.0};
  std::filesystem::path database;  ///< a body to walk over besides; may be empty
  std::string tool;                ///< of the database; empty: the only one
};

/// One walk under one model.
struct PotentialBenchRow {
  std::string body;       ///< "waves", or the database's file name
  double contrast = 1.0;  ///< [-] of the waves' stiffness
  double friction = 0.0;  ///< [-] of every node
  LocalModel model = LocalModel::kElement;
  std::int64_t contact_ticks = 0;
  std::int64_t starved_ticks = 0;
  std::uint64_t interventions = 0;  ///< changes that the ledger cut
  double created_j = 0.0;  ///< [J] lowest that the work put in ever was, below zero
  double felt_created_j = 0.0;    ///< [J] the same by the trapezoids of the forces
  double work_j = 0.0;            ///< [J] dissipated in all
  double normal_error_max = 0.0;  ///< [-] from the interpolated curve, over the largest
                                  ///< normal force
  double normal_error_rms = 0.0;  ///< [-] rms over rms
  double shift_max_m = 0.0;       ///< [m] largest delta_0
};

/// Angle between -grad U and the stored direction, interpolated, in contact.
constexpr std::array<double, 7> kAngleEdgesDeg{1.0, 2.0, 5.0, 10.0, 20.0, 45.0, 180.0};
struct AngleHistogram {
  std::array<std::int64_t, kAngleEdgesDeg.size()> count{};  ///< up to each edge
  double median_deg = 0.0;
  double p95_deg = 0.0;
};

struct PotentialBenchReport {
  std::vector<PotentialBenchRow> rows;
  AngleHistogram angle;  ///< of the database at friction 0; empty without one
};

/// @throws as read_database(); InputError if the tool is not there or not a sphere.
[[nodiscard]] PotentialBenchReport run_potential_bench(
    const PotentialBenchOptions& options);

[[nodiscard]] std::string table_text(const PotentialBenchReport& report);
[[nodiscard]] std::string to_json(const PotentialBenchReport& report);

}  // namespace palpate
