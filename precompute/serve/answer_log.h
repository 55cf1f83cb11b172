// Everything that a service has said, for those who join late.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "formats/service/service_message.h"

namespace palpate {

/// Frames in the order in which they were said. Safe from several threads.
class AnswerLog {
 public:
  using Frame = std::shared_ptr<const std::vector<std::byte>>;

  explicit AnswerLog(const ServedScene& scene);

  void say(const ServedResponses& responses);
  /// Replaces what was said before: only the latest counts.
  void say(const ServedProgress& progress);
  /// The last thing that is said.
  void say(const ServedEnd& end);

  struct News {
    std::vector<Frame> frame;  ///< from the place that was asked for, in order
    Frame progress;            ///< if later than the one that was asked for; else null
    std::uint64_t progress_number = 0;
    bool ended = false;  ///< nothing will follow these frames
  };
  /// What there is from frame `next` on, and progress later than the given number;
  /// waits so long for the first of it.
  [[nodiscard]] News after(std::size_t next, std::uint64_t progress_number,
                           std::chrono::milliseconds within) const;

 private:
  void append(Frame frame, bool last);

  mutable std::mutex mutex_;
  mutable std::condition_variable news_;
  std::vector<Frame> frame_;
  Frame progress_;
  std::uint64_t progress_number_ = 0;
  bool ended_ = false;
};

}  // namespace palpate
