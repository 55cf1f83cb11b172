// What a ServedClient does with the messages of its service.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tilt_line.h"
#include "runtime/served/served_client.h"

namespace palpate {

void ServedClient::take(const ServiceMessage& message) {
  if (const auto* scene = std::get_if<ServedScene>(&message)) {
    if (welcomed_) {
      throw FormatError("the service has sent its scene twice");
    }
    take_scene(*scene);
    return;
  }
  if (!welcomed_) {
    throw FormatError("the service has not begun with its scene");
  }
  if (const auto* responses = std::get_if<ServedResponses>(&message)) {
    take_responses(*responses);
  } else if (const auto* progress = std::get_if<ServedProgress>(&message)) {
    const std::lock_guard lock(mutex_);
    status_.progress = *progress;
  } else if (const auto* end = std::get_if<ServedEnd>(&message)) {
    take_end(*end);
    return;
  } else {
    throw FormatError("a service has no hand to tell of");
  }
  if (status().state != ServiceState::kServing) {
    set(ServiceState::kServing, "");
  }
}

// Whoever listens there may compute another scene, or the file's text of before.
bool ServedClient::refuses(const ServedScene& scene) {
  if (options_.text.empty() || scene.plan.provenance.scene_toml == options_.text) {
    return false;
  }
  const std::string why = fmt::format(
      "{}: who listens there computes another scene than the file has, or its text of "
      "before: end that service, or give another output",
      options_.socket.string());
  {
    const std::lock_guard lock(mutex_);
    refusal_ = why;
  }
  leave(ServiceState::kOther, why);
  pause(options_.again);
  return true;
}

void ServedClient::take_scene(const ServedScene& scene) {
  if (scene_ == nullptr && refuses(scene)) {
    return;
  }
  if (scene_ == nullptr) {
    take_first(scene);
  } else if (scene.plan.digest != digest_) {
    const bool same = same_body(scene_->plan, scene.plan, tool_);
    if (!same || !renewing_) {
      leave(ServiceState::kOther,
            same ? "who listens there computes the scene with other values"
                 : "the body or its tool has changed: end this and start it again");
      pause(options_.again);
      return;
    }
    digest_ = scene.plan.digest;
    answers_->outdate();
    const std::lock_guard lock(feed_mutex_);
    for (GrowingElements* elements : fed_) {
      elements->outdate();
    }
  }
  renewing_ = false;
  welcomed_ = true;
  const std::lock_guard lock(mutex_);
  text_ = scene.plan.provenance.scene_toml;
  status_.state = ServiceState::kServing;
  status_.detail.clear();
  scene_known_ = true;  // last: scene() waits for it
  changed_.notify_all();
}

void ServedClient::take_first(const ServedScene& scene) {
  std::string refusal;
  try {
    tool_ = tool_index(scene.plan, options_.tool);
    check_rendered(scene.plan, tool_);
  } catch (const InputError& error) {
    refusal = error.what();
  }
  scene_ = std::make_unique<ServedScene>(scene);
  longest_edge_m_ = longest_edges_m(scene.plan.body);
  answers_ = std::make_unique<ServedAnswers>(scene.plan.body.position_m.rows());
  digest_ = scene.plan.digest;
  const std::lock_guard lock(mutex_);
  refusal_ = refusal;
}

GrownNode ServedClient::ready(const WorkUnitNode& answer, GrownQuality quality) const {
  const JobDescription& plan = scene_->plan;
  return grown_node(plan.tool[static_cast<std::size_t>(tool_)], answer, quality,
                    plan.body.position_m.row(answer.vertex).transpose(),
                    plan.normal.row(answer.vertex).transpose(),
                    longest_edge_m_[static_cast<std::size_t>(answer.vertex)]);
}

// The file knows more than was sent: nodes between those that were solved, and all of
// them where it was whole before.
void ServedClient::take_end(const ServedEnd& end) {
  if (end.file.empty()) {
    set(ServiceState::kFailed, end.failure);
    return;
  }
  try {
    take_known(answers_of(read_database(end.file), scene_->plan, tool_));
    set(ServiceState::kDone, end.file);
  } catch (const Error& error) {
    set(ServiceState::kFailed, error.what());
  }
}

// All of a message is looked at before anything of it is used.
void ServedClient::take_responses(const ServedResponses& responses) {
  const JobDescription& plan = scene_->plan;
  for (const WorkUnitNode& node : responses.node) {
    if (node.vertex >= plan.body.position_m.rows() ||
        node.tool >= std::ssize(plan.tool)) {
      throw FormatError(fmt::format("vertex {}, tool {}: the scene has {} and {}",
                                    node.vertex, node.tool, plan.body.position_m.rows(),
                                    plan.tool.size()));
    }
  }
  take_known(responses);
}

void ServedClient::take_known(const ServedResponses& responses) {
  std::vector<GrownNode> ready_nodes;
  for (const WorkUnitNode& node : responses.node) {
    if (node.tool == tool_ &&
        answers_->take(std::make_shared<const WorkUnitNode>(node), responses.quality)) {
      ready_nodes.push_back(ready(node, grown(responses.quality)));
    }
  }
  {
    const std::lock_guard lock(mutex_);
    status_.answers += std::ssize(ready_nodes);
  }
  const std::lock_guard lock(feed_mutex_);
  for (GrowingElements* elements : fed_) {
    elements->hand_over(ready_nodes);
  }
}

}  // namespace palpate
