#include "runtime/fast/fast_step.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bench_body.h"

namespace palpate {
namespace {

constexpr double kTickS = 0.0005;

FastState element_state(double radius_m = 0.005) {
  FastState state;
  state.config.tool_radius_m = radius_m;
  state.config.force_max_n = 1e6;
  state.config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return state;
}

void send(FastState& state, const BenchBody& body, const Eigen::Vector3d& x) {
  for (const Element& element : body.around(x)) {
    accept(state, element);
  }
}

// The account kept by the test alone, from the potential before each step.
struct Account {
  double net_j = 0.0;
  double lowest_j = 0.0;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  bool begun = false;

  FastCommand step(FastState& state, const Eigen::Vector3d& to, double dt_s = kTickS) {
    if (begun) {
      net_j += potential_j(state, to) - potential_j(state, x);
    }
    begun = true;
    x = to;
    lowest_j = std::min(lowest_j, net_j);
    return palpate::step(state, {to, 0}, dt_s);
  }
};

struct WalkOptions {
  int ticks = 100000;
  double lost_messages = 0.0;  // chance that the slow process skips its turn
  double depth_m = 0.008;
  double speed_m_per_s = 0.05;
  unsigned seed = 1;
};

struct WalkResult {
  double lowest_net_j = 0.0;
  double force_max_n = 0.0;
  double tank_min_j = 0.0;
  double shift_max_m = 0.0;
  int contacts = 0;
  int starved = 0;
  int elements = 0;
};

// A velocity that wanders (first-order noise), reflected at the walk's box.
WalkResult walk(const BenchBody& body, FastState& state, const WalkOptions& o) {
  std::mt19937_64 random(o.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const double r = state.config.tool_radius_m;
  Eigen::Vector3d x(0.5 * body.side_m(), 0.5 * body.side_m(), r + 0.003);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Account account;
  WalkResult result;
  std::int32_t last = -1;
  for (int tick = 0; tick < o.ticks; ++tick) {
    if (tick % 20 == 0 && uniform(random) >= o.lost_messages) {
      send(state, body, x);
    }
    for (int i = 0; i < 3; ++i) {
      v(i) += -v(i) * kTickS / 0.1 +
              o.speed_m_per_s * std::sqrt(2.0 * kTickS / 0.1) * normal(random);
      const double low = i < 2 ? 0.2 * body.side_m() : r - o.depth_m;
      const double high = i < 2 ? 0.8 * body.side_m() : r + 0.002;
      x(i) += v(i) * kTickS;
      if (x(i) < low || x(i) > high) {
        x(i) = std::clamp(x(i), low, high);
        v(i) = -v(i);
      }
    }
    const FastCommand command = account.step(state, x);
    result.force_max_n = std::max(result.force_max_n, command.force_n.norm());
    result.tank_min_j = std::min(result.tank_min_j, command.tank_j);
    result.shift_max_m = std::max(result.shift_max_m, command.relaxed_shift_m);
    result.contacts += command.in_contact ? 1 : 0;
    result.starved += command.starved ? 1 : 0;
    const std::int32_t now = contact(state).triangle;
    result.elements += now != last ? 1 : 0;
    last = now;
  }
  result.lowest_net_j = account.lowest_j;
  return result;
}

TEST(FastStep, RandomWalkOverRandomBodyCreatesNoEnergy) {
  BenchBodyOptions options;
  options.wave_m = 0.004;
  options.contrast = 9.0;
  options.tilt_rad = 0.2;
  options.friction_max = 1.0;
  options.touch_offset_m = 3e-4;
  const BenchBody body = make_bench_body(options);
  FastState state = element_state();
  const WalkResult r = walk(body, state, {.ticks = 1000000, .lost_messages = 0.3});
  std::printf(
      "contacts %d starved %d elements %d fmax %g shift %g imb %g low %g created %g "
      "work %g diss %g\n",
      r.contacts, r.starved, r.elements, r.force_max_n, r.shift_max_m,
      imbalance_j(state.ledger), r.lowest_net_j, state.ledger.created_j,
      state.ledger.work_j, state.ledger.dissipated_j);
  EXPECT_EQ(state.safety.fault, Fault::kNone);
  EXPECT_GE(r.lowest_net_j, -1e-12);
  EXPECT_GE(r.tank_min_j, 0.0);
  EXPECT_LT(r.force_max_n, 50.0);
  EXPECT_NEAR(imbalance_j(state.ledger), 0.0, 1e-11);
  EXPECT_GT(r.contacts, 300000);
  EXPECT_GT(r.elements, 1000);
}

}  // namespace
}  // namespace palpate
