// Loops side by side that end whole or by an exception.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include <tbb/global_control.h>

namespace palpate {

/// How many workers in_parallel() uses while this lives; each finds a child ready
/// (run_in_child).
class Workers {
 public:
  /// @param most 0: as many as there are processors.
  explicit Workers(int most);

  [[nodiscard]] static std::size_t count();

 private:
  std::optional<tbb::global_control> limit_;
};

/// Calls body(0) ... body(count - 1), on all workers, in no order. Returns once all are
/// done; an exception of one is thrown after those under way have ended. Other loops'
/// exceptions do not cut this loop short. They would cut short a plain
/// tbb::parallel_for inside them, which then returns as if it had done everything.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace palpate
