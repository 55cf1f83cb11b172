#include "runtime/hand/simulated_device.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// Nothing but a mass.
SimulatedDeviceConfig bare() {
  SimulatedDeviceConfig config;
  config.mass_kg = 0.1;
  config.damping_n_s_per_m = 0.0;
  config.coulomb_n = 0.0;
  config.resolution_m = 0.0;
  config.hand_n_per_m = 0.0;
  config.hand_n_s_per_m = 0.0;
  return config;
}

// A device at the origin that is stepped by hand.
class Rig {
 public:
  explicit Rig(const SimulatedDeviceConfig& config,
               const Eigen::Vector3d& velocity_m_per_s = Eigen::Vector3d::Zero())
      : device(config, HandScript{}, clock_, {.velocity_m_per_s = velocity_m_per_s}) {
    device.open();
  }

  void write(const Eigen::Vector3d& force_n) {
    EXPECT_EQ(device.write(force_n), DeviceStatus::kOk);
  }

  Eigen::Vector3d read_at(double time_s) {
    clock_.sleep_until_ns(std::llround(time_s * kNanosecondsPerSecond));
    DeviceReading reading;
    EXPECT_EQ(device.read(reading), DeviceStatus::kOk);
    return reading.position_m;
  }

 private:
  SimulatedClock clock_;

 public:
  SimulatedDevice device;
};

TEST(SimulatedDevice, CoastsToRestAsADampedMassDoes) {
  SimulatedDeviceConfig config = bare();
  config.damping_n_s_per_m = 0.5;
  const Eigen::Vector3d v0(0.3, -0.1, 0.2);
  Rig rig(config, v0);
  const double rate = config.damping_n_s_per_m / config.mass_kg;
  for (const double t : {0.001, 0.1, 0.5, 2.0}) {
    const double decay = std::exp(-rate * t);
    EXPECT_LT((rig.read_at(t) - v0 * (1.0 - decay) / rate).norm(), 1e-11);
    EXPECT_LT((rig.device.motion().velocity_m_per_s - v0 * decay).norm(), 1e-11);
  }
}

TEST(SimulatedDevice, FallsFreelyUnderAConstantForce) {
  Rig rig(bare());
  rig.write({0.02, 0.0, -0.05});
  const Eigen::Vector3d expected(0.02, 0.0, -0.05);
  EXPECT_LT((rig.read_at(0.4) - 0.5 * 0.16 / 0.1 * expected).norm(), 1e-12);
  EXPECT_NEAR(rig.device.rendered_work_j(),
              0.5 * 0.1 * rig.device.motion().velocity_m_per_s.squaredNorm(), 1e-12);
}

TEST(SimulatedDevice, CreepsUnderAForceAsItsMaxwellLoadRelaxes) {
  // Spring and dashpot in series hold a heavily damped tool: under a constant force F
  // the spring stretches to F / k_l and the tool ends up moving at F / (b + c_l).
  SimulatedDeviceConfig config = bare();
  config.load_n_per_m = 12.0;
  config.load_n_s_per_m = 1.8;
  Rig rig(config);
  rig.write({0.03, 0.0, 0.0});
  rig.read_at(20.0);
  EXPECT_NEAR(rig.device.motion().velocity_m_per_s.x(), 0.03 / 1.8, 1e-9);
  EXPECT_NEAR(rig.device.motion().load_stretch_m.x(), 0.03 / 12.0, 1e-9);
}

TEST(SimulatedDevice, RelaxesItsLoadExponentiallyWhenHeldStill) {
  // A very heavy tool stays where it is, the dashpot takes up the stretch: s0 exp(-k
  // t/c).
  SimulatedDeviceConfig config = bare();
  config.mass_kg = 1e9;
  config.load_n_per_m = 12.0;
  config.load_n_s_per_m = 1.8;
  SimulatedClock clock;
  SimulatedDevice device(config, HandScript{}, clock, {.load_stretch_m = {0.01, 0, 0}});
  device.open();
  clock.sleep_until_ns(100'000'000);
  DeviceReading reading;
  ASSERT_EQ(device.read(reading), DeviceStatus::kOk);
  EXPECT_NEAR(device.motion().load_stretch_m.x(), 0.01 * std::exp(-12.0 * 0.1 / 1.8),
              1e-12);
}

