#include "runtime/fast/potential_model.h"

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/support/energy_account.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

constexpr double kBallRadiusM = 0.005;

std::unique_ptr<FastState> potential_state(double radius_m = kBallRadiusM) {
  auto state = std::make_unique<FastState>();
  state->config.model = LocalModel::kPotential;
  state->config.tool_radius_m = radius_m;
  state->config.force_max_n = 1e9;
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return state;
}

// Small enough that the fast process holds all of it.
BenchBodyOptions small_body(double friction) {
  BenchBodyOptions options;
  options.cells = 2;
  options.cell_m = 0.008;
  options.wave_m = 0.006;
  options.wavelength_m = 0.03;
  options.contrast = 100.0;
  options.tilt_rad = 0.2;
  options.tilt_by_height_per_m = 30.0;
  options.friction_min = friction;
  options.friction_max = friction;
  options.touch_offset_m = 2e-4;
  return options;
}

void send_all(FastState& state, const BenchBody& body, const Eigen::Vector3d& x) {
  for (Element element : body.element) {
    element.active = element.triangle == body.triangle_at(x);
    accept(state, element);
  }
}

TEST(PotentialModel, FlatHomogeneousBodyRendersTheCurve) {
  const BenchBody body = make_bench_body({.exponent = 2.0});
  const auto state = potential_state(0.0);
  Eigen::Vector3d x(0.031, 0.0306, 0.001);
  for (int n = 0; n < 6000; ++n) {
    x += Eigen::Vector3d(1e-6, -5e-7, -1e-6);
    if (n % 20 == 0) {
      send(*state, body, x);
    }
    const FastCommand command = step(*state, {x, 0}, kTickS);
    const double wanted = body.element[0].node[0].curve().at(-x.z()).force_n;
    ASSERT_NEAR(command.force_n.z(), wanted, 1e-9) << n;
    ASSERT_NEAR(command.force_n.head<2>().norm(), 0.0, 1e-9) << n;
  }
}

TEST(PotentialModel, WithoutFrictionTheLedgerNeverIntervenes) {
  const BenchBody body = make_bench_body(small_body(0.0));
  const auto state = potential_state();
  Account account;
  int contacts = 0;
  int n = 0;
  double shift = 0.0;
  for (const Eigen::Vector3d& x : make_bench_walk(
           body, {.ticks = 100000, .speed_m_per_s = 0.1, .lift_m = 0.005})) {
    if (n++ % 20 == 0) {
      send_all(*state, body, x);
    }
    const FastCommand command = account.step(*state, x);
    contacts += command.in_contact ? 1 : 0;
    shift = std::max(shift, command.rest_offset_m);
  }
  EXPECT_EQ(state->safety.fault, Fault::kNone);
  EXPECT_EQ(state->ledger.interventions, 0U);
  EXPECT_EQ(shift, 0.0);
  // 1e5 additions of energies below 0.1 J.
  EXPECT_GE(account.lowest_j, -1e-12);
  EXPECT_GT(contacts, 30000);
}

// Random closed walks: the field gives back exactly what it took, friction less.
double closed_walk_j(double friction, std::uint32_t seed, double& trapezoid_j) {
  const BenchBody body = make_bench_body(small_body(friction));
  const auto state = potential_state();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Eigen::Vector3d start(0.008, 0.008, kBallRadiusM + 0.003);
  std::vector<Eigen::Vector3d> corner{start};
  for (int i = 0; i < 8; ++i) {
    corner.emplace_back(0.008 + 0.004 * unit(random), 0.008 + 0.004 * unit(random),
                        kBallRadiusM - 0.003 + 0.002 * unit(random));
  }
  corner.push_back(start);
  Account account;
  send_all(*state, body, start);
  Eigen::Vector3d last = start;
  Eigen::Vector3d force = account.step(*state, start).force_n;
  trapezoid_j = 0.0;
  for (std::size_t i = 1; i < corner.size(); ++i) {
    constexpr int kSteps = 4000;
    for (int s = 1; s <= kSteps; ++s) {
      const double t = static_cast<double>(s) / kSteps;
      const Eigen::Vector3d x = (1.0 - t) * corner[i - 1] + t * corner[i];
      const Eigen::Vector3d now = account.step(*state, x).force_n;
      trapezoid_j -= 0.5 * (force + now).dot(x - last);
      force = now;
      last = x;
    }
  }
  EXPECT_EQ(state->safety.fault, Fault::kNone);
  EXPECT_GE(account.lowest_j, -1e-12);
  return account.net_j;
}

