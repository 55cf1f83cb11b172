// A needle on the device of the paper's Table 1: it comes to rest after the drop.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "runtime/bench/axis_device.h"
#include "runtime/bench/bench_table1.h"
#include "tests/support/energy_account.h"
#include "tests/support/layered_body.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

constexpr double kTable1NPerM = 187.0;  // largest stable stiffness of Table 1's device
constexpr int kParts = 10;              // of a tick: the hand's force is no sampled one
constexpr double kHandNPerM = 30.0;
constexpr double kInM = 0.02;  // [m/s]

struct RestCase {
  double surface_n_per_m = kTable1NPerM;  // slope where the skin breaks
  double shaft_n_per_m = 20.0;
  double resolution_m = 0.0;
};

BenchBodyOptions surface_of(double slope_n_per_m) {
  BenchBodyOptions options = layered_options();
  // f = a e^1.5: its slope is 1.5 f / e.
  const double skin_m = 1.5 * kSkinN / slope_n_per_m;
  options.depth_m = 1.5 * skin_m;
  options.force_n = kSkinN * std::pow(1.5, 1.5);
  return options;
}

// A hand's spring moves the device into the body until the skin breaks, and stays then.
class HeldNeedle {
 public:
  explicit HeldNeedle(const RestCase& c)
      : case_(c), body_(punctured_body(surface_of(c.surface_n_per_m))) {
    PunctureRules rules = layered_rules();
    rules.shaft_n_per_m = c.shaft_n_per_m;
    state_ = needle_state(rules);
    device_.set_position_m(hand_m_);
  }

  // The hand damps the device while it settles, as in Table 1.
  void insert() {
    while (state_->needle.channels == 0 && hand_m_ < 0.3) {
      tick(kInM);
    }
    broke_n = force_n_;
    run(2.0);
    const double at_m = device_.position_m();
    device_ = VirtualDevice({}, kTickS / kParts);
    device_.set_position_m(at_m);
    device_.kick(Table1Options{}.kick_m_per_s);
  }

  // Range of the device's movement in that time [m].
  double run(double seconds) {
    double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
    for (long n = std::lround(seconds / kTickS); n > 0; --n) {
      tick(0.0);
      low_m = std::min(low_m, device_.position_m());
      high_m = std::max(high_m, device_.position_m());
    }
    return high_m - low_m;
  }

  // Of tip and shaft together, where the device is [N/m].
  [[nodiscard]] double stiffness_n_per_m() const {
    const Channel& channel = state_->needle.channel[0];
    const double e_m = channel.tip_m(state_->latest.position_m) - channel.depth_m;
    const double skin_m = 1.5 * kSkinN / case_.surface_n_per_m;
    const double tip = case_.surface_n_per_m * std::sqrt(std::max(0.0, e_m) / skin_m);
    return tip + case_.shaft_n_per_m;
  }

  [[nodiscard]] const FastState& state() const { return *state_; }

  double broke_n = 0.0;
  double open_j = 0.0;
  double lowest_j = 0.0;

 private:
  void tick(double hand_m_per_s) {
    const double r = case_.resolution_m, x = device_.position_m();
    const double measured_m = r > 0.0 ? r * std::round(x / r) : x;
    const Eigen::Vector3d at(0.0213, 0.0187, kNeedleRadiusM - measured_m);
    send(*state_, body_, at);
    force_n_ = step(*state_, {at, 0}, kTickS).force_n.z();
    open_j = std::max(open_j, std::abs(imbalance_j(state_->ledger)));
    lowest_j = std::min(lowest_j, state_->ledger.work_j);
    for (int part = 0; part < kParts; ++part) {
      hand_m_ += hand_m_per_s * kTickS / kParts;
      device_.step(kHandNPerM * (hand_m_ - device_.position_m()) - force_n_);
    }
  }

  RestCase case_;
  BenchBody body_;
  std::unique_ptr<FastState> state_;
  VirtualDevice device_{{.damping_n_s_per_m = Table1Options{}.hand_n_s_per_m},
                        kTickS / kParts};
  double hand_m_ = -0.001;
  double force_n_ = 0.0;
};

void expect_passive(const HeldNeedle& needle) {
  EXPECT_EQ(needle.state().safety.fault, Fault::kNone);
  EXPECT_LT(needle.open_j, 1e-12);
  EXPECT_EQ(needle.lowest_j, 0.0);
}

// The bound is the device's, not the needle's: that of a wall.
TEST(NeedleRest, TheBoundIsThatOfTable1) {
  const double wall =
      largest_stable_stiffness({}, LocalModel::kPotential, Table1Options{}.fast_hz);
  EXPECT_NEAR(wall, kTable1NPerM, 0.01 * kTable1NPerM);
}

TEST(NeedleRest, NoLimitCycleAfterTheDrop) {
  for (const double resolution_m : {0.0, 1e-5}) {
    HeldNeedle needle({.resolution_m = resolution_m});
    needle.insert();
    EXPECT_LT(needle.broke_n, 0.5 * kSkinN) << "the drop";
    const double early_m = needle.run(0.5);
    EXPECT_GT(early_m, 0.01);
    (void)needle.run(40.0);
    // Its load takes half of the movement every 4 s. A measured position that is one of
    // two neighbours is at rest.
    EXPECT_LT(needle.run(0.5), std::max(early_m / 1024.0, 2.0 * resolution_m));
    EXPECT_EQ(needle.state().needle.active, 0);
    expect_passive(needle);
  }
}

// What a device must bear is the tip's stiffness and the shaft's together. Beyond the
// bound the needle does not rest, and creates no energy all the same.
TEST(NeedleRest, TheDeviceBearsTipAndShaftTogether) {
  for (const RestCase& c : {RestCase{kTable1NPerM, 20.0}, RestCase{kTable1NPerM, 60.0},
                            RestCase{kTable1NPerM, 130.0},
                            RestCase{kTable1NPerM, 400.0}, RestCase{800.0, 20.0}}) {
    HeldNeedle needle(c);
    needle.insert();
    const double stiffness_n_per_m = needle.stiffness_n_per_m();
    (void)needle.run(10.0);
    const double middle_m = needle.run(0.5);
    (void)needle.run(20.0);
    const double last_m = needle.run(0.5);
    const bool rests = stiffness_n_per_m < kTable1NPerM;
    EXPECT_EQ(last_m < 0.5 * middle_m, rests) << stiffness_n_per_m << " N/m";
    EXPECT_EQ(last_m < 0.001, rests) << stiffness_n_per_m << " N/m";
    expect_passive(needle);
  }
}

}  // namespace
}  // namespace palpate