TEST(SimulatedDevice, SticksUnderLessThanItsFrictionAndDoesNotCreep) {
  SimulatedDeviceConfig config = bare();
  config.coulomb_n = 0.05;
  Rig rig(config);
  rig.write({0.03, 0.03, 0.02});  // 0.047 N
  EXPECT_LT(rig.read_at(10.0).norm(), 1e-15);
}

TEST(SimulatedDevice, SlidesUnderWhatFrictionLeavesOfTheForce) {
  SimulatedDeviceConfig config = bare();
  config.coulomb_n = 0.05;
  Rig rig(config);
  const Eigen::Vector3d along = Eigen::Vector3d(1.0, -2.0, 2.0) / 3.0;
  rig.write(0.15 * along);
  EXPECT_LT((rig.read_at(0.2) - 0.5 * 0.04 * (0.10 / 0.1) * along).norm(), 1e-12);
}

TEST(SimulatedDevice, IsBroughtToRestByFrictionAtTheRightPlace) {
  SimulatedDeviceConfig config = bare();
  config.coulomb_n = 0.05;  // decelerates by 0.5 m/s^2: 0.1 m/s stops after 10 mm
  Rig rig(config, {0.0, 0.1, 0.0});
  const double step = 0.1 * SimulatedDevice::kStepNs / kNanosecondsPerSecond;
  EXPECT_NEAR(rig.read_at(0.5).y(), 0.01, step);
  EXPECT_EQ(rig.device.motion().velocity_m_per_s.norm(), 0.0);
}

TEST(SimulatedDevice, MeasuresMultiplesOfItsResolution) {
  SimulatedDeviceConfig config = bare();
  config.resolution_m = 5e-5;
  Rig rig(config, {0.01, 0.02, -0.03});
  for (double t = 0.0; t < 0.1; t += 0.0007) {
    const Eigen::Vector3d measured = rig.read_at(t);
    const Eigen::Vector3d error = measured - rig.device.motion().position_m;
    EXPECT_LE(error.cwiseAbs().maxCoeff(), 2.5e-5 * (1.0 + 1e-9));
    for (const double x : measured) {
      EXPECT_NEAR(x / 5e-5, std::round(x / 5e-5), 1e-9);
    }
  }
}

TEST(SimulatedDevice, ActsOnACommandAsManyWritesLaterAsItsDelay) {
  for (const int delay : {0, 1, 3, static_cast<int>(kDelayTicksMax)}) {
    SimulatedDeviceConfig config = bare();
    config.delay_ticks = delay;
    Rig rig(config);
    for (int write = 0; write < 40; ++write) {
      rig.write({write + 1.0, 0.0, 0.0});
      const double expected = std::max(0, write + 1 - delay);
      EXPECT_EQ(rig.device.acting_force_n().x(), std::min(expected, 8.0));
    }
  }
}

TEST(SimulatedDevice, LimitsTheWholeVectorAndEndsWithZeroForce) {
  Rig rig(bare());
  rig.write({30.0, 40.0, 0.0});
  EXPECT_LT((rig.device.acting_force_n() - Eigen::Vector3d(4.8, 6.4, 0.0)).norm(),
            1e-12);
  rig.device.close();
  EXPECT_EQ(rig.device.acting_force_n().norm(), 0.0);
}

TEST(SimulatedDevice, FollowsTheHandToWhereItRests) {
  SimulatedDeviceConfig config;
  config.coulomb_n = 0.0;
  HandScript script;
  script.duration_s = 1e6;  // still at the start
  SimulatedClock clock;
  SimulatedDevice device(config, script, clock, {});
  device.open();
  clock.sleep_until_ns(3'000'000'000);
  DeviceReading reading;
  ASSERT_EQ(device.read(reading), DeviceStatus::kOk);
  EXPECT_LT((device.motion().position_m - script.at(0.0).position_m).norm(), 1e-9);
}

TEST(SimulatedDevice, RefusesAConfigurationThatCannotBe) {
  SimulatedDeviceConfig config;
  config.mass_kg = 0.0;
  EXPECT_THROW(check(config), InputError);
  config = {};
  config.damping_n_s_per_m = std::nan("");
  EXPECT_THROW(check(config), InputError);
  config = {};
  config.delay_ticks = 17;
  EXPECT_THROW(check(config), InputError);
}

}  // namespace
}  // namespace palpate