TEST(PotentialModel, ClosedWalksWithoutFrictionCreateAndLoseNothing) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    double trapezoid_j = 0.0;
    // 36000 ticks, each with 1e-17 m of rounding under 10 N.
    EXPECT_NEAR(closed_walk_j(0.0, seed, trapezoid_j), 0.0, 1e-12) << seed;
    // The forces' own integral: steps of 2 um, forces that jump by less than 20 N where
    // an edge is crossed, about thirty times.
    EXPECT_NEAR(trapezoid_j, 0.0, 30 * 0.5 * 20.0 * 2e-6) << seed;
  }
}

TEST(PotentialModel, ClosedWalksWithFrictionDissipate) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    double trapezoid_j = 0.0;
    EXPECT_GT(closed_walk_j(1.0, seed, trapezoid_j), 1e-4) << seed;
    EXPECT_GT(trapezoid_j, 1e-4) << seed;
  }
}

TEST(PotentialModel, LateElementsCreateNoEnergy) {
  BenchBodyOptions options;
  options.wave_m = 0.004;
  options.contrast = 100.0;
  options.tilt_rad = 0.2;
  options.friction_max = 1.0;
  options.touch_offset_m = 3e-4;
  const BenchBody body = make_bench_body(options);
  const auto state = potential_state();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  Account account;
  int n = 0;
  int starved = 0;
  for (const Eigen::Vector3d& x : make_bench_walk(body, {.ticks = 300000})) {
    if (n++ % 20 == 0 && uniform(random) >= 0.5) {
      send(*state, body, x);
    }
    starved += account.step(*state, x).starved ? 1 : 0;
  }
  EXPECT_EQ(state->safety.fault, Fault::kNone);
  EXPECT_GE(account.lowest_j, -1e-11);
  EXPECT_NEAR(imbalance_j(state->ledger), 0.0, 1e-11);
  EXPECT_GT(starved, 100);
}

TEST(PotentialModel, SlidingFrictionIsCoulombs) {
  const BenchBody body = make_bench_body({.friction_min = 0.4, .friction_max = 0.4});
  const auto state = potential_state(0.0);
  Eigen::Vector3d x(0.031, 0.0306, 0.0005);
  FastCommand command;
  for (int n = 0; n < 9000; ++n) {
    (n < 4500 ? x.z() : x.x()) += n < 4500 ? -1e-6 : 1e-6;
    if (n % 20 == 0) {
      send(*state, body, x);
    }
    command = step(*state, {x, 0}, kTickS);
  }
  EXPECT_NEAR(command.force_n.x(), -0.4 * command.force_n.z(), 1e-9);
  EXPECT_GT(command.dissipated_j, 0.0);
}

// A trough of half-circle profile, radius 4 mm, along y.
BenchBody trough() {
  BenchBody body = make_bench_body({.cells = 4, .cell_m = 0.002});
  for (Element& element : body.element) {
    for (ElementNode& node : element.node) {
      const double angle = (node.position_m[0] - 0.004) / 0.004;
      node.position_m[0] = 0.004 + 0.004 * std::sin(angle);
      node.position_m[2] = 0.004 - 0.004 * std::cos(angle);
      node.normal = {-std::sin(angle), 0.0, std::cos(angle)};
      node.direction = node.normal;
    }
  }
  return body;
}

TEST(PotentialModel, ToolLargerThanTheTroughStaysPassiveAndFinite) {
  const BenchBody body = trough();
  const auto state = potential_state(0.006);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  Account account;
  Eigen::Vector3d x(0.004, 0.004, 0.012);
  int folded = 0;
  double force_max = 0.0;
  for (int n = 0; n < 50000; ++n) {
    const Eigen::Vector3d home(0.004, 0.004, 0.005);
    x += 2e-5 * Eigen::Vector3d(normal(random), normal(random), normal(random)) +
         1e-3 * (home - x);
    for (Element element : body.element) {
      element.active = element.triangle == body.triangle_at(x);
      if (n % 20 == 0 && (element.active || element.triangle % 2 == n / 20 % 2)) {
        accept(*state, element);
      }
    }
    const FastCommand command = account.step(*state, x);
    ASSERT_EQ(command.fault, 0) << n;
    force_max = std::max(force_max, command.force_n.norm());
    folded += state->potential.place.folded ? 1 : 0;
  }
  EXPECT_GT(folded, 500);
  EXPECT_GE(account.lowest_j, -1e-12);
  EXPECT_LT(force_max, 50.0);
}

