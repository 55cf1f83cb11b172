#include "runtime/served/served_client.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/served/stiffness_estimate.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kListen{20};  // at once; a hand waits for no more than that
constexpr milliseconds kSend{100};   // that a service has to take a hand's place in

std::string ended_text(int exit_code) {
  return exit_code == ServiceProcess::kReapedElsewhere
             ? "(this program reaps its children, so with what exit code is not known)"
             : fmt::format("with exit code {}", exit_code);
}

bool is_over(ServiceState state) {
  return state == ServiceState::kDone || state == ServiceState::kFailed;
}

}  // namespace

std::string_view name(ServiceState state) noexcept {
  constexpr std::array<std::string_view, 8> kNames{
      "joining",  "serving",       "silent", "lost",
      "nonsense", "another scene", "done",   "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

ServedClient::ServedClient(ServedClientOptions options) : options_(std::move(options)) {
  connection_ = ServiceConnection::join(options_.socket);
  if (connection_) {
    status_.joins = 1;
  } else if (options_.start) {
    process_ = options_.start(false);
    status_.started = true;
  }
  last_ = Clock::now();
  thread_ = std::thread([this] {
    run();
  });
}

ServedClient::~ServedClient() {
  stop_.store(true);
  changed_.notify_all();
  thread_.join();
}

const ServedScene& ServedClient::scene(const std::atomic<bool>& stop) {
  const auto deadline = Clock::now() + kPatience;
  std::unique_lock lock(mutex_);
  while (!scene_known_ && !ended_ && refusal_.empty()) {
    // Woken by the thread of the connection, or to look whether the user has stopped.
    changed_.wait_for(lock, milliseconds(50));
    if (stop.load()) {
      throw Interrupted();
    }
    if (Clock::now() > deadline) {
      throw InputError(fmt::format("{}: no service has sent a scene within {} s{}{}",
                                   options_.socket.string(), kPatience.count(),
                                   status_.detail.empty() ? "" : ": ", status_.detail));
    }
  }
  if (!refusal_.empty()) {
    throw InputError(refusal_);
  }
  if (!scene_known_) {
    throw InputError(
        fmt::format("palpate-precompute serve ended {} before it sent its scene; what "
                    "it said stands above",
                    ended_text(*ended_)));
  }
  return *scene_;
}

void ServedClient::feed(GrowingElements& elements) {
  const std::lock_guard lock(feed_mutex_);
  fed_.push_back(&elements);
  std::vector<GrownNode> ready_nodes;
  if (options_.estimate) {
    for (const WorkUnitNode& answer : estimated_answers(*scene_, tool_)) {
      ready_nodes.push_back(ready(answer, GrownQuality::kEstimated));
    }
  }
  for (const ServedAnswer& answer : answers_->all()) {
    ready_nodes.push_back(ready(*answer.node, grown(answer.quality)));
  }
  elements.hand_over(std::move(ready_nodes));
}

void ServedClient::forget(const GrowingElements& elements) {
  const std::lock_guard lock(feed_mutex_);
  fed_.erase(std::remove(fed_.begin(), fed_.end(), &elements), fed_.end());
}

ServiceStatus ServedClient::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

std::string ServedClient::scene_text() const {
  const std::lock_guard lock(mutex_);
  return text_;
}

void ServedClient::set(ServiceState state, const std::string& why) {
  const std::lock_guard lock(mutex_);
  status_.state = state;
  status_.detail = why;
  changed_.notify_all();
}

void ServedClient::pause(milliseconds time) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, time, [this] {
    return stop_.load() || anew_.load();
  });
}

void ServedClient::run() noexcept {
  while (!stop_.load()) {
    try {
      turn();
    } catch (const std::exception& error) {  // of memory, or a defect: it tries again
      leave(ServiceState::kNonsense, error.what());
      pause(options_.again);
    }
  }
  connection_.reset();
  process_.reset();  // ends it
}

