// What a service has answered so far, for whoever shows it.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "formats/service/service_message.h"

namespace palpate {

/// An answer of a node; shared, because it never changes.
struct ServedAnswer {
  AnswerQuality quality = AnswerQuality::kPreliminary;
  std::shared_ptr<const WorkUnitNode> node;
};

/// By node, of one tool. Any thread.
class ServedAnswers {
 public:
  explicit ServedAnswers(std::int64_t nodes)
      : answer_(static_cast<std::size_t>(nodes)) {}

  /// @returns whether it is news: of no lower quality than what was known, and not the
  /// same response again.
  bool take(std::shared_ptr<const WorkUnitNode> node, AnswerQuality quality);

  /// Of another scene: from now on every answer is news.
  void outdate();

  /// None where there is none, or the node is not there.
  [[nodiscard]] std::optional<ServedAnswer> at(std::int32_t node) const;

  /// Nodes that changed since a number of changes, each once, ascending; which is then
  /// set to that of now. From 0: all that have an answer.
  [[nodiscard]] std::vector<std::int32_t> changed_since(std::size_t& changes) const;

  [[nodiscard]] std::vector<ServedAnswer> all() const;

 private:
  mutable std::mutex mutex_;
  std::vector<ServedAnswer> answer_;
  std::vector<std::int32_t> changed_;  // nodes, in turn
  std::vector<bool> outdated_;         // empty: none is
};

}  // namespace palpate