TEST(PotentialModel, NeedlesAndSliversStayPassiveAndFinite) {
  for (const double width : {1e-4, 1e-6, 1e-9, 0.0}) {
    BenchBody body = make_bench_body(small_body(0.5));
    for (Element& element : body.element) {
      for (ElementNode& node : element.node) {
        // The middle column of nodes moves next to the last one.
        if (node.node % 3 == 1) {
          node.position_m[0] = 0.016 - width;
        }
      }
    }
    const auto state = potential_state();
    Account account;
    int n = 0;
    for (const Eigen::Vector3d& x : make_bench_walk(body, {.ticks = 20000})) {
      const Eigen::Vector3d over = x + Eigen::Vector3d(0.006, 0.0, 0.0);
      if (n++ % 20 == 0) {
        send_all(*state, body, over);
      }
      ASSERT_EQ(account.step(*state, over).fault, 0) << width << " " << n;
    }
    EXPECT_GE(account.lowest_j, -1e-12) << width;
  }
}

// A stiffer element than the account can pay for whole: the normal part is paid, the
// spring keeps what is left, no less.
TEST(PotentialModel, TheFrictionSpringKeepsWhatTheNormalPartLeaves) {
  constexpr double kStiffness = 250.0;  // [N/m]
  constexpr double kDepth = 2e-3;
  constexpr double kStretch = 4e-4;
  constexpr double kMu = 0.5;
  BenchBody body = make_bench_body({.exponent = 1.0,
                                    .force_n = kStiffness * 0.008,
                                    .friction_min = kMu,
                                    .friction_max = kMu});
  const auto state = potential_state(0.0);
  Eigen::Vector3d x(0.031, 0.0306, 0.0);
  send(*state, body, x);
  const auto go = [&](const Eigen::Vector3d& to) {
    x = to;
    return step(*state, {x, 0}, kTickS).force_n;
  };
  for (int n = -10; n <= 200; ++n) {
    (void)go({x.x(), x.y(), -kDepth * n / 200.0});
  }
  Eigen::Vector3d force;
  for (int n = 1; n <= 40; ++n) {
    force = go({0.031 + kStretch * n / 40.0, x.y(), -kDepth});
  }
  const double spring_n_per_m = kMu * kStiffness * kDepth / body.options.presliding_m;
  EXPECT_NEAR(force.x(), -spring_n_per_m * kStretch, 1e-3);
  const double normal_j = 0.5 * kStiffness * kDepth * kDepth;
  const double spring_j = 0.5 * spring_n_per_m * kStretch * kStretch;
  const double stiffer = 1.0 + 0.5 * spring_j / normal_j;
  for (Element& element : body.element) {
    for (ElementNode& node : element.node) {
      set_power_law(node, 1.0, stiffer * kStiffness * 0.008, 0.008);
    }
  }
  send(*state, body, x);
  force = go(x);
  EXPECT_NEAR(force.z(), stiffer * kStiffness * kDepth, 1e-6);
  EXPECT_NEAR(force.x(),
              -std::sqrt(2.0 * (0.5 * spring_j) * (stiffer * spring_n_per_m)), 2e-3);
}