void ServedClient::turn() {
  if (anew_.exchange(false)) {
    restart();
  }
  watch_process();
  if (!connection_) {
    join();
    return;
  }
  try {
    listen();
  } catch (const FormatError& error) {
    leave(ServiceState::kNonsense, error.what());
    pause(options_.again);
    return;
  }
  tell_hand();
}

// A child that has ended is waited for, and, before there is a scene, said.
void ServedClient::watch_process() {
  if (process_ == nullptr || !process_->exit_code()) {
    return;
  }
  const int code = *process_->exit_code();
  process_ = nullptr;
  const std::lock_guard lock(mutex_);
  ended_ = code;
  status_.started = false;
  if (!is_over(status_.state) && scene_known_) {
    status_.detail = "the service has ended " + ended_text(code);
  }
  changed_.notify_all();
}

// Somebody else's service that was joined has gone: of a command that was killed.
void ServedClient::start_own() {
  {
    const std::lock_guard lock(mutex_);
    if (process_ != nullptr || ended_ || !options_.start) {
      return;
    }
  }
  try {
    process_ = options_.start(false);
  } catch (const InputError& error) {
    set(ServiceState::kLost, error.what());
    return;
  }
  const std::lock_guard lock(mutex_);
  status_.started = true;
}

void ServedClient::join() {
  if (is_over(status().state)) {
    pause(options_.again);  // nobody is waited for any more
    return;
  }
  connection_ = ServiceConnection::join(options_.socket);
  if (!connection_) {
    start_own();
    // One that was just started is looked for more often.
    pause(process_ != nullptr ? milliseconds(50) : options_.again);
    return;
  }
  welcomed_ = false;
  last_ = Clock::now();
  const std::lock_guard lock(mutex_);
  ++status_.joins;
}

void ServedClient::leave(ServiceState state, const std::string& why) {
  connection_.reset();
  welcomed_ = false;
  set(state, why);
}

void ServedClient::listen() {
  const std::optional<ServiceMessage> message = connection_->receive(kListen);
  if (message) {
    take(*message);
    last_ = Clock::now();
    return;
  }
  if (!connection_->is_open()) {
    const ServiceState state = status().state;
    if (is_over(state) || state == ServiceState::kOther) {
      connection_.reset();
    } else {
      leave(scene_ == nullptr ? ServiceState::kJoining : ServiceState::kLost,
            "the service is gone; its answers stay");
    }
    pause(options_.again);
  } else if (welcomed_ && Clock::now() - last_ > options_.silent) {
    set(ServiceState::kSilent,
        fmt::format("no message for {:.0f} s",
                    std::chrono::duration<double>(Clock::now() - last_).count()));
  }
}

void ServedClient::tell_hand() {
  if (!connection_ || !welcomed_ || Clock::now() - hand_sent_ < kHand) {
    return;
  }
  HandPlace hand;
  {
    const std::lock_guard lock(feed_mutex_);
    const auto moved =
        std::find_if(fed_.begin(), fed_.end(), [&](GrowingElements* one) {
          return one->fetch_hand(hand);
        });
    if (moved == fed_.end()) {
      return;
    }
    std::rotate(fed_.begin(), moved + 1, fed_.end());  // its turn comes last now
  }
  hand.tool = tool_;
  hand_sent_ = Clock::now();
  static_cast<void>(connection_->send(hand, kSend));  // a failure is seen by listen()
}

void ServedClient::restart() {
  if (!options_.start) {
    set(status().state, "no service can be started from here");
    return;
  }
  const bool ours = process_ != nullptr;
  set(ServiceState::kJoining, "the service before it ends");
  connection_.reset();
  welcomed_ = false;
  process_ = nullptr;  // ends it
  if (!ours && ServiceConnection::join(options_.socket)) {
    set(ServiceState::kOther,
        "a service that was started elsewhere listens there: end it first");
    pause(options_.again);
    return;
  }
  renewing_ = true;
  try {
    process_ = options_.start(true);
  } catch (const InputError& error) {
    set(ServiceState::kLost, error.what());
    return;
  }
  set(ServiceState::kJoining, "");
  const std::lock_guard lock(mutex_);
  status_.started = true;
  status_.progress = {};
}

}  // namespace palpate
