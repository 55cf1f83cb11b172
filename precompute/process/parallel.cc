#include "precompute/process/parallel.h"

#include <tbb/parallel_for.h>

#include "precompute/process/run_in_child.h"

namespace palpate {

Workers::Workers(int most) {
  if (most > 0) {
    limit_.emplace(tbb::global_control::max_allowed_parallelism,
                   static_cast<std::size_t>(most));
  }
  keep_children_ready(count());
}

std::size_t Workers::count() {
  return tbb::global_control::active_value(
      tbb::global_control::max_allowed_parallelism);
}

void in_parallel(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(std::size_t{0}, count, body, own);
}

}  // namespace palpate
