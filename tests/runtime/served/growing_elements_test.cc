#include "runtime/served/growing_elements.h"

#include <cmath>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/bench/runtime/growing_walk.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/walk_ticks.h"

namespace palpate {
namespace {

constexpr double kSlope = 200.0;  // [N/m]

ToolState over(const Eigen::Vector3d& at_m, std::uint64_t tick, std::int32_t triangle) {
  return {.sequence = tick,
          .time_ns = static_cast<std::int64_t>(tick) * 500'000,
          .position_m = at_m,
          .triangle = triangle,
          .in_contact = triangle >= 0};
}

class GrowingPlate : public testing::Test {
 protected:
  GrownNode answer(std::int32_t node, GrownQuality quality, double slope,
                   const Eigen::Vector3d& direction = Eigen::Vector3d::UnitZ()) {
    WorkUnitNode answer{.tool = 0, .vertex = node};
    if (slope > 0.0) {
      answer.response = {.direction = direction,
                         .depth_m = {0.0, 0.005, 0.01},
                         .force_n = {0.0, 0.005 * slope, 0.01 * slope},
                         .origin = ResponseOrigin::kSimulated};
    }
    return grown_node(tool_, answer, quality, body_.position_m.row(node).transpose(),
                      normal_.row(node).transpose());
  }

  void answer_all(GrownQuality quality, double slope) {
    std::vector<GrownNode> answers;
    for (std::int32_t i = 0; i < body_.position_m.rows(); ++i) {
      answers.push_back(answer(i, quality, slope));
    }
    elements_.hand_over(std::move(answers));
  }

