// A service of a scene in a thread, made of formats/service alone: it answers with a
// database's responses, or says what a test wants.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/service/service_message.h"
#include "formats/service/service_socket.h"

namespace palpate {

/// The scene of a database's body and tools.
inline ServedScene served_scene(const ResponseDatabase& database,
                                const std::string& digest = "a scene") {
  ServedScene scene;
  scene.plan.digest = digest;
  scene.plan.units = 1;
  scene.plan.body = database.body;
  scene.plan.normal = database.normal;
  for (const ResponseTable& table : database.tools) {
    scene.plan.tool.push_back(table.tool);
    scene.plan.depth_max_m = std::max(scene.plan.depth_max_m, table.depth_max_m());
  }
  scene.plan.force_relative = 0.05;
  scene.plan.force_max_n = 8.0;
  for (std::int32_t i = 0; i < database.body.position_m.rows(); ++i) {
    scene.reachable.push_back(i);
  }
  scene.plan.reachable = std::ssize(scene.reachable);
  scene.output = "/nowhere/served.h5";
  scene.plan.provenance.writer = "a test";
  scene.plan.provenance.scene_toml = digest;
  return scene;
}

/// The first tool's response of a node, its forces times `scale`.
inline WorkUnitNode served_node(const ResponseDatabase& database, std::int32_t node,
                                double scale = 1.0) {
  const ResponseTable& table = database.tools.front();
  const CurveView curve = table.curve(node);
  WorkUnitNode answer{.tool = 0, .vertex = node};
  if (!curve.depth_m.empty()) {
    answer.response.direction = table.direction.row(node).transpose();
    answer.response.touch_offset_m =
        table.touch_offset_m[static_cast<std::size_t>(node)];
    answer.response.depth_m.assign(curve.depth_m.begin(), curve.depth_m.end());
    for (const double force_n : curve.force_n) {
      answer.response.force_n.push_back(scale * force_n);
    }
    answer.response.origin = ResponseOrigin::kSimulated;
    answer.response.error_relative = 0.2;
  }
  return answer;
}

/// All of them.
inline ServedResponses served_responses(const ResponseDatabase& database,
                                        AnswerQuality quality, double scale = 1.0) {
  ServedResponses responses{.quality = quality, .node = {}};
  for (std::int32_t i = 0; i < database.body.position_m.rows(); ++i) {
    responses.node.push_back(served_node(database, i, scale));
  }
  return responses;
}

/// Listens until it is destroyed; whoever joins is served by `script`, in turn.
class FakeService {
 public:
  /// What is done with one who joined: @param goes_on false: the service is to end.
  using Script =
      std::function<void(ServiceConnection&, const std::function<bool()>& goes_on)>;

  FakeService(const std::filesystem::path& socket, Script script)
      : listener_(std::make_unique<ServiceListener>(socket)),
        script_(std::move(script)),
        thread_([this] {
          run();
        }) {}
  ~FakeService() { die(); }

  /// As by kill -9: every connection ends, nobody listens.
  void die() {
    stop_.store(true);
    if (thread_.joinable()) {
      thread_.join();
    }
    listener_.reset();
  }

  [[nodiscard]] int joined() const noexcept { return joined_.load(); }

  /// What the one who joined has said of its hand.
  [[nodiscard]] std::vector<HandPlace> hands() const {
    const std::lock_guard lock(mutex_);
    return hands_;
  }

  /// Listens to the hand for so long, or until the end.
  void listen(ServiceConnection& to, std::chrono::milliseconds time,
              const std::function<bool()>& goes_on) {
    const auto deadline = std::chrono::steady_clock::now() + time;
    while (goes_on() && to.is_open() && std::chrono::steady_clock::now() < deadline) {
      if (const auto message = to.receive(std::chrono::milliseconds(5))) {
        const std::lock_guard lock(mutex_);
        hands_.push_back(std::get<HandPlace>(*message));
      }
    }
  }

 private:
  void run() {
    const auto goes_on = [this] {
      return !stop_.load();
    };
    while (goes_on()) {
      if (auto joined = listener_->accept(std::chrono::milliseconds(5))) {
        ++joined_;
        script_(*joined, goes_on);
      }
    }
  }

  std::unique_ptr<ServiceListener> listener_;
  Script script_;
  std::atomic<bool> stop_ = false;
  std::atomic<int> joined_ = 0;
  mutable std::mutex mutex_;
  std::vector<HandPlace> hands_;
  std::thread thread_;
};

}  // namespace palpate
