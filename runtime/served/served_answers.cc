#include "runtime/served/served_answers.h"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

bool same(const NodeResponse& a, const NodeResponse& b) {
  return a.depth_m == b.depth_m && a.force_n == b.force_n &&
         a.direction == b.direction && a.tilt == b.tilt &&
         a.touch_offset_m == b.touch_offset_m;
}

}  // namespace

bool ServedAnswers::take(std::shared_ptr<const WorkUnitNode> node,
                         AnswerQuality quality) {
  const std::lock_guard lock(mutex_);
  const auto i = static_cast<std::size_t>(node->vertex);
  ServedAnswer& known = answer_[i];
  const bool outdated = !outdated_.empty() && outdated_[i];
  if (known.node != nullptr && !outdated &&
      (quality < known.quality ||
       (quality == known.quality && same(node->response, known.node->response)))) {
    return false;
  }
  changed_.push_back(node->vertex);
  known = {.quality = quality, .node = std::move(node)};
  if (outdated) {
    outdated_[i] = false;
  }
  return true;
}

void ServedAnswers::outdate() {
  const std::lock_guard lock(mutex_);
  outdated_.assign(answer_.size(), true);
}

std::optional<ServedAnswer> ServedAnswers::at(std::int32_t node) const {
  const std::lock_guard lock(mutex_);
  if (node < 0 || node >= std::ssize(answer_) ||
      answer_[static_cast<std::size_t>(node)].node == nullptr) {
    return std::nullopt;
  }
  return answer_[static_cast<std::size_t>(node)];
}

std::vector<std::int32_t> ServedAnswers::changed_since(std::size_t& changes) const {
  const std::lock_guard lock(mutex_);
  const std::size_t from = std::min(changes, changed_.size());
  std::vector<std::int32_t> nodes(changed_.begin() + static_cast<std::ptrdiff_t>(from),
                                  changed_.end());
  changes = changed_.size();
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::vector<ServedAnswer> ServedAnswers::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<ServedAnswer> all;
  std::copy_if(answer_.begin(), answer_.end(), std::back_inserter(all),
               [](const ServedAnswer& answer) {
                 return answer.node != nullptr;
               });
  return all;
}

}  // namespace palpate
