#include "runtime/run/render_run.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

ResponseDatabase body(double stiffness_n_per_m) {
  return sample_database(
      sphere_surface(0.04, 3), ball(0.005, 0.3, 5e-4),
      [=](Eigen::Index, double d) {
        return stiffness_n_per_m * d * (0.5 + 50.0 * d);
      },
      0.005);
}

SimulationOptions options(LocalModel model) {
  SimulationOptions o;
  o.model = model;
  o.duration_s = 4.0;  // one round of the hand
  return o;
}

std::string refusal(const ResponseDatabase& database, const SimulationOptions& o) {
  const std::atomic<bool> stop = false;
  try {
    (void)simulate(database, o, stop);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Simulation, PressesToThePlannedDepthWithEveryPassiveModel) {
  const ResponseDatabase database = body(100.0);
  const std::atomic<bool> stop = false;
  for (const LocalModel model : {LocalModel::kElement, LocalModel::kEnergyTank}) {
    const SimulationReport report = simulate(database, options(model), stop);
    const RenderReport& r = report.render;
    EXPECT_EQ(r.fault, Fault::kNone) << name(model);
    EXPECT_EQ(r.ticks, 8000);
    EXPECT_GT(r.contact_ticks, 3000) << name(model);
    EXPECT_NEAR(r.depth_max_m, 0.003, 3e-4) << name(model);  // 0.6 of 5 mm
    EXPECT_NEAR(r.force_max_n, 100.0 * 0.003 * 0.65, 0.05) << name(model);
    EXPECT_GE(r.model_work_j, -1e-15) << name(model);  // rounding of sums of mJ
    EXPECT_EQ(r.elements_dropped, 0U);
    EXPECT_EQ(r.missed_deadlines, 0);
    EXPECT_EQ(report.force_scale, 1.0);
  }
}

TEST(Simulation, RefusesWhatTheDeviceCannotRenderAndScalesItOnRequest) {
  const ResponseDatabase database = body(2000.0);
  SimulationOptions o = options(LocalModel::kElement);
  o.device.damping_n_s_per_m = 0.1;  // 400 N/m at 2 kHz
  EXPECT_NE(refusal(database, o).find("exceeds 400 N/m, what a damping of 0.1"),
            std::string::npos)
      << refusal(database, o);
  EXPECT_NE(refusal(database, o).find("--limit-stiffness scales forces by 0."),
            std::string::npos);
  o.limit_stiffness = true;
  const std::atomic<bool> stop = false;
  const SimulationReport report = simulate(database, o, stop);
  EXPECT_NEAR(report.force_scale * report.stiffness.largest_n_per_m(), 400.0, 1e-9);
  EXPECT_EQ(report.render.fault, Fault::kNone);
  EXPECT_NE(summary(report).find("forces scaled by"), std::string::npos);
  EXPECT_NE(summary(report).find("Diolaiti"), std::string::npos);
}

TEST(Simulation, HoldsForcesForTheSlowPeriodWhereTheModelDoes) {
  EXPECT_EQ(hold_s(LocalModel::kSingle, 2000.0, 100.0, 0.0), 0.01);
  EXPECT_EQ(hold_s(LocalModel::kFirstOrderHold, 2000.0, 100.0, 0.0), 0.01);
  EXPECT_EQ(hold_s(LocalModel::kEqualEnergy, 2000.0, 100.0, 0.0), 0.0005);
  EXPECT_EQ(hold_s(LocalModel::kElement, 2000.0, 100.0, 0.0), 0.0005);
  // Whatever rate the fast process is told, a wire holds a force as long as it does.
  EXPECT_EQ(hold_s(LocalModel::kElement, 20000.0, 100.0, 0.001), 0.001);
  EXPECT_EQ(hold_s(LocalModel::kElement, 500.0, 100.0, 0.001), 0.002);
}

TEST(Simulation, RefusesOptionsThatCannotBe) {
  const ResponseDatabase database = body(100.0);
  SimulationOptions o = options(LocalModel::kElement);
  o.duration_s = -1.0;
  EXPECT_EQ(refusal(database, o), "duration [s] is -1, must be positive and finite");
  o = options(LocalModel::kElement);
  o.tool = "needle";
  EXPECT_NE(refusal(database, o).find("needle"), std::string::npos);
  o = options(LocalModel::kElement);
  o.force_max_n = std::nan("");
  EXPECT_NE(refusal(database, o).find("largest force is nan N"), std::string::npos);
}

TEST(Simulation, EndsAtOnceWhenItIsStopped) {
  const std::atomic<bool> stop = true;
  const SimulationReport report =
      simulate(body(100.0), options(LocalModel::kElement), stop);
  EXPECT_TRUE(report.render.interrupted);
  EXPECT_EQ(report.render.ticks, 0);
}

}  // namespace
}  // namespace palpate
