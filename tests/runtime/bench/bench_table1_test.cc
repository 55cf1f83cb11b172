#include "runtime/bench/bench_table1.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/bench/paper_wall.h"

namespace palpate {
namespace {

// Whether a movement dies out is seen in half of the time that the table takes.
Table1Options brief() {
  Table1Options options;
  options.settle_s = 2.0;
  options.watch_s = 5.0;
  return options;
}

// Computed once.
const Table1Report& table1_report() {
  static const Table1Report kReport = run_table1(brief());
  return kReport;
}

const std::vector<double>& column(LocalModel model) {
  const auto found =
      std::find_if(table1_report().columns.begin(), table1_report().columns.end(),
                   [&](const Table1Column& c) {
                     return c.model == model;
                   });
  return found->stiffness_n_per_m;
}

double spread(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high / *low;
}

TEST(Table1, SingleThreadColumnFollowsThePaper) {
  const std::vector<double>& single = column(LocalModel::kSingle);
  for (std::size_t i = 0; i < kPaperRatesHz.size(); ++i) {
    const double paper = kPaperTable1[0].stiffness_n_per_m[i];
    EXPECT_NEAR(single[i], paper, 0.15 * paper) << kPaperRatesHz[i] << " Hz";
  }
}

TEST(Table1, FirstOrderHoldNeverFallsBelowTheSingleThread) {
  const std::vector<double>& hold = column(LocalModel::kFirstOrderHold);
  const std::vector<double>& single = column(LocalModel::kSingle);
  EXPECT_DOUBLE_EQ(hold[0], single[0]);
  for (std::size_t i = 1; i < kPaperRatesHz.size(); ++i) {
    EXPECT_GT(hold[i], single[i]) << kPaperRatesHz[i] << " Hz";
  }
}

// Down to 50 Hz.
std::vector<double> first_seven(const std::vector<double>& values) {
  return {values.begin(), values.begin() + 7};
}

TEST(Table1, PassiveColumnsAreFlat) {
  EXPECT_LE(spread(first_seven(column(LocalModel::kEqualEnergy))), 1.02);
  EXPECT_LE(spread(first_seven(column(LocalModel::kEnergyTank))), 1.02);
  EXPECT_LE(spread(column(LocalModel::kElement)), 1.02);
  EXPECT_LE(spread(column(LocalModel::kPotential)), 1.02);
}

TEST(Table1, OnTheQuadraticPartTheTankStaysFlatToo) {
  Table1Options options;
  options.preload_n = 0.1;
  const auto stiffness = [&](LocalModel model, double rate_hz) {
    return largest_stable_stiffness(options, model, rate_hz);
  };
  const double fast = stiffness(LocalModel::kEnergyTank, 2000.0);
  EXPECT_NEAR(stiffness(LocalModel::kEnergyTank, 100.0), fast, 0.02 * fast);
  EXPECT_NEAR(stiffness(LocalModel::kEnergyTank, 50.0), fast, 0.02 * fast);
  EXPECT_LT(stiffness(LocalModel::kEqualEnergy, 100.0), 0.5 * fast);
  EXPECT_NEAR(stiffness(LocalModel::kElement, 10.0), fast, 0.02 * fast);
}

// Viscosity never asks for a softer wall: measured pork, and one that relaxes fast.
TEST(Table1, AWallThatRelaxesMayBeAsStiffAsOneThatDoesNot) {
  const std::array<WallRelaxation, 2> walls{
      WallRelaxation{{0.258, 0.303}, {0.42, 4.5}},
      WallRelaxation{{0.45, 0.35}, {0.004, 0.06}}};
  for (const LocalModel model : {LocalModel::kElement, LocalModel::kPotential}) {
    Table1Options options = brief();
    options.wall = WallShape::kLinear;
    options.stiffness_max = 1000.0;
    const double elastic = largest_stable_stiffness(options, model, 100.0);
    double before = elastic;
    for (const WallRelaxation& wall : walls) {
      options.relaxation = wall;
      const double relaxing = largest_stable_stiffness(options, model, 100.0);
      EXPECT_GT(relaxing, 1.5 * before) << name(model) << ' ' << wall.time_s.front();
      before = relaxing;
    }
  }
}

// Elements of such a wall would be refused, and nothing is as stable as no wall.
TEST(Table1, AWallThatCannotRelaxSoIsAnInputError) {
  Table1Options options;
  options.rates_hz = {100.0};
  for (const WallRelaxation& wall :
       {WallRelaxation{{0.2}, {}}, WallRelaxation{{0.6, 0.6}, {1.0, 2.0}},
        WallRelaxation{{0.2, 0.2}, {2.0, 1.0}},
        WallRelaxation{{0.1, 0.1, 0.1, 0.1, 0.1}, {1.0, 2.0, 3.0, 4.0, 5.0}}}) {
    options.relaxation = wall;
    EXPECT_THROW(run_table1(options), InputError);
  }
}

TEST(Table1, PassiveColumnsReachWhatTheFastRateAllows) {
  // Bisection width 0.2 % on either side.
  const double single = column(LocalModel::kSingle)[0];
  for (const LocalModel model :
       {LocalModel::kEnergyTank, LocalModel::kEqualEnergy, LocalModel::kElement}) {
    EXPECT_NEAR(column(model)[5], single, 0.005 * single) << name(model);
  }
}

TEST(Table1, ReportNamesItsColumnsAndPrintsThePaper) {
  const auto json = parse_json(to_json(table1_report()));
  EXPECT_EQ(json["rates_hz"].size(), 9U);
  for (const char* name : {"single", "first-order-hold", "equal-energy", "energy-tank",
                           "element", "potential"}) {
    EXPECT_EQ(json["columns"][name].size(), 9U) << name;
  }
  EXPECT_EQ(json["paper"]["single"][5], 38.0);
  EXPECT_EQ(json["paper"].size(), 3U);
}

TEST(Table1, RefusesASlowRateThatDoesNotDivideTheFastOne) {
  Table1Options options;
  options.rates_hz = {300.0};
  EXPECT_THROW((void)run_table1(options), InputError);
}

TEST(Wall, ValueAndSlopeAreContinuousAtTheKnee) {
  const double k = 170.0;
  const SlowValue before = wall_response(k, 0.005);
  const SlowValue after = wall_response(k, 0.005 + 1e-12);
  EXPECT_NEAR(before.f_n, after.f_n, 1e-9);
  EXPECT_NEAR(before.k_n_per_m, after.k_n_per_m, 1e-9);
  EXPECT_NEAR(before.energy_j, after.energy_j, 1e-12);
}

TEST(Wall, AsPrintedItWouldJumpAtTheKnee) {
  const double k = 170.0;
  const double printed = k * (0.005 - 0.000025);
  EXPECT_GT(printed, 1.9 * wall_response(k, 0.005).f_n);
}

TEST(Wall, StiffnessBoundsTheSlopeEverywhere) {
  const double k = 170.0;
  for (double x = -0.001; x < 0.02; x += 1e-4) {
    EXPECT_LE(wall_response(k, x).k_n_per_m, k * (1.0 + 1e-12));
  }
}

TEST(Wall, EnergyIsTheIntegralOfForce) {
  const double k = 170.0;
  const double h = 1e-6;
  double sum = 0.0;
  for (double x = 0.0; x < 0.012 - h / 2; x += h) {
    sum += h * wall_response(k, x + h / 2).f_n;
  }
  // Midpoint rule: error h^2 f'' / 24 times the length.
  EXPECT_NEAR(sum, wall_response(k, 0.012).energy_j, 1e-10);
}

TEST(Wall, DepthInvertsForce) {
  for (const double f : {0.0, 0.1, 0.425, 1.0, 5.0}) {
    EXPECT_NEAR(wall_response(170.0, wall_depth_m(170.0, f)).f_n, f, 1e-12);
  }
}

}  // namespace
}  // namespace palpate
