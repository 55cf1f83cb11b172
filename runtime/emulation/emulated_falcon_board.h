// A Novint Falcon behind its serial line in simulation: boot loader, firmware, legs,
// motors, and the hand that holds it. Time is passed in.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "runtime/emulation/emulated_ftdi_chip.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/usb/falcon_packet.h"

namespace palpate {

/// The image that an emulated Falcon takes for its firmware. The real one is the
/// vendor's and is not distributed.
constexpr std::string_view kEmulatedFirmware =
    "palpate: firmware of an emulated Falcon, of more than one chunk of 62 bytes, so "
    "that loading it has a middle";

inline constexpr UsbIdentity kFalconIdentity{
    .vendor = 0x0403, .product = 0xCB48, .interface = 0, .out = 0x02, .in = 0x81};

/// What is wrong with a run of replies.
enum class ReplyFault : std::uint8_t {
  kMissing,  ///< there is none
  kGarbage,  ///< random bytes
  kStale,    ///< the first of all
  kJump,     ///< legs where they cannot be
};

struct WrongReplies {
  ReplyFault fault = ReplyFault::kMissing;
  std::int64_t from = 0;   ///< number of the command, from 1
  std::int64_t count = 0;  ///< so many in a row
};

struct FalconModelConfig {
  SimulatedDeviceConfig dynamics{};
  HandScript hand{};                        ///< in the device's frame
  Eigen::Vector3d start_m{0.0, 0.0, 0.12};  ///< [m]
  double motor_gain = 1.0;                  ///< [-] > 0 true force per nominal
  std::int64_t homing_ns = 20'000'000;      ///< from the first homing bit; -1: never
  std::array<std::int16_t, 3> offset{40, -25, 60};  ///< [counts] before homing
  bool loaded = false;              ///< the firmware runs from the start
  std::int64_t echo_error_at = -1;  ///< byte of the image echoed wrongly
  int echo_errors = 1;              ///< loads in which it is
  bool zero_before_answer = true;   ///< a 00 before the boot loader's answer
  int stale_every = 0;              ///< every nth reply is the one before
  WrongReplies wrong{};
  std::size_t trace_max = 0;  ///< commands of the firmware that trace() keeps
};

/// The motors' account at a command.
struct MotorRecord {
  std::int64_t time_ns = 0;
  double force_n = 0.0;  ///< [N] length of the force, from now on
  double work_j = 0.0;   ///< [J] on the tool, and the rest as SimulatedDevice's
  double path_m = 0.0;
  double squared_speed_m2_per_s = 0.0;
};

/// Of a tool that now has its command.
[[nodiscard]] inline MotorRecord motor_record(const SimulatedDevice& tool,
                                              std::int64_t now_ns) {
  return {.time_ns = now_ns,
          .force_n = tool.acting_force_n().norm(),
          .work_j = tool.rendered_work_j(),
          .path_m = tool.path_m(),
          .squared_speed_m2_per_s = tool.squared_speed_m2_per_s()};
}

/// A clock that stands where it is put.
class SetClock : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }
  void sleep_until_ns(std::int64_t /*deadline_ns*/) noexcept override {}
  void set(std::int64_t now_ns) noexcept {
    now_ns_ = now_ns > now_ns_ ? now_ns : now_ns_;
  }

 private:
  std::int64_t now_ns_ = 0;
};

class FalconModel : public SerialEnd {
 public:
  explicit FalconModel(const FalconModelConfig& config);

  void set_dtr(bool high) override;
  void take(std::uint8_t byte, std::uint16_t divisor, std::int64_t now_ns,
            std::vector<std::uint8_t>& answer) override;

  [[nodiscard]] const FalconCommand& command() const noexcept { return command_; }
  [[nodiscard]] bool running() const noexcept { return running_; }
  [[nodiscard]] bool homed() const noexcept { return homed_; }
  [[nodiscard]] std::int64_t commands() const noexcept { return commands_; }
  /// A motor was driven before the zero of the encoders was known.
  [[nodiscard]] bool driven_unhomed() const noexcept { return driven_unhomed_; }
  [[nodiscard]] const SimulatedDevice& tool() const noexcept { return tool_; }
  [[nodiscard]] const std::vector<MotorRecord>& trace() const noexcept {
    return trace_;
  }

 private:
  void boot(std::uint8_t byte, std::vector<std::uint8_t>& answer);
  void load(std::uint8_t byte, std::vector<std::uint8_t>& answer);
  [[nodiscard]] FalconReply obey(const FalconCommand& command, std::int64_t now_ns);
  [[nodiscard]] FalconPacket spoilt(FalconPacket reply);
  void keep(double force_n, std::int64_t now_ns);

  FalconModelConfig config_;
  SetClock clock_;
  SimulatedDevice tool_;
  FalconFramer framer_;
  FalconCommand command_;
  FalconReply last_;
  std::vector<std::uint8_t> image_;
  std::vector<std::uint8_t> heard_;  // by the boot loader
  bool dtr_ = true;
  bool running_ = false;
  bool loading_ = false;
  bool opened_ = false;
  bool homed_ = false;
  bool driven_unhomed_ = false;
  std::int64_t homing_since_ns_ = -1;
  std::int64_t commands_ = 0;
  std::vector<MotorRecord> trace_;
  FalconPacket first_{};  // reply
  std::mt19937 random_{2};
};

}  // namespace palpate