  // One slow turn of 10 ms, the tool pressed into the middle; the active element.
  Element turn() {
    tick_ += 20;
    const Eigen::Vector3d at_m(1e-4, 2e-4, 0.003);
    elements_.update(over(at_m, tick_, triangle_),
                     static_cast<std::int64_t>(tick_) * 500'000, *fifo_);
    Element active;
    while (const Element* element = fifo_->front()) {
      active = element->active ? *element : active;
      fifo_->pop();
    }
    triangle_ = active.triangle;
    return active;
  }

  static double slope_of(const Element& element) {
    double slope = 0.0;
    for (const ElementNode& node : element.node) {
      slope = std::max(slope,
                       node.samples > 0 ? node.curve().at(0.005).force_n / 0.005 : 0.0);
    }
    return slope;
  }

  const SurfaceMesh body_ = plate(0.1, 20);
  const Points normal_ = vertex_normals(body_);
  const ToolShape tool_ = ball(0.005, 0.3, 5e-4);
  GrowingElements elements_{body_, normal_, tool_};
  std::unique_ptr<ElementFifo> fifo_ = std::make_unique<ElementFifo>();
  std::uint64_t tick_ = 1;
  std::int32_t triangle_ = -1;
};

TEST_F(GrowingPlate, HasNoForceAtFirstAndTakesAnswersElsewhereAtOnce) {
  EXPECT_EQ(slope_of(turn()), 0.0);
  EXPECT_EQ(elements_.here(), GrownQuality::kNone);
  answer_all(GrownQuality::kPreliminary, kSlope);
  (void)turn();
  EXPECT_EQ(elements_.quality(0), GrownQuality::kPreliminary);  // a corner, far away
  EXPECT_EQ(elements_.quality(body_.triangle(triangle_, 0)), GrownQuality::kNone);
}

// Which the end of a large scene tells at once.
TEST_F(GrowingPlate, AnUpdateLooksAtNoMoreAnswersThanItsTimeAllows) {
  (void)turn();
  for (int i = 0; i < 10; ++i) {
    answer_all(GrownQuality::kPreliminary, kSlope);
  }
  const std::int64_t all = 10 * body_.position_m.rows();
  (void)turn();
  EXPECT_GE(elements_.waiting(),
            all - static_cast<std::int64_t>(GrowingElements::kAnUpdate));
  for (int i = 0; i < 4; ++i) {
    (void)turn();
  }
  EXPECT_LT(elements_.waiting(), 20);  // those under the tool
  EXPECT_EQ(elements_.quality(0), GrownQuality::kPreliminary);
}

TEST_F(GrowingPlate, UnderTheToolForceRisesAndFallsInSteps) {
  (void)turn();
  answer_all(GrownQuality::kPreliminary, kSlope);
  double before = 0.0;
  int turns = 0;
  for (; before < kSlope && turns < 200; ++turns) {
    const double now = slope_of(turn());
    EXPECT_GT(now, before);
    EXPECT_LE(now - before, GrowingElements::kStepShare * kSlope * (1 + 1e-9));
    before = now;
  }
  // Of 10 mm on triangles 3.5 mm high the energy is 1.41 times the largest force, and
  // goes by the bound over sqrt 8: 80 steps.
  EXPECT_GE(turns, 78);
  EXPECT_LE(turns, 82);
  (void)turn();
  EXPECT_EQ(elements_.here(), GrownQuality::kPreliminary);
  EXPECT_EQ(elements_.waiting(), 0);

  answer_all(GrownQuality::kFinal, kSlope / 4.0);
  const double next = slope_of(turn());
  EXPECT_LT(next, kSlope);
  EXPECT_GE(next, kSlope * (1.0 - 1.01 * GrowingElements::kStepShare));
}

TEST_F(GrowingPlate, ACheapAnswerAfterAGoodOneIsOldNews) {
  answer_all(GrownQuality::kFinal, kSlope);
  EXPECT_NEAR(slope_of(turn()), kSlope, 1e-9);
  answer_all(GrownQuality::kPreliminary, 3.0 * kSlope);
  EXPECT_NEAR(slope_of(turn()), kSlope, 1e-9);
  EXPECT_EQ(elements_.waiting(), 0);
  // Of another scene it is news.
  elements_.outdate();
  (void)turn();
  EXPECT_EQ(elements_.quality(0), GrownQuality::kPreliminary);
  answer_all(GrownQuality::kPreliminary, 3.0 * kSlope);
  EXPECT_GT(slope_of(turn()), kSlope);
}

TEST_F(GrowingPlate, CountsTicksInTheBodyByWhatItAnswers) {
  (void)turn();  // the first counts from tick 0: 21
  (void)turn();
  EXPECT_EQ(elements_.ticks(), (QualityTicks{41, 0, 0, 0}));
  answer_all(GrownQuality::kFinal, kSlope);
  for (int i = 0; i < 95; ++i) {
    (void)turn();
  }
  const QualityTicks ticks = elements_.ticks();
  EXPECT_EQ(ticks[0] + ticks[3], 41 + 95 * 20);
  EXPECT_GE(ticks[0], 41 + 78 * 20);  // rising is not there yet
  EXPECT_GE(ticks[3], 10 * 20);
  ASSERT_EQ(elements_.by_second().size(), 1U);
  EXPECT_EQ(elements_.by_second()[0], ticks);
  tick_ = 0;  // of a new run: 20 are done at its first turn
  (void)turn();
  EXPECT_EQ(elements_.ticks()[3], ticks[3] + 20);
}

TEST_F(GrowingPlate, SoftensWhatTheDeviceCannotRenderAndCountsIt) {
  GrowingElements soft(body_, normal_, tool_, kSlope / 2.0);
  soft.hand_over({answer(7, GrownQuality::kFinal, kSlope),
                  answer(8, GrownQuality::kFinal, kSlope / 4.0)});
  EXPECT_EQ(soft.softened(), 1);
  ElementNode node = answer(7, GrownQuality::kFinal, kSlope).message;
  EXPECT_NEAR(soften(node, kSlope / 2.0), 0.5, 1e-12);
  EXPECT_NEAR(node.curve().at(0.005).force_n, 0.0025 * kSlope, 1e-12);
  EXPECT_NEAR(node.curve().at(0.005).energy_j, 0.25 * kSlope * 2.5e-5, 1e-12);
  // Friction of at most 0.3 N: its spring is no stiffer, either.
  EXPECT_NEAR(0.3 * 0.01 * kSlope / 2.0 / node.presliding_m, kSlope / 2.0, 1e-9);
}

TEST_F(GrowingPlate, NonsenseGivesNoForce) {
  const auto into = answer(7, GrownQuality::kFinal, kSlope, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(into.message.samples, 0);
  EXPECT_EQ(answer(7, GrownQuality::kFinal, -1.0).message.samples, 0);
  GrownNode nowhere = answer(7, GrownQuality::kFinal, kSlope);
  nowhere.node = 100'000;
  elements_.hand_over({nowhere});
  EXPECT_EQ(slope_of(turn()), 0.0);
}

TEST_F(GrowingPlate, TellsWhereTheHandIsAndHowFastItGoes) {
  HandPlace hand;
  EXPECT_FALSE(elements_.fetch_hand(hand));
  for (std::uint64_t i = 0; i < 60; ++i) {
    const double x = 5e-4 * static_cast<double>(i);  // in 10 ms
    elements_.update(over({x, 0.0, 0.02}, 1 + 20 * i, -1),
                     static_cast<std::int64_t>(i) * 10'000'000, *fifo_);
  }
  ASSERT_TRUE(elements_.fetch_hand(hand));
  EXPECT_NEAR(hand.velocity_m_per_s.x(), 0.05, 1e-5);
  EXPECT_NEAR(hand.position_m.x(), 59 * 5e-4, 1e-12);
  EXPECT_FALSE(elements_.fetch_hand(hand));
}

ResponseDatabase walked_ball(double friction) {
  return sample_database(
      sphere_surface(0.05, 3), ball(0.005, friction, 5e-4),
      [](Eigen::Index node, double d) {
        return static_cast<double>(node % 3 + 1) * 500.0 * std::pow(d, 1.5);
      },
      0.006);
}

TEST(GrowingWalk, ExchangesUnderTheToolCreateNoEnergyAndKeepTheBound) {
  for (const double friction : {0.0, 0.3}) {
    const ResponseDatabase database = walked_ball(friction);
    for (const LocalModel model : {LocalModel::kPotential, LocalModel::kElement}) {
      const GrowingWalkReport r =
          run_growing_walk(database, {.model = model, .ticks = walk_ticks(40'000)});
      std::printf("%s, friction %.1f: %s", name(model).data(), friction,
                  table_text(r).c_str());
      EXPECT_EQ(r.fault, Fault::kNone) << name(model);
      EXPECT_EQ(r.not_finite, 0);
      // Sums of energies below 1e-1 J, each rounded at 1e-17 J.
      EXPECT_LT(r.created_j, 1e-12);
      EXPECT_LT(r.drift_j, 1e-10);
      EXPECT_GT(r.contact_ticks, walk_ticks(40'000) / 6);
      EXPECT_GT(r.exchanges, walk_ticks(40'000) / 200);
      EXPECT_GT(r.compared, walk_ticks(40'000) / 200);
      EXPECT_GT(r.step_along_of_bound, 0.1);
      if (model == LocalModel::kPotential) {
        EXPECT_LE(r.step_along_of_bound, 1.0);
        EXPECT_LE(r.step_of_bound, friction > 0.0 ? 4.0 : 1.3);
      }
    }
  }
}

TEST(GrowingWalk, RefusesWhatIsNoWalk) {
  const ResponseDatabase database = walked_ball(0.0);
  EXPECT_THROW((void)run_growing_walk(database, {.contrast = 0.5}), InputError);
  EXPECT_THROW((void)run_growing_walk(database, {.model = LocalModel::kSingle}),
               InputError);
}

}  // namespace
}  // namespace palpate
