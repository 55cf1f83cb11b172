// A haptic device and the hand that holds it, in simulation: dynamics in three
// dimensions with the imperfections that decide about stability.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "runtime/device/device.h"
#include "runtime/hand/hand_script.h"
#include "runtime/hand/turn_script.h"
#include "runtime/realtime/clock.h"

namespace palpate {

/// Largest number of writes that a command can be late.
constexpr std::size_t kDelayTicksMax = 16;

struct SimulatedDeviceConfig {
  double mass_kg = 0.12;           ///< [kg] (0, inf) felt at the tool
  double damping_n_s_per_m = 0.5;  ///< [N s/m] [0, inf)
  double coulomb_n = 0.03;         ///< [N] [0, inf) dry friction of the mechanism
  double load_n_per_m = 0.0;       ///< [N/m] [0, inf) spring of a Maxwell load ...
  double load_n_s_per_m = 1.8;     ///< [N s/m] (0, inf) ... in series with its dashpot
  double resolution_m = 1e-5;      ///< [m] [0, inf) step of the measured position
  int delay_ticks = 0;             ///< [0, kDelayTicksMax] writes until a force acts
  double hand_n_per_m = 300.0;     ///< [N/m] [0, inf) grip; 0: nobody holds the tool
  double hand_n_s_per_m = 3.0;     ///< [N s/m] [0, inf)
  double force_max_n = 8.0;        ///< [N] (0, inf) of the motors
  double tick_s = 5e-4;            ///< [s] (0, inf) between writes, for limits() alone
};

/// @throws InputError naming the value that is out of range.
void check(const SimulatedDeviceConfig& config);

/// What the tool really does, before it is measured.
struct SimulatedMotion {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d load_stretch_m = Eigen::Vector3d::Zero();  ///< of the load's spring
};

/// Mass, viscous damping, dry friction, a Maxwell load and a hand whose spring and
/// damper pull towards a script:
///
///   m x'' = F - b x' - k_l s - friction + k_h (h - x) + b_h (h' - x'),   s' = x' - s
///   k_l/c_l
///
/// In steps of kStepS the linear part is solved exactly (matrix exponential) under
/// forces held constant. Dry friction is the constant force of at most coulomb_n that
/// stops the tool within the step, so the tool sticks without creep. The clock drives
/// the device. Each call first advances to now, so simulated and real time run the same
/// code, and simulated time gives the same bits every time.
class SimulatedDevice : public Device {
 public:
  static constexpr std::int64_t kStepNs = 50'000;

  /// Starts at `start`, at rest in the script's time 0 when open() is called.
  /// @throws InputError as check() does.
  SimulatedDevice(const SimulatedDeviceConfig& config, const HandScript& script,
                  Clock& clock, const SimulatedMotion& start);

  /// Held by a hand that somebody else moves and turns, whatever the torque is: `hand`
  /// is read at every step and must outlive the device.
  SimulatedDevice(const SimulatedDeviceConfig& config, const HandTarget& hand,
                  Clock& clock, const SimulatedMotion& start);

  /// From open() on the hand's wrist turns the tool so, whatever the torque is.
  void turn_by(const TurnScript& wrist) { wrist_ = wrist; }
  [[nodiscard]] bool measures_turns() const override {
    return wrist_.has_value() || hand_ != nullptr;
  }

  [[nodiscard]] std::string name() const override { return "simulated"; }
  [[nodiscard]] DeviceLimits limits() const override;
  void open() override;
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override;
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override;
  void close() noexcept override;

  [[nodiscard]] const SimulatedMotion& motion() const noexcept { return motion_; }

  /// Force that acts on the tool now [N].
  [[nodiscard]] const Eigen::Vector3d& acting_force_n() const noexcept {
    return acting_n_;
  }

  /// Work of the rendered force on the tool since open() [J]: sum of F . dx, exact as F
  /// is constant in a step. Negative: the tool has put energy into what is rendered.
  [[nodiscard]] double rendered_work_j() const noexcept { return rendered_work_j_; }

  /// Length of the tool's way since open() [m], and the integral of its squared speed
  /// over time [m^2/s]. Times the viscous damping, that integral is what the damping
  /// has absorbed [J].
  [[nodiscard]] double path_m() const noexcept { return path_m_; }
  [[nodiscard]] double squared_speed_m2_per_s() const noexcept {
    return squared_speed_m2_per_s_;
  }

 private:
  void advance() noexcept;
  void step() noexcept;

  SimulatedDeviceConfig config_;
  HandScript script_;
  const HandTarget* hand_ = nullptr;  // instead of the script
  std::optional<TurnScript> wrist_;
  Clock& clock_;
  // (x, v, s) of one axis after a step: transition_ (x, v, s) + response_ * force.
  Eigen::Matrix3d transition_;
  Eigen::Vector3d response_;
  SimulatedMotion motion_;
  Eigen::Vector3d acting_n_ = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, kDelayTicksMax + 1> queue_;  // commands, by write number
  std::size_t writes_ = 0;
  std::int64_t opened_ns_ = 0;
  std::int64_t steps_ = 0;
  double rendered_work_j_ = 0.0;
  double path_m_ = 0.0;
  double squared_speed_m2_per_s_ = 0.0;
};

}  // namespace palpate
