#include "runtime/served/served_client.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tilt_line.h"
#include "runtime/served/stiffness_estimate.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kListen{20};  // at once; a hand waits for no more than that
constexpr milliseconds kSend{100};   // that a service has to take a hand's place in

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
    changed_.wait_for(lock, milliseconds(50));
    if (stop.load()) {
      throw Interrupted();
    }
    if (Clock::now() > deadline) {
      throw InputError(fmt::format("{}: no service has told a scene within {} s{}{}",
                                   options_.socket.string(), kPatience.count(),
                                   status_.detail.empty() ? "" : ": ", status_.detail));
    }
  }
  if (!refusal_.empty()) {
    throw InputError(refusal_);
  }
  if (!scene_known_) {
    throw InputError(
        fmt::format("palpate-precompute serve ended with exit code {} before it told "
                    "its scene; what it said stands above",
                    *ended_));
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
    status_.detail = fmt::format("the service has ended with exit code {}", code);
  }
  changed_.notify_all();
}

void ServedClient::join() {
  if (is_over(status().state)) {
    pause(options_.again);  // nobody is waited for any more
    return;
  }
  connection_ = ServiceConnection::join(options_.socket);
  if (!connection_) {
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

void ServedClient::take(const ServiceMessage& message) {
  if (const auto* scene = std::get_if<ServedScene>(&message)) {
    if (welcomed_) {
      throw FormatError("the service has told its scene twice");
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

void ServedClient::take_scene(const ServedScene& scene) {
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

// The file knows more than was told: nodes between those that were solved, and all of
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
