// FalconLink's set-up: what may fail with a message.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "runtime/realtime/clock.h"
#include "runtime/usb/falcon_link.h"

namespace palpate {
namespace {

constexpr int kQuestions = 100;
constexpr int kLoads = 10;
constexpr std::size_t kChunk = 62;
constexpr std::array<std::uint8_t, 3> kQuestion{0x0A, 0x43, 0x0D};
constexpr std::array<std::uint8_t, 4> kAnswer{0x0A, 0x44, 0x2C, 0x0D};
constexpr std::uint8_t kLoadMark = 0x41;

constexpr UsbRequest request(std::uint8_t number, std::uint16_t value) {
  return {.request_type = 0x40, .request = number, .value = value, .index = 0};
}
constexpr UsbRequest kPurgeReceived = request(0x00, 1);
constexpr UsbRequest kPurgeSent = request(0x00, 2);
constexpr UsbRequest kDtrLow = request(0x01, 0x0100);
constexpr UsbRequest kDtrHigh = request(0x01, 0x0101);
constexpr UsbRequest kRtsLow = request(0x01, 0x0200);
constexpr UsbRequest kNoFlowControl = request(0x02, 0);
constexpr UsbRequest kBootRate = request(0x03, 0x4138);
constexpr UsbRequest kLoadRate = request(0x03, 0x0015);
constexpr UsbRequest kRunRate = request(0x03, 0x0002);
constexpr UsbRequest kEightBits = request(0x04, 0x0008);
constexpr UsbRequest kEventAtEnd = request(0x06, 0x0100 | '>');
constexpr UsbRequest kSlowTimer = request(0x09, 16);
constexpr UsbRequest kFastTimer = request(0x09, 1);

}  // namespace

std::vector<std::uint8_t> read_firmware(const std::string& file) {
  const std::string content =
      read_file(file, kFirmwareBytesMax, "the firmware's image");
  if (content.empty()) {
    throw InputError(fmt::format("{}: the file is empty", file));
  }
  return {content.begin(), content.end()};
}

// Bytes until all have come, or the time is over.
std::size_t FalconLink::listen(std::span<std::uint8_t> bytes, double wait_s) {
  const std::int64_t until_ns = deadline_ns_after(wait_s);
  std::size_t count = 0;
  while (count < bytes.size()) {
    throw_if_stopped();
    std::size_t got = 0;
    const UsbStatus status = usb_->receive(bytes.subspan(count), got, until_ns);
    if (status == UsbStatus::kLost) {
      throw DeviceError("falcon: unplugged while it was set up");
    }
    if (status == UsbStatus::kTimeout) {
      break;
    }
    count += got;
  }
  return count;
}

void FalconLink::throw_if_stopped() const {
  if (config_.stopped && config_.stopped()) {
    throw Interrupted();
  }
}

void FalconLink::run_line() {
  for (const UsbRequest& step :
       {kFastTimer, kRunRate, kEightBits, kNoFlowControl, kPurgeReceived, kPurgeSent}) {
    usb_->control(step);
  }
  if (config_.event_character) {
    usb_->control(kEventAtEnd);
  }
}

bool FalconLink::answers() {
  constexpr int kTries = 25;
  for (int i = 0; i < kTries; ++i) {
    throw_if_stopped();
    const LinkStatus status =
        exchange({.motor = {}, .leds = kFalconRed, .homing = true});
    if (status == LinkStatus::kOk) {
      return true;
    }
    if (status == LinkStatus::kLost) {
      throw DeviceError("falcon: unplugged while it was set up");
    }
  }
  return false;
}

void FalconLink::start() {
  run_line();
  if (answers()) {
    return;  // an image runs already
  }
  if (config_.firmware.empty()) {
    throw DeviceError(
        "falcon: no firmware runs in it; name the vendor's image with "
        "--firmware FILE");
  }
  std::string last;
  for (int i = 0; i < kLoads; ++i) {
    try {
      boot_and_load();
      run_line();
      if (answers()) {
        return;
      }
      last = "the image was loaded but does not answer; is it a Falcon's?";
    } catch (const DeviceError& error) {
      if (usb_->lost()) {
        throw;
      }
      last = error.what();
    }
  }
  throw DeviceError(
      fmt::format("falcon: firmware not loaded in {} tries: {}", kLoads, last));
}

void FalconLink::boot_and_load() {
  for (const UsbRequest& step :
       {kPurgeReceived, kPurgeSent, kSlowTimer, kBootRate, kEightBits, kNoFlowControl,
        kRtsLow, kDtrLow, kDtrHigh}) {
    usb_->control(step);
  }
  ask_boot_loader();
  usb_->control(kDtrLow);
  usb_->control(kLoadRate);
  load();
}

void FalconLink::ask_boot_loader() {
  for (int i = 0; i < kQuestions; ++i) {
    throw_if_stopped();
    usb_->drop_received();
    if (usb_->send(kQuestion, deadline_ns_after(0.1)) == UsbStatus::kLost) {
      throw DeviceError("falcon: unplugged while it was booted");
    }
    std::array<std::uint8_t, 5> heard{};
    const std::size_t count = listen({heard.data(), 4}, 0.05);
    const bool padded = count > 0 && heard[0] == 0;
    const std::size_t whole =
        padded ? count + listen({heard.data() + count, 1}, 0.05) : count;
    if (std::equal(heard.begin() + (padded ? 1 : 0),
                   heard.begin() + static_cast<std::ptrdiff_t>(whole), kAnswer.begin(),
                   kAnswer.end())) {
      return;
    }
  }
  throw DeviceError(
      fmt::format("falcon: its boot loader does not answer ({} tries)", kQuestions));
}

void FalconLink::load() {
  std::array<std::uint8_t, kChunk> echo{};
  const auto send = [&](std::span<const std::uint8_t> chunk, const std::string& where) {
    throw_if_stopped();
    usb_->drop_received();
    const UsbStatus status = usb_->send(chunk, deadline_ns_after(0.1));
    const std::size_t count =
        status == UsbStatus::kOk ? listen({echo.data(), chunk.size()}, 0.2) : 0;
    if (count != chunk.size() ||
        !std::equal(chunk.begin(), chunk.end(), echo.begin())) {
      throw DeviceError(fmt::format("falcon: wrong echo of {}", where));
    }
  };
  send({&kLoadMark, 1}, "the load command");
  const std::span<const std::uint8_t> image(config_.firmware);
  for (std::size_t at = 0; at < image.size(); at += kChunk) {
    send(image.subspan(at, std::min(kChunk, image.size() - at)),
         fmt::format("the firmware's bytes from {}", at));
  }
}

void FalconLink::home() {
  bool announced = false;
  const std::int64_t until_ns = deadline_ns_after(config_.homing_s);
  while (reply_.homed != kFalconAllHomed) {
    throw_if_stopped();
    if (!announced && config_.tell) {
      config_.tell(
          "falcon: pull the grip all the way out and push it in, until the "
          "light is green");
    }
    announced = true;
    MonotonicClock clock;
    const LinkStatus status =
        exchange({.motor = {}, .leds = kFalconRed, .homing = true});
    if (status == LinkStatus::kLost) {
      throw DeviceError(fmt::format("falcon: {}", failure_));
    }
    if (clock.now_ns() > until_ns) {
      throw DeviceError(fmt::format(
          "falcon: not homed within {} s (legs {:03b} of 111): no force before that",
          config_.homing_s, reply_.homed));
    }
  }
}

}  // namespace palpate
