// `runtime_bench grow`: a local model on a random walk over a body whose curves change.
// Curves come, get better, get worse and go at random moments, under the tool and
// elsewhere.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"
#include "runtime/account/safety.h"

namespace palpate {

struct GrowingWalkOptions {
  std::filesystem::path database = {};
  std::string tool = {};  ///< empty: the only one
  LocalModel model = LocalModel::kPotential;
  std::int64_t ticks = 1'000'000;
  double fast_hz = 2000.0;
  int ticks_per_slow = 20;
  double contrast = 10.0;   ///< [-] >= 1 of forces, between versions of a node, at most
  double tilt_rad = 0.2;    ///< [rad] of directions, between versions, at most
  double shift_m = 2e-4;    ///< [m] of touch offsets, between versions, at most
  double exchanges = 0.02;  ///< [-] chance of a node near the tool, at each slow turn
  double missing = 0.1;     ///< [-] share of versions that are no response at all
  double starvation = 0.1;  ///< [-] share of slow turns that do not take place
  std::uint32_t seed = 1;
  const std::atomic<bool>* stop = nullptr;  ///< set: the walk ends there
};

struct GrowingWalkReport {
  std::int64_t ticks = 0;
  std::int64_t contact_ticks = 0;
  std::int64_t starved_ticks = 0;
  std::int64_t exchanges = 0;  ///< versions handed over
  std::int64_t compared = 0;   ///< slow turns in contact whose force step was measured
  std::uint64_t interventions = 0;
  double work_j = 0.0;     ///< [J] put in, by the potentials before each step
  double created_j = 0.0;  ///< [J] >= 0, most that was ever given away
  double through_j = 0.0;  ///< [J] that went through the account
  double drift_j = 0.0;    ///< [J] largest distance of the ledger from its identity
  double force_max_n = 0.0;
  double step_max_n = 0.0;  ///< [N] largest change of force by what a slow turn sent
  /// [-] The same in units of the bound: GrowingElements::kStepShare of the largest
  /// force of the triangle's nodes.
  double step_of_bound = 0.0;
  double step_along_of_bound = 0.0;  ///< [-] of its part along the normal
  std::int64_t not_finite = 0;
  Fault fault = Fault::kNone;
  double seconds = 0.0;
};

/// Without clamps. At every slow turn in contact the tick is computed twice, with what
/// was sent and without. The two forces differ by what the exchange did at that place.
/// The same options give the same walk. @throws InputError for options out of range.
[[nodiscard]] GrowingWalkReport run_growing_walk(const ResponseDatabase& database,
                                                 const GrowingWalkOptions& options);

/// Reads the database. @throws InputError, FormatError.
[[nodiscard]] GrowingWalkReport run_growing_walk(const GrowingWalkOptions& options);

[[nodiscard]] std::string table_text(const GrowingWalkReport& report);
[[nodiscard]] std::string to_json(const GrowingWalkReport& report);

}  // namespace palpate
