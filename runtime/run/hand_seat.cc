#include "runtime/run/hand_seat.h"

#include <utility>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/device/socket_device.h"
#include "runtime/hand/wandering_hand.h"

namespace palpate {

HandSeat seat_of(const SimulationOptions& options, const std::filesystem::path& socket,
                 const std::optional<AttachedDevice>& attached) {
  HandSeat seat;
  if (attached) {
    seat.attached = &*attached;
    seat.limits = attached->limits;
  } else if (!socket.empty()) {
    seat.connected = std::make_unique<SocketDevice>(socket);
    seat.limits = seat.connected->limits();
  } else {
    SimulatedClock clock;
    seat.limits = SimulatedDevice(options.device, HandScript{}, clock, {}).limits();
  }
  return seat;
}

std::unique_ptr<Device> make_device(const SimulationOptions& options, HandSeat& seat,
                                    const HandScript& script, bool several,
                                    Clock& clock) {
  if (seat.attached != nullptr) {
    return seat.attached->make(script);
  }
  if (seat.connected != nullptr) {
    return std::move(seat.connected);
  }
  auto device = std::make_unique<SimulatedDevice>(
      options.device, script, clock,
      SimulatedMotion{.position_m = script.at(0.0).position_m});
  if (several) {
    device->turn_by({.normal = script.normal,
                     .tilt_rad = options.tilt_rad,
                     .turn_rad = options.turn_rad});
  }
  return device;
}

DeviceLimits weaker(const DeviceLimits& a, const DeviceLimits& b, double hold_s) {
  return stability_bounds(a, hold_s).renderable_n_per_m() <=
                 stability_bounds(b, hold_s).renderable_n_per_m()
             ? a
             : b;
}

std::unique_ptr<Device> wandering_device(const PressedBody& body,
                                         const SimulationOptions& options,
                                         const SimulatedDeviceConfig& config,
                                         Clock& clock) {
  if (options.attached || !options.socket.empty()) {
    throw InputError("a simulated hand wanders, none that holds a device");
  }
  if (body.database == nullptr) {
    throw InputError("a hand wanders over a body in memory: leave out --stream");
  }
  constexpr double kPress = 0.3;  // of the depth that is computed
  const WanderOptions wander{.speed_m_per_s = options.wander_m_per_s,
                             .touch_m = nominal_height_m(body.tool),
                             .press_m = kPress * body.depth_max_m};
  return std::make_unique<WanderingDevice>(
      config,
      WanderingHand(body.database->body, body.database->normal, body.open, wander),
      clock);
}

bool is_simulated(const SimulationOptions& options, int hand) {
  return hand == 0 ? options.socket.empty() && !options.attached
                   : options.together->socket.empty() && !options.together->attached;
}

bool are_simulated(const SimulationOptions& options) {
  return is_simulated(options, 0) && (!options.together || is_simulated(options, 1));
}

}  // namespace palpate
