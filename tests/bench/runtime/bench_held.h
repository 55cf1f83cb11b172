// `runtime_bench held`: what a hand gets out of forces that a device holds for a tick,
// beyond the account, over K dx^2 / 2.
//
// Places are over the middle of every edge of a stored body whose elements respond at
// all nodes. There the tool comes down by the normals, and then goes to and fro by dx.
// Ways are across the edge; along the normal; and by a random walk of steps of dx in
// all directions. A tick from x to x' with the force F held gives F . (x' - x) +
// U(x') - U(x) more than the model's potential U does. Slow updates send elements on
// the way. No clamps.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"

namespace palpate {

enum class HeldWay : std::uint8_t { kAcross, kNormal, kAnywhere };

struct HeldBenchRow {
  LocalModel model = LocalModel::kPotential;
  HeldWay way = HeldWay::kAcross;
  double step_m = 0.0;     ///< [m] dx
  int edges = 0;           ///< of so many
  double k_n_per_m = 0.0;  ///< [N/m] what the model is stated to have
  double given = 0.0;      ///< [-] largest of an edge's sum over its sum of K dx^2 / 2
  double given_mean = 0.0;
  double tick = 0.0;  ///< [-] largest of a tick's
};

struct HeldBenchOptions {
  double depth_share = 0.8;  ///< [-] (0, 1] of the largest depth
  int ticks = 100;           ///< of each way, >= 2
  int edges = 1'000'000;     ///< at most, evenly among them
};

/// Of every passive model. @param table of the database.
[[nodiscard]] std::vector<HeldBenchRow> run_held_bench(const ResponseDatabase& database,
                                                       const ResponseTable& table,
                                                       const HeldBenchOptions& options);

[[nodiscard]] std::string table_text(const std::vector<HeldBenchRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<HeldBenchRow>& rows);

}  // namespace palpate
