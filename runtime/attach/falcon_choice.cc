#include "runtime/attach/falcon_choice.h"

#include <cstdint>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/sha256.h"

namespace palpate {
namespace {

// Which image it is: the vendor's cannot be distinguished from others otherwise.
void tell_of_firmware(const DeviceRequest& request,
                      const std::vector<std::uint8_t>& image) {
  if (request.tell) {
    Sha256 digest;
    digest.update(std::as_bytes(std::span(image)));
    request.tell(fmt::format("{}: firmware {}: {} bytes, SHA-256 {}", request.name,
                             request.firmware, image.size(), digest.hex()));
  }
}

}  // namespace

FalconConfig falcon_config(const DeviceRequest& request) {
  if (!(request.calibration >= 0.2 && request.calibration <= 5.0)) {
    throw InputError(fmt::format("calibration factor is {}, must lie in [0.2, 5]",
                                 request.calibration));
  }
  if (!(request.homing_s > 0.0 && request.homing_s < 1e4)) {
    throw InputError(
        fmt::format("time for homing is {} s, must lie in (0, 1e4)", request.homing_s));
  }
  FalconConfig config;
  config.calibration = request.calibration;
  config.homing_s = request.homing_s;
  config.tell = request.tell;
  config.stopped = request.stopped;
  config.event_character = request.event_character;
  config.what = request.name;
  if (!request.firmware.empty()) {
    config.firmware = read_firmware(request.firmware);
    tell_of_firmware(request, config.firmware);
  }
  if (!request.plane.empty()) {
    throw InputError(fmt::format("--plane {}: a {} moves in all three dimensions",
                                 request.plane, request.name));
  }
  return config;
}

}  // namespace palpate
