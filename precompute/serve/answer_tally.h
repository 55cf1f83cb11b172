// How many nodes of a service have which answers.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "formats/service/service_message.h"
#include "precompute/build/build_job.h"

namespace palpate {

/// Safe from several threads.
class AnswerTally {
 public:
  explicit AnswerTally(const BuildJob& job);

  void take(const ServedResponses& responses);
  [[nodiscard]] ServedProgress progress(const std::string& stage) const;

 private:
  mutable std::mutex mutex_;
  std::int64_t vertices_;
  std::vector<char> best_;  // (tools x vertices) 0 none, 1 preliminary, 2 final
  std::int64_t nodes_;
};

}  // namespace palpate