// Where there are no coordinates the potential goes on along the normal that is held:
// deeper costs energy, shallower gives it back, by the curve.
TEST(PotentialModel, ContinuedPotentialFollowsTheCurve) {
  constexpr double kHeight = 0.03;
  constexpr double kStiffness = 100.0;  // [N/m]
  Element needle;                       // of no width, alone
  needle.triangle = 0;
  needle.active = true;
  for (std::size_t j = 0; j < 3; ++j) {
    ElementNode& node = needle.node[j];
    node.node = static_cast<std::int32_t>(j);
    node.position_m = {0.004 * (static_cast<double>(j) - 1.0), 0.0, kHeight};
    node.normal = {0.0, 0.0, 1.0};
    node.direction = {0.0, 0.0, 1.0};
    set_power_law(node, 1.0, kStiffness * 0.04, 0.04);
  }
  needle.neighbour = {-1, -1, -1};
  const auto state = potential_state(0.0);
  Eigen::Vector3d x(0.001, 0.0, kHeight + 1e-3);
  accept(*state, needle);
  FastCommand command;
  for (int n = 0; n <= 600; ++n) {
    x.z() = kHeight + 1e-3 - 1e-5 * n;
    command = step(*state, {x, 0}, kTickS);
  }
  ASSERT_TRUE(state->potential.place.folded);
  EXPECT_NEAR(command.force_n.z(), kStiffness * 0.005, 1e-9);
  EXPECT_NEAR(potential_j(*state, x), 0.5 * kStiffness * 0.005 * 0.005, 1e-12);
  for (const double deeper_m : {-4e-3, -1e-3, 1e-3, 4e-3}) {
    const Eigen::Vector3d there(x.x(), x.y(), x.z() - deeper_m);
    EXPECT_NEAR(potential_j(*state, there),
                0.5 * kStiffness * std::pow(0.005 + deeper_m, 2), 1e-12);
  }
}

TEST(PotentialModel, ZeroResponseGivesZeroForce) {
  BenchBody body = make_bench_body(small_body(0.3));
  for (Element& element : body.element) {
    for (ElementNode& node : element.node) {
      node.samples = 0;
      node.direction = {};
      node.normal = {};
    }
  }
  const auto state = potential_state();
  for (const Eigen::Vector3d& x : make_bench_walk(body, {.ticks = 2000})) {
    send_all(*state, body, x);
    const FastCommand command = step(*state, {x, 0}, kTickS);
    ASSERT_EQ(command.fault, 0);
    ASSERT_EQ(command.force_n.norm(), 0.0);
  }
}

TEST(PotentialModel, NanIsAFaultAndZeroForce) {
  const BenchBody body = make_bench_body(small_body(0.3));
  const auto state = potential_state();
  const Eigen::Vector3d x(0.008, 0.008, kBallRadiusM - 0.002);
  send_all(*state, body, x);
  (void)step(*state, {x, 0}, kTickS);
  const Eigen::Vector3d nan(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0);
  const FastCommand command = step(*state, {nan, 0}, kTickS);
  EXPECT_EQ(command.fault, static_cast<std::uint8_t>(Fault::kNotFinite));
  EXPECT_EQ(command.force_n.norm(), 0.0);
  EXPECT_TRUE(std::isfinite(state->ledger.work_j));
}

TEST(PotentialModel, TeleportsCreateNoEnergy) {
  const BenchBody body = make_bench_body(small_body(0.3));
  const auto state = potential_state();
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Account account;
  for (int n = 0; n < 20000; ++n) {
    const double far = n % 50 == 0 ? 1.0 : 0.006;
    const Eigen::Vector3d x(0.008 + far * unit(random), 0.008 + far * unit(random),
                            kBallRadiusM + far * unit(random));
    if (n % 10 == 0) {
      send_all(*state, body, x);
    }
    const FastCommand command = account.step(*state, x);
    ASSERT_EQ(command.fault, 0) << n;
    ASSERT_TRUE(command.force_n.allFinite()) << n;
  }
  EXPECT_GE(account.lowest_j, -1e-11);
}

TEST(PotentialModel, ToolThatStartsInsideFeelsNothingUntilItMoves) {
  const BenchBody body = make_bench_body(small_body(0.0));
  const auto state = potential_state();
  const Eigen::Vector3d x(0.008, 0.0079, kBallRadiusM - 0.003);
  send_all(*state, body, x);
  EXPECT_NEAR(step(*state, {x, 0}, kTickS).force_n.norm(), 0.0, 1e-6);
  const FastCommand deeper =
      step(*state, {x - Eigen::Vector3d(0.0, 0.0, 0.001), 0}, kTickS);
  EXPECT_GT(deeper.force_n.z(), 0.0);
}

}  // namespace
}  // namespace palpate
