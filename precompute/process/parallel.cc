#include "precompute/process/parallel.h"

#include <tbb/parallel_for.h>

namespace palpate {

void in_parallel(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(std::size_t{0}, count, body, own);
}

}  // namespace palpate
