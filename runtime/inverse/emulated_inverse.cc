#include "runtime/inverse/emulated_inverse.h"

#include <sys/eventfd.h>

#include "runtime/inverse/emulated_inverse_parts.h"
#include "runtime/realtime/real_time.h"

namespace palpate {

EmulatedInverse::Parts::Parts(const EmulatedInverseConfig& wanted)
    : config(wanted), service(wanted, clock, [this](const std::string& event) {
        tell(event);
      }) {}

EmulatedInverse::EmulatedInverse(const EmulatedInverseConfig& config)
    : parts_(std::make_unique<Parts>(config)) {
  parts_->listen();
  parts_->thread = std::thread([parts = parts_.get()] {
    static_cast<void>(request_real_time(-1));  // as punctual as a device, if permitted
    parts->run();
  });
}

EmulatedInverse::~EmulatedInverse() {
  static_cast<void>(::eventfd_write(parts_->wake, 1));
  parts_->thread.join();
}

std::uint16_t EmulatedInverse::port() const {
  return parts_->config.port;
}

std::uint16_t EmulatedInverse::events_port() const {
  return parts_->config.events_port;
}

Eigen::Vector3d EmulatedInverse::force_n() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->service.tool().acting_force_n();
}

std::int64_t EmulatedInverse::messages() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->service.messages();
}

std::string EmulatedInverse::profile() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->service.profile();
}

std::string EmulatedInverse::refused() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->service.refused();
}

double EmulatedInverse::given_to_hand_j() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->service.given_to_hand_j();
}

std::int64_t EmulatedInverse::released_ns() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->service.released_ns();
}

std::vector<MotorRecord> EmulatedInverse::trace() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->service.trace();
}

}  // namespace palpate
