// `palpate-run bench walk`: a local model on a long random walk over a database, under
// everything that can go wrong.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"
#include "runtime/account/safety.h"

namespace palpate {

struct WalkBenchOptions {
  std::filesystem::path database = {};
  std::string tool = {};  ///< empty: the only one
  LocalModel model = LocalModel::kPotential;
  std::int64_t ticks = 1'000'000;
  double fast_hz = 2000.0;
  int ticks_per_slow = 20;
  double starvation = 0.3;    ///< [-] share of slow turns that do not take place
  double loss = 0.1;          ///< [-] share of elements that are lost on the way
  double jitter = 0.01;       ///< [-] share of ticks that are ten times as long
  double noise_m = 1e-5;      ///< [m] standard deviation of the measured position
  double quantum_m = 2e-5;    ///< [m] its resolution; 0: none
  double friction_max = 1.0;  ///< [-] mu is drawn anew at every slow turn
  std::uint32_t seed = 1;
  const std::atomic<bool>* stop = nullptr;  ///< set: the walk ends there
};

struct WalkBenchReport {
  std::int64_t ticks = 0;  ///< rendered; fewer than asked for after a fault or a stop
  std::int64_t contact_ticks = 0;
  std::int64_t starved_ticks = 0;
  std::uint64_t interventions = 0;
  double work_j = 0.0;     ///< [J] put in, by the potentials before each step
  double created_j = 0.0;  ///< [J] >= 0, most that was ever given away
  double drift_j = 0.0;    ///< [J] largest distance of the ledger from its identity
  double through_j = 0.0;  ///< [J] that went through the account: stored, dissipated
  double force_max_n = 0.0;
  bool relaxes = false;    ///< the body relaxes
  bool yields = false;     ///< the body leaves dents or softens
  double yielded_j = 0.0;  ///< [J] dissipated by that
  std::int32_t yielded_sites = 0;
  double carried_max_n = 0.0;   ///< [N] most that had relaxed of the normal force
  std::uint64_t shortened = 0;  ///< steps of relaxing that the account was short for
  std::uint64_t forgotten = 0;  ///< dents that gave way to others
  std::int64_t not_finite = 0;  ///< forces
  Fault fault = Fault::kNone;
  double seconds = 0.0;  ///< [s] that it took
};

/// Without clamps. The same options give the same walk.
[[nodiscard]] WalkBenchReport run_walk(const ResponseDatabase& database,
                                       const WalkBenchOptions& options);

/// Reads the database. @throws InputError, FormatError.
[[nodiscard]] WalkBenchReport run_walk_bench(const WalkBenchOptions& options);

[[nodiscard]] std::string table_text(const WalkBenchReport& report);
[[nodiscard]] std::string to_json(const WalkBenchReport& report);

}  // namespace palpate
