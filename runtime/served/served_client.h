// The runtime's end of the service of a scene (formats/service/SERVICE.md). This end is
// a thread that joins, listens, and hands answers to the slow process, which never
// waits for it. Whatever the service does, what has been answered stays and is
// rendered.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/service/service_message.h"
#include "formats/service/service_socket.h"
#include "runtime/served/growing_elements.h"
#include "runtime/served/served_answers.h"
#include "runtime/served/served_scene.h"
#include "runtime/served/service_process.h"

namespace palpate {

enum class ServiceState : std::uint8_t {
  kJoining,   ///< nobody has sent a scene yet
  kServing,   ///< messages come
  kSilent,    ///< joined, but no message for some time
  kLost,      ///< it is gone; joined again as soon as somebody listens there
  kNonsense,  ///< what came was no message; left, and joined again
  kOther,     ///< who listens there computes another scene
  kDone,      ///< it has said its last: the database is whole
  kFailed,    ///< it has said its last: why there is none
};

/// "joining", "serving", "silent", "lost", "nonsense", "another scene", "done",
/// "failed".
[[nodiscard]] std::string_view name(ServiceState state) noexcept;

struct ServiceStatus {
  ServiceState state = ServiceState::kJoining;
  std::string detail;       ///< why, for a person, or the database; may be empty
  ServedProgress progress;  ///< as last received
  std::int64_t joins = 0;
  std::int64_t answers = 0;  ///< of the tool that is rendered, as they came
  bool started = false;      ///< the service is this process' child
};

struct ServedClientOptions {
  std::filesystem::path socket;
  std::string tool = {};  ///< that is rendered; empty: the only one
  std::string text = {};  ///< of the scene that must be served; empty: any
  /// Starts a service that listens at the socket; null: one is joined only.
  std::function<std::unique_ptr<ServiceProcess>(bool anew)> start = nullptr;
  std::chrono::milliseconds silent{3000};  ///< without a message: kSilent
  std::chrono::milliseconds again{1000};   ///< between attempts to join
  bool estimate = false;  ///< places without an answer: as stiffness_estimate.h
};

/// Scene and answers may be read from any thread.
class ServedClient {
 public:
  static constexpr std::chrono::milliseconds kHand{50};  ///< between HandPlaces
  static constexpr std::chrono::seconds kPatience{60};   ///< for the first scene

  /// Joins who listens at the socket; if nobody does, or one that was joined goes,
  /// starts a service.
  /// @throws InputError if it cannot be started, or the path is too long.
  explicit ServedClient(ServedClientOptions options);
  /// Leaves. A service that was started here ends.
  ~ServedClient();
  ServedClient(const ServedClient&) = delete;
  ServedClient& operator=(const ServedClient&) = delete;

  /// Waits for the service's scene. Its body, normals and tool never change from then
  /// on. @throws InputError if the service ended before, or none came within kPatience.
  /// @throws InputError for another scene than the one that must be served (kOther),
  /// and for a tool that is not there. @throws InputError for what is not rendered
  /// while it is computed: tools of several contacts, responses that relax or yield.
  /// Interrupted if `stop` was set.
  [[nodiscard]] const ServedScene& scene(const std::atomic<bool>& stop);

  /// After scene(): hands this body all answers of the tool so far, and all to come.
  /// Tells the service where the body's hand is; those of several take turns. Until
  /// forget(), which must come before its end.
  void feed(GrowingElements& elements);
  void forget(const GrowingElements& elements);

  /// After scene().
  [[nodiscard]] const ServedAnswers& answers() const noexcept { return *answers_; }
  [[nodiscard]] std::int32_t tool() const noexcept { return tool_; }

  [[nodiscard]] ServiceStatus status() const;

  /// The scene that is served, as its file had it.
  [[nodiscard]] std::string scene_text() const;

  /// Any thread: the service that was started here ends, and another one starts: the
  /// scene was changed, or the service is gone. What is rendered stays until there are
  /// new answers. Without effect, but for a word in the status, where somebody else's
  /// service listens, or none can be started.
  void start_anew() noexcept { anew_.store(true); }

 private:
  using Clock = std::chrono::steady_clock;

  void run() noexcept;
  void turn();
  void join();
  void start_own();
  void listen();
  void tell_hand();
  void watch_process();
  void restart();
  void take(const ServiceMessage& message);
  void take_scene(const ServedScene& scene);
  void take_first(const ServedScene& scene);
  [[nodiscard]] bool refuses(const ServedScene& scene);
  void take_responses(const ServedResponses& responses);
  void take_known(const ServedResponses& responses);
  void take_end(const ServedEnd& end);
  [[nodiscard]] GrownNode ready(const WorkUnitNode& answer, GrownQuality quality) const;
  void leave(ServiceState state, const std::string& why);
  void set(ServiceState state, const std::string& why);
  void pause(std::chrono::milliseconds time);

  ServedClientOptions options_;
  std::unique_ptr<ServiceProcess> process_;  // the thread's, once it runs
  std::optional<ServiceConnection> connection_;
  bool welcomed_ = false;   // the connection has sent its scene
  bool renewing_ = false;   // another scene is expected
  Clock::time_point last_;  // message
  Clock::time_point hand_sent_;

  // Set once, before scene_known_.
  std::unique_ptr<ServedScene> scene_;
  std::vector<double> longest_edge_m_;  // at the nodes of the scene's body
  std::unique_ptr<ServedAnswers> answers_;
  std::int32_t tool_ = 0;
  std::string digest_;  // the thread's

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  bool scene_known_ = false;
  std::string refusal_;  // of scene()
  std::optional<int> ended_;
  ServiceStatus status_;
  std::string text_;

  std::mutex feed_mutex_;
  std::vector<GrowingElements*> fed_;
  std::atomic<bool> anew_ = false;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// Feeds a body as long as it lives.
class Feeding {
 public:
  Feeding(ServedClient& client, GrowingElements& elements)
      : client_(client), elements_(elements) {
    client_.feed(elements);
  }
  ~Feeding() { client_.forget(elements_); }
  Feeding(const Feeding&) = delete;
  Feeding& operator=(const Feeding&) = delete;

 private:
  ServedClient& client_;
  GrowingElements& elements_;
};

}  // namespace palpate
