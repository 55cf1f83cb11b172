#include "precompute/serve/answer_log.h"

#include <utility>

namespace palpate {
namespace {

AnswerLog::Frame framed(const ServiceMessage& message) {
  return std::make_shared<const std::vector<std::byte>>(to_frame(message));
}

}  // namespace

AnswerLog::AnswerLog(const ServedScene& scene) {
  append(framed(scene), false);
}

void AnswerLog::append(Frame frame, bool last) {
  const std::lock_guard lock(mutex_);
  if (!ended_) {
    frame_.push_back(std::move(frame));
    ended_ = last;
    news_.notify_all();
  }
}

void AnswerLog::say(const ServedResponses& responses) {
  append(framed(responses), false);
}

void AnswerLog::say(const ServedProgress& progress) {
  Frame frame = framed(progress);
  const std::lock_guard lock(mutex_);
  progress_ = std::move(frame);
  ++progress_number_;
  news_.notify_all();
}

void AnswerLog::say(const ServedEnd& end) {
  append(framed(end), true);
}

AnswerLog::News AnswerLog::after(std::size_t next, std::uint64_t progress_number,
                                 std::chrono::milliseconds within) const {
  std::unique_lock lock(mutex_);
  news_.wait_for(lock, within, [&] {
    return next < frame_.size() || progress_number < progress_number_ || ended_;
  });
  News news{.frame = {},
            .progress = progress_number < progress_number_ ? progress_ : nullptr,
            .progress_number = progress_number_,
            .ended = ended_};
  if (next < frame_.size()) {
    news.frame.assign(frame_.begin() + static_cast<std::ptrdiff_t>(next), frame_.end());
  }
  return news;
}

}  // namespace palpate
