// Whether a device's motors push the way they are asked to, found with little force.
//
// A unit that is wired or mirrored otherwise has positive feedback: contact draws the
// tool in. The account sees positions alone, and books that as work of the hand. The
// test pushes along each axis with F(t) = +-F sin(w t), one period of either sign, and
// adds up W = sum F . dx. A hand and a mechanism that only take energy make W > 0,
// whatever their mass, spring and damping. Motors that push the other way make W < 0. A
// constant force and a steady pull of the hand cancel over the two periods.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "runtime/device/device_link.h"
#include "runtime/realtime/clock.h"

namespace palpate {

struct SignTestOptions {
  double force_n = 0.3;          ///< [N] > 0
  double period_s = 0.4;         ///< [s] > 0
  int axes = 3;                  ///< [1, 3] the first of x, y, z that the device has
  int rounds = 3;                ///< >= 1, while the answer is not clear
  double clear_j = 1e-4;         ///< [J] > 0 |W| of an axis that says something
  double runaway_m = 0.02;       ///< [m] > 0 from where it began: stop
  double runaway_m_per_s = 0.5;  ///< [m/s] > 0, over 10 ms: stop
};

/// [J] W of each axis.
using SignWork = std::array<double, 3>;

/// The test exchange by exchange, for whoever carries them. Takes 2.4 s where it is
/// clear at once.
class SignTest {
 public:
  /// @param name of the device, for what is thrown.
  SignTest(std::string name, const SignTestOptions& options)
      : name_(std::move(name)), options_(options) {}

  /// What to hold from now on [N]; first zero.
  /// @param position_m [m] as the force of the call before began to act; none: that
  /// exchange was missed. @param sent_n [N] what was sent of that force.
  /// @throws DeviceError if an axis pushes the wrong way, or the tool ran away. Also if
  /// nothing could be felt: the tool is held fast or lies at a stop. The force is then
  /// to be zero.
  [[nodiscard]] Eigen::Vector3d next(const std::optional<Eigen::Vector3d>& position_m,
                                     const Eigen::Vector3d& sent_n,
                                     std::int64_t now_ns);

  /// Every axis pushes as it is asked to, and the force is zero.
  [[nodiscard]] bool passed() const noexcept { return axis_ == options_.axes; }
  [[nodiscard]] const SignWork& work_j() const noexcept { return work_j_; }

  /// Whether no force has moved anything yet.
  [[nodiscard]] bool felt_nothing() const noexcept {
    return std::abs(work_j_[0]) < options_.clear_j;
  }

 private:
  void watch(const Eigen::Vector3d& position_m, std::int64_t now_ns);
  void end_round();

  std::string name_;
  SignTestOptions options_;
  SignWork work_j_{};
  int axis_ = 0;
  int round_ = 0;
  bool pushes_ = false;        // a round has begun
  std::int64_t begin_ns_ = 0;  // of the round
  // The exchange before this one: where the tool was, and what has acted since.
  std::optional<Eigen::Vector3d> before_m_;
  Eigen::Vector3d acting_n_ = Eigen::Vector3d::Zero();
  bool watched_ = false;
  Eigen::Vector3d begin_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d mark_m_ = Eigen::Vector3d::Zero();
  std::int64_t mark_ns_ = 0;
};

/// Tests an open link; leaves it at zero force.
/// @param stopped ends it; may be empty. @param clock which goes on while the link
/// works.
/// @throws DeviceError as SignTest::next() does, and if the link was lost. @throws
/// Interrupted when stopped.
SignWork test_signs(DeviceLink& link, const SignTestOptions& options,
                    const std::function<bool()>& stopped, Clock& clock);

/// A link whose every open() ends with that test.
class SignTestedLink : public DeviceLink {
 public:
  /// @param tell says what the person is to do; may be empty.
  SignTestedLink(std::unique_ptr<DeviceLink> link, const SignTestOptions& options,
                 std::function<void(const std::string&)> tell,
                 std::function<bool()> stopped);

  [[nodiscard]] std::string name() const override { return link_->name(); }
  [[nodiscard]] DeviceLimits limits() const override { return link_->limits(); }
  void open() override;
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override {
    return link_->transact(force_n, position_m);
  }
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override {
    return link_->sent_n();
  }
  [[nodiscard]] bool measures_turns() const noexcept override {
    return link_->measures_turns();
  }
  [[nodiscard]] Eigen::Quaterniond turn() const noexcept override {
    return link_->turn();
  }
  void close() noexcept override { link_->close(); }
  [[nodiscard]] std::string failure() const override { return link_->failure(); }

 private:
  std::unique_ptr<DeviceLink> link_;
  SignTestOptions options_;
  std::function<void(const std::string&)> tell_;
  std::function<bool()> stopped_;
};

}  // namespace palpate
