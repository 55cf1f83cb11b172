// Bodies of random legal curves, pressed deep and dragged sideways by every passive
// model: whatever a database may say, nothing pulls and no energy comes from nowhere.
//
//   PALPATE_RANDOM_BODIES=100000 build/release/bin/tests/... tries more than the 40
//   here.
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "formats/database/response_database.h"
#include "runtime/fast/fast_step.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {
namespace {

constexpr double kTickS = 5e-4;
constexpr int kSide = 4;         // nodes of the plate along a side
constexpr double kStepM = 0.01;  // between them
constexpr int kTicks = 10'000;

int bodies() {
  const char* wanted = std::getenv("PALPATE_RANDOM_BODIES");
  return wanted == nullptr ? 40 : std::atoi(wanted);
}

class RandomBody {
 public:
  explicit RandomBody(unsigned seed) : random_(seed) {
    plate();
    for (Eigen::Index i = 0; i < body_.body.position_m.rows(); ++i) {
      response_.push_back(response());
    }
    const double friction = chance(0.5) ? 0.0 : uniform(0.0, 3.0);
    const ToolShape ball{"ball", "sphere", uniform(0.001, 0.01), friction, 5e-4};
    body_.tools = {make_table(ball, response_)};
    check(body_);
  }

  [[nodiscard]] const ResponseDatabase& database() const { return body_; }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool chance(double share) { return uniform(0.0, 1.0) < share; }
  double normal() { return std::normal_distribution<double>()(random_); }

 private:
  void plate() {
    body_.body.position_m.resize(kSide * kSide, 3);
    body_.body.triangle.resize(2 * (kSide - 1) * (kSide - 1), 3);
    const double wave_m = chance(0.5) ? 0.0 : 0.004;
    Eigen::Index t = 0;
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const int v = j * kSide + i;
        body_.body.position_m.row(v) << kStepM * i, kStepM * j,
            wave_m * uniform(-1.0, 1.0);
        if (i + 1 < kSide && j + 1 < kSide) {
          body_.body.triangle.row(t++) << v, v + 1, v + kSide + 1;
          body_.body.triangle.row(t++) << v, v + kSide + 1, v + kSide;
        }
      }
    }
    body_.normal = vertex_normals(body_.body);
  }

  // Rising, falling, flat, stiff at the start or at the end, and cut anywhere.
  NodeResponse response() {
    NodeResponse one;
    if (chance(0.1)) {
      return one;
    }
    one.origin = ResponseOrigin::kSimulated;
    one.direction = Eigen::Vector3d(uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1.0);
    one.direction.normalize();
    one.touch_offset_m = chance(0.5) ? 0.0 : uniform(-1e-3, 1e-3);
    const int samples = 2 + static_cast<int>(uniform(0.0, 12.0));
    const double stiffness = std::pow(10.0, uniform(-1.0, 4.0));
    const double falling = chance(0.5) ? uniform(0.0, 1.0) : 0.0;
    double depth = 0.0;
    double force = 0.0;
    for (int i = 0; i < samples; ++i) {
      one.depth_m.push_back(depth);
      one.force_n.push_back(force);
      const double step = std::pow(10.0, uniform(-5.0, -2.5));
      depth += step;
      force = chance(falling) ? force * uniform(0.0, 1.0)
                              : force + stiffness * step * std::exp(normal());
      force = chance(0.1) ? one.force_n.back() : force;
    }
    return one;
  }

  std::mt19937 random_;
  ResponseDatabase body_;
  std::vector<NodeResponse> response_;
};

// A tool that wanders 5 mm above to 15 mm below the plate, and leaps now and then.
class Wanderer {
 public:
  explicit Wanderer(RandomBody& body) : body_(body) {}

  const Eigen::Vector3d& next() {
    const Eigen::Vector3d push(body_.normal(), body_.normal(), body_.normal());
    velocity_ = 0.98 * velocity_ + 0.03 * push;
    x_ += kTickS * velocity_;
    if (body_.chance(1e-3)) {
      x_ += Eigen::Vector3d(body_.normal(), body_.normal(), body_.normal()) * 2e-3;
    }
    const Eigen::Vector3d low(-0.002, -0.002, -0.015);
    const Eigen::Vector3d high(0.032, 0.032, 0.01);
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (x_[k] < low[k] || x_[k] > high[k]) {
        velocity_[k] = std::copysign(velocity_[k], low[k] - x_[k] > 0.0 ? 1.0 : -1.0);
      }
    }
    x_ = x_.cwiseMax(low).cwiseMin(high);
    return x_;
  }

 private:
  RandomBody& body_;
  Eigen::Vector3d x_{0.015, 0.015, 0.009};
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
};

// The largest force of any sample: beyond the last one a curve goes on, but not down.
void walk(RandomBody& body, LocalModel model, unsigned seed) {
  const ResponseTable& table = body.database().tools[0];
  ElementStream stream(body.database(), table);
  auto state = std::make_unique<FastState>();
  state->config.model = model;
  state->config.tool_radius_m = table.tool.radius_m;
  // Clamps create energy, up to their floor; this is about the models.
  state->config.force_max_n = std::numeric_limits<double>::infinity();
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  auto fifo = std::make_unique<ElementFifo>();
  Wanderer wanderer(body);
  double lowest_work_j = 0.0;
  double lowest_stored_j = 0.0;
  double most_pull_n = 0.0;
  for (int n = 0; n < kTicks; ++n) {
    const Eigen::Vector3d& x = wanderer.next();
    if (n % 20 == 0) {
      const FastContact at = contact(*state);
      (void)stream.update({.sequence = static_cast<std::uint64_t>(n + 1),
                           .time_ns = n,
                           .position_m = x,
                           .triangle = at.triangle,
                           .in_contact = at.in_contact},
                          n, *fifo);
      while (const Element* element = fifo->front()) {
        accept(*state, *element);
        fifo->pop();
      }
    }
    const FastCommand command = step(*state, {x, n}, kTickS);
    ASSERT_EQ(command.fault, 0) << name(Fault{command.fault}) << ", seed " << seed
                                << " " << name(model) << " tick " << n;
    lowest_work_j = std::min(lowest_work_j, state->ledger.work_j);
    lowest_stored_j = std::min({lowest_stored_j, command.stored_j, command.tank_j,
                                static_cast<double>(state->ledger.dissipated_j)});
    if (model == LocalModel::kElement) {
      most_pull_n =
          std::max(most_pull_n, -state->safety.model_n.dot(state->element.direction));
      ASSERT_GE(state->element.friction_n_per_m, 0.0);
    }
    ASSERT_GE(state->potential.spring.n_per_m, 0.0);
  }
  EXPECT_GE(lowest_stored_j, 0.0) << seed << " " << name(model);
  EXPECT_GE(lowest_work_j, -1e-12) << seed << " " << name(model);
  EXPECT_LE(most_pull_n, 1e-9) << seed << " " << name(model);
}

TEST(RandomBodies, NothingPullsAndNoEnergyIsCreated) {
  for (int i = 0; i < bodies() && !testing::Test::HasFailure(); ++i) {
    const auto seed = static_cast<unsigned>(i);
    RandomBody body(seed);
    constexpr LocalModel kPassive[] = {LocalModel::kElement, LocalModel::kPotential,
                                       LocalModel::kEnergyTank,
                                       LocalModel::kEqualEnergy};
    walk(body, kPassive[i % 4], seed);
    walk(body, kPassive[(i + 1) % 4], seed);
  }
}

}  // namespace
}  // namespace palpate
