#include "precompute/serve/answer_tally.h"

#include <algorithm>

namespace palpate {

AnswerTally::AnswerTally(const BuildJob& job)
    : vertices_(job.body.surface.position_m.rows()),
      best_(static_cast<std::size_t>(vertices_) * job.body.tool.size(), 0),
      nodes_(std::ssize(job.reachable) * std::ssize(job.body.tool)) {}

void AnswerTally::take(const ServedResponses& responses) {
  const std::lock_guard lock(mutex_);
  for (const WorkUnitNode& node : responses.node) {
    char& best = best_[static_cast<std::size_t>(node.tool * vertices_ + node.vertex)];
    best =
        std::max(best, responses.quality == AnswerQuality::kFinal ? char{2} : char{1});
  }
}

ServedProgress AnswerTally::progress(const std::string& stage) const {
  const std::lock_guard lock(mutex_);
  const auto finished = std::count(best_.begin(), best_.end(), char{2});
  const auto preliminary = std::count(best_.begin(), best_.end(), char{1});
  return {.stage = stage,
          .nodes = nodes_,
          .answered = preliminary + finished,
          .finished = finished};
}

}  // namespace palpate
