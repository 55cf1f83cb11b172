// The insides of the emulated Inverse service: its state in emulated_inverse.cc, its
// connections in emulated_session.cc.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <poll.h>

#include "runtime/inverse/emulated_inverse.h"
#include "runtime/realtime/clock.h"

namespace palpate {

// All but the accessors' reading happens in the service's thread.
struct EmulatedInverse::Parts {
  class Session;  // emulated_session.cc
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  explicit Parts(const EmulatedInverseConfig& wanted);
  ~Parts();
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  // @throws DeviceError if a port cannot be had.
  void listen();
  // Serves until something is written into `wake`.
  void run();
  void accept(const pollfd& acceptor);
  [[nodiscard]] bool is_faulty(InverseFault fault) const {
    const InverseFaults& f = config.faults;
    return f.fault == fault && message >= f.from &&
           (f.count < 0 || message < f.from + f.count) &&
           (message - f.from) % f.every == 0;
  }
  [[nodiscard]] std::string version() const;
  [[nodiscard]] std::string first_message();
  [[nodiscard]] std::string answer();
  [[nodiscard]] nlohmann::json state(bool whole);
  [[nodiscard]] nlohmann::json grips();
  void obey(const std::string& text);
  void push(const Eigen::Vector3d& force_n);
  void release() {
    const std::lock_guard lock(mutex);
    push(Eigen::Vector3d::Zero());
  }
  void tell(const std::string& event);

  EmulatedInverseConfig config;  // with the ports that were had
  MonotonicClock clock;
  SimulatedDevice tool;
  mutable std::mutex mutex;  // what follows, and the tool
  std::int64_t message = 0;
  std::int64_t first_ns = 0;  // of messages
  std::int64_t released_ns = 0;
  std::string profile;
  std::string refused;
  std::vector<MotorRecord> trace;
  const char* key = nullptr;
  bool reported = false;
  std::int64_t idle_due_ns = kNever;  // when the force ends
  int wake = -1;
  int states = -1;
  int events = -1;
  std::vector<std::shared_ptr<Session>> sessions;
  std::thread thread;
};

}  // namespace palpate
