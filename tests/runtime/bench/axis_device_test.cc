#include "runtime/bench/axis_device.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

TEST(VirtualDevice, FreeMassFollowsTheParabola) {
  VirtualDevice device({.mass_kg = 0.2, .load_n_per_m = 0.0}, kTickS);
  for (int n = 0; n < 2000; ++n) {
    device.step(0.1);
  }
  EXPECT_NEAR(device.position_m(), 0.5 * (0.1 / 0.2) * 1.0, 1e-12);
  EXPECT_NEAR(device.velocity_m_per_s(), 0.5, 1e-12);
}

TEST(VirtualDevice, DampedMassReachesItsTerminalVelocityAsTheExponential) {
  VirtualDevice device({.mass_kg = 0.1, .damping_n_s_per_m = 0.5, .load_n_per_m = 0.0},
                       kTickS);
  for (int n = 0; n < 400; ++n) {
    device.step(0.1);
  }
  EXPECT_NEAR(device.velocity_m_per_s(), 0.2 * (1.0 - std::exp(-0.2 * 0.5 / 0.1)),
              1e-12);
}

TEST(VirtualDevice, MaxwellLoadDragsLikeItsDashpotInTheEnd) {
  VirtualDevice device({}, kTickS);
  for (int n = 0; n < 20000; ++n) {
    device.step(0.18);
  }
  EXPECT_NEAR(device.velocity_m_per_s(), 0.18 / 1.8, 1e-9);
}

TEST(VirtualDevice, TwoHalfTicksAreOneTick) {
  VirtualDevice whole({}, kTickS);
  VirtualDevice halves({}, kTickS / 2.0);
  for (int n = 0; n < 100; ++n) {
    whole.step(std::sin(n));
    halves.step(std::sin(n));
    halves.step(std::sin(n));
  }
  EXPECT_NEAR(whole.position_m(), halves.position_m(), 1e-14);
}

TEST(VirtualDevice, RefusesWhatIsNoDevice) {
  EXPECT_THROW(VirtualDevice({.mass_kg = 0.0}, kTickS), InputError);
  EXPECT_THROW(VirtualDevice({.mass_kg = std::nan("")}, kTickS), InputError);
  EXPECT_THROW(VirtualDevice({.damping_n_s_per_m = -1.0}, kTickS), InputError);
  EXPECT_THROW(VirtualDevice({}, 0.0), InputError);
}

}  // namespace
}  // namespace palpate
