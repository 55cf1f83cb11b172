// Units of a build solved side by side, each kept as soon as it is done.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "precompute/build/build.h"
#include "precompute/build/build_job.h"
#include "precompute/build/checkpoint.h"

namespace palpate {

class UnitRun {
 public:
  /// All must outlive it.
  UnitRun(const Scene& scene, const BuildJob& job, const Checkpoint& checkpoint,
          const BuildOptions& options, Progress& progress);

  /// Solves what is not kept yet. A unit that cannot be solved fails alone. One for
  /// which memory, processes or the disk are wanting waits, and has no outcome if that
  /// is in vain; the others go on. @return outcomes in the units' order.
  /// @throws ResourceError if some have none.
  const std::vector<WorkUnitOutcome>& run(std::span<const WorkUnit> units,
                                          BuildReport& report);

  /// Tries again to keep what could not be kept. @return why not; empty if all is.
  std::string keep_left();

 private:
  void solve_all(const std::vector<WorkUnit>& open,
                 const std::vector<std::size_t>& place, BuildReport& report);
  void solve(const SceneSolver& solver, const WorkUnit& unit, std::size_t i);
  void keep(std::size_t i);

  const Scene& scene_;
  const BuildJob& job_;
  const Checkpoint& checkpoint_;
  const BuildOptions& options_;
  Progress& progress_;
  std::vector<WorkUnitOutcome> outcome_;
  std::mutex noting_;
  std::atomic<std::size_t> wanting_ = 0;
  std::string want_;
  std::vector<std::size_t> unkept_;
  std::string not_kept_;
};

}  // namespace palpate
