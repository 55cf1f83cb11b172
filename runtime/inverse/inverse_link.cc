#include "runtime/inverse/inverse_link.h"

#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/inverse/service_connection.h"

namespace palpate {
namespace {

constexpr double kSendS = 0.005;
constexpr int kEventsMax = 16;  // that are looked at between two commands

}  // namespace

InverseLink::InverseLink(InverseConfig config) : session_(std::move(config)) {}

InverseLink::~InverseLink() {
  close();
}

void InverseLink::open() {
  close();
  failure_ = "";
  session_ = InverseSession(config());
  try {
    greet();
  } catch (const DeviceError& error) {
    close();
    throw DeviceError(fmt::format("{}: {}", config().what, error.what()));
  }
}

void InverseLink::greet() {
  const std::string said = http_get(config().port, "/version", config().open_s);
  const auto version = inverse_version(said);
  const char* const key = version ? force_key(*version) : nullptr;
  if (key == nullptr) {
    throw DeviceError(
        fmt::format("version of the service is {}, must be 3.1 or later",
                    version ? fmt::format("{}.{}", version->major, version->minor)
                            : "not to be read from what it says"));
  }
  // Before the first force, so that no event is missed.
  events_ = std::make_unique<InverseSocket>(config().events_port, config().open_s);
  states_ = std::make_unique<InverseSocket>(config().port, config().open_s);
  std::string_view text;  // the service speaks first
  if (states_->receive(text, inverse_deadline_ns(config().open_s)) !=
      SocketRead::kMessage) {
    throw DeviceError(states_->failure() != nullptr
                          ? states_->failure()
                          : "the service does not say what devices it has");
  }
  session_.greet(text, key);
  if (exchange(Eigen::Vector3d::Zero(), config().profile) != LinkStatus::kOk) {
    throw DeviceError(*failure_ != '\0' ? failure_ : "does not answer a first command");
  }
}

// The last message of a session that still takes any is zero force; then it ends, and
// whatever it had asked for.
LinkStatus InverseLink::give_up(const char* why) noexcept {
  if (*failure_ == '\0') {
    failure_ = why;
    static_cast<void>(send(Eigen::Vector3d::Zero(), ""));
    states_->send_close();
    states_.reset();
    events_.reset();
  }
  return LinkStatus::kLost;
}

bool InverseLink::send(const Eigen::Vector3d& force_n,
                       std::string_view profile) noexcept {
  return states_->send(session_.command(force_n, profile), inverse_deadline_ns(kSendS));
}

// What lies there before a command: answers that came late, and states that nobody
// asked for. Null if these are not too many.
const char* InverseLink::take_waiting() noexcept {
  std::string_view text;
  for (;;) {
    const SocketRead read = states_->receive(text, 0);
    if (read == SocketRead::kNothing) {
      return nullptr;
    }
    const char* why =
        read == SocketRead::kLost ? states_->failure() : session_.take(text);
    if (why != nullptr) {
      return why;
    }
  }
}

LinkStatus InverseLink::exchange(const Eigen::Vector3d& force_n,
                                 std::string_view profile) noexcept {
  if (const char* why = take_waiting()) {
    return give_up(why);
  }
  if (!send(force_n, profile)) {
    return give_up(states_->failure());
  }
  std::int64_t deadline_ns = inverse_deadline_ns(config().answer_s);
  bool in_time = false;
  for (;;) {
    std::string_view text;
    switch (states_->receive(text, deadline_ns)) {
      case SocketRead::kLost:
        return give_up(states_->failure());
      case SocketRead::kMessage:
        if (const char* why = session_.take(text)) {
          return give_up(why);
        }
        in_time = true;
        // Those that answer missed commands come first; the last one counts.
        deadline_ns =
            inverse_deadline_ns(session_.missing() ? InverseSession::kQuietS : 0.0);
        break;
      case SocketRead::kNothing:
        if (const char* why = session_.exchanged(in_time)) {
          return give_up(why);
        }
        return in_time ? LinkStatus::kOk : LinkStatus::kMissed;
    }
  }
}

const char* InverseLink::heard_fault() noexcept {
  for (int i = 0; i < kEventsMax; ++i) {
    std::string_view text;
    const SocketRead read = events_->receive(text, 0);
    if (read == SocketRead::kNothing) {
      return nullptr;
    }
    if (read == SocketRead::kLost) {
      return "its events end: the service has stopped";
    }
    if (const char* why = session_.take_event(text)) {
      return why;
    }
  }
  return nullptr;
}

LinkStatus InverseLink::transact(const Eigen::Vector3d& force_n,
                                 Eigen::Vector3d& position_m) noexcept {
  if (states_ == nullptr) {  // not open, or lost
    return LinkStatus::kLost;
  }
  if (const char* why = heard_fault()) {
    return give_up(why);
  }
  const LinkStatus status = exchange(force_n, "");
  if (status == LinkStatus::kOk) {
    position_m = session_.position_m();
  }
  return status;
}

void InverseLink::close() noexcept {
  if (states_ != nullptr &&
      exchange(Eigen::Vector3d::Zero(), "") != LinkStatus::kLost) {
    states_->send_close();
  }
  states_.reset();
  events_.reset();
}

}  // namespace palpate
