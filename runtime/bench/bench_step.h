// `palpate-run bench step`: what one tick of the fast process costs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/account/local_model.h"

namespace palpate {

struct StepBenchOptions {
  int ticks = 200000;       ///< of the recorded walk
  int ticks_per_slow = 20;  ///< fast ticks between two slow messages
};

struct StepBenchRow {
  LocalModel model = LocalModel::kElement;
  std::string scene;              ///< what the tool moves over
  double median_ns = 0.0;         ///< [ns] of step(), without the clock's own cost
  double p999_ns = 0.0;           ///< [ns] 99.9th percentile, likewise
  double accept_median_ns = 0.0;  ///< [ns] of accept()
  std::uint64_t allocations = 0;  ///< in all steps and accepts
};

/// Runs every model over nine scenes, each with a recorded walk. Two tools and one tool
/// run on a wavy body of random stiffness with friction, one tool on such a body
/// without friction. One runs on a body that relaxes with two terms, as one curve and
/// in eight bundles. One runs on a body that keeps dents, and one on a body that keeps
/// dents and softens. The last scenes are a rigid flat wall and free space. A tick is
/// one step of every tool. The clock's own cost, the median of empty readings, is taken
/// off.
/// @param allocations counter of heap allocations so far in this thread.
[[nodiscard]] std::vector<StepBenchRow> run_step_bench(const StepBenchOptions& options,
                                                       std::uint64_t (*allocations)());

[[nodiscard]] std::string table_text(const std::vector<StepBenchRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<StepBenchRow>& rows);

}  // namespace palpate
