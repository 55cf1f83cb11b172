// The insides of the emulated Inverse service: what it is in inverse_emulation.h, its
// connections in emulated_session.cc.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <poll.h>

#include "runtime/inverse/emulated_inverse.h"
#include "runtime/realtime/clock.h"

namespace palpate {

// All but the accessors' reading happens in the service's thread.
struct EmulatedInverse::Parts {
  class Session;  // emulated_session.cc
  explicit Parts(const EmulatedInverseConfig& wanted);
  ~Parts();
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  // @throws DeviceError if a port cannot be had.
  void listen();
  // Serves until something is written into `wake`.
  void run();
  void accept(const pollfd& acceptor);
  void release() {
    const std::lock_guard lock(mutex);
    service.release();
  }
  void tell(const std::string& event);

  EmulatedInverseConfig config;  // with the ports that were had
  MonotonicClock clock;
  mutable std::mutex mutex;  // the service
  InverseEmulation service;
  int wake = -1;
  int states = -1;
  int events = -1;
  std::vector<std::shared_ptr<Session>> sessions;
  std::thread thread;
};

}  // namespace palpate
