// Dents that stay and curves that soften: what a table's rows mean.
#include "formats/response/yielding.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "formats/response/response_curve.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr NodeYielding kNode{.yield_depth_m = 0.001,
                             .share = 0.4,
                             .onset_m = 0.0013,
                             .scale_m = 0.002,
                             .largest = 0.5};

ResponseCurve curve(double exponent = 1.5) {
  std::vector<double> depth_m;
  std::vector<double> force_n;
  for (int i = 0; i <= 20; ++i) {
    depth_m.push_back(4e-4 * i);
    force_n.push_back(2000.0 * std::pow(4e-4 * i, exponent));
  }
  return {depth_m, force_n};
}

// How far the first press of the undamaged curve is from the stored one, at worst, over
// its largest force.
double first_press_misfit(const ResponseCurve& first, const NodeYielding& node) {
  const OwnedCurve whole = undamaged_curve(first.view(), node);
  double worst_n = 0.0;
  for (double d = 0.0; d < 0.008; d += 1e-6) {
    const double left = 1.0 - softened_share(node, d);
    worst_n = std::max(
        worst_n, std::abs(left * whole.view().at(d).force_n - first.at(d).force_n));
  }
  return worst_n / first.at(0.008).force_n;
}

TEST(Yielding, SoftensFromTheOnsetOnByNoMoreThanTheLargest) {
  EXPECT_EQ(softened_share(kNode, 0.0), 0.0);
  EXPECT_EQ(softened_share(kNode, 0.0013), 0.0);
  EXPECT_NEAR(softened_share(kNode, 0.0033), 0.5 * (1.0 - std::exp(-1.0)), 1e-15);
  EXPECT_NEAR(softened_share(kNode, 1.0), 0.5, 1e-15);
}

TEST(Yielding, TheUndamagedCurveTimesWhatIsLeftIsTheFirstPress) {
  const ResponseCurve first = curve();
  const OwnedCurve whole = undamaged_curve(first.view(), kNode);
  EXPECT_EQ(whole.depth_m.size(), 48U);
  EXPECT_TRUE(
      std::is_sorted(whole.depth_m.begin(), whole.depth_m.end(), std::less_equal<>()));
  for (const double d : whole.depth_m) {
    const double left = 1.0 - softened_share(kNode, d);
    EXPECT_NEAR(left * whole.view().at(d).force_n, first.at(d).force_n, 5e-16) << d;
  }
  EXPECT_LT(first_press_misfit(first, kNode), 2e-6);
  EXPECT_GT(first_press_misfit(first, kNode), 1e-12);
}

// The error of a cubic grows with the fourth power of its width over the scale.
TEST(Yielding, CurvesThatSoftenFastAreFollowedLessWell) {
  struct Row {
    double scale;  // [-] of the largest depth
    double most;   // [-]
  };
  for (const Row& row : {Row{0.3, 5e-7}, Row{0.1, 1e-5}, Row{0.02, 5e-4}}) {
    for (const double exponent : {1.0, 1.5, 3.0}) {
      for (const double largest : {0.3, 0.6, 0.9}) {
        const NodeYielding node{
            .onset_m = 0.0013, .scale_m = 0.008 * row.scale, .largest = largest};
        const double misfit = first_press_misfit(curve(exponent), node);
        EXPECT_LT(misfit, row.most) << row.scale << ' ' << exponent << ' ' << largest;
      }
    }
  }
}

TEST(Yielding, EnergiesOfTheUndamagedCurveAreItsIntegral) {
  const OwnedCurve whole = undamaged_curve(curve().view(), kNode);
  double energy_j = 0.0;
  for (std::size_t i = 0; i + 1 < whole.depth_m.size(); ++i) {
    energy_j += interval_energy_j(whole.view(), i);
    EXPECT_NEAR(whole.energy_j[i + 1], energy_j, 1e-18);
  }
}

TEST(Yielding, DevicesAreJudgedByTheSlopeOfLettingGo) {
  // f = k d: let go past the yield depth, its slope is k / (1 - share).
  const ResponseCurve line(std::vector<double>{0.0, 0.004, 0.008},
                           std::vector<double>{0.0, 0.4, 0.8});
  NodeYielding dents{.yield_depth_m = 0.001, .share = 0.4};
  EXPECT_NEAR(yielded_stiffness_max_n_per_m(line.view(), dents), 100.0 / 0.6, 1e-9);
  dents.yield_depth_m = 1.0;
  EXPECT_NEAR(yielded_stiffness_max_n_per_m(line.view(), dents), 100.0, 1e-9);
  // Softened, the slope at the deepest press m is k + k m omega'(m) / (1 - omega(m)).
  const NodeYielding soft{.onset_m = 0.0, .scale_m = 0.004, .largest = 0.5};
  const auto slope = [](double m) {
    const double x = std::exp(-m / 0.004);
    return 100.0 + 100.0 * m * 0.5 / 0.004 * x / (0.5 + 0.5 * x);
  };
  double largest = 0.0;
  for (double m = 0.0; m <= 0.008; m += 1e-6) {
    largest = std::max(largest, slope(m));
  }
  EXPECT_NEAR(yielded_stiffness_max_n_per_m(line.view(), soft), largest,
              0.01 * largest);
}

TEST(Yielding, OfATableOnlyCurvesThatSoftenChange) {
  ResponseTable table = sample_database(
                            plate(0.1, 2), ball(0.005, 0.0, 0.0),
                            [](Eigen::Index, double d) {
                              return 2e4 * d * d;
                            },
                            0.01, 21)
                            .tools[0];
  const ResponseTable before = table;
  make_undamaged(table);
  EXPECT_EQ(table.force_n, before.force_n);
  Yielding& yielding = table.viscoelasticity.yielding;
  yielding.onset_m = {0.002};
  yielding.scale_m = {0.003};
  yielding.largest.assign(static_cast<std::size_t>(table.nodes()), 0.3);
  yielding.largest[4] = 0.0;
  make_undamaged(table);
  EXPECT_EQ(table.curve(0).depth_m.size(), 48U);
  EXPECT_EQ(table.curve(4).depth_m.size(), 21U);
  EXPECT_EQ(table.curve(4).force_n.back(), before.curve(4).force_n.back());
  EXPECT_GT(table.curve(5).force_n.back(), 1.2 * before.curve(5).force_n.back());
}

TEST(Yielding, IsToldInALine) {
  EXPECT_EQ(describe(Yielding{}), "");
  EXPECT_EQ(describe(Yielding{.yield_depth_m = {0.001}, .share = {0.4}}),
            "dents stay past 1 mm, 40 % of it");
  EXPECT_EQ(
      describe(Yielding{
          .onset_m = {0.002, 0.003}, .scale_m = {0.003, 0.003}, .largest = {0.0, 0.5}}),
      "softens past 2 to 3 mm by up to 0 to 50 %, over 3 mm");
}

}  // namespace
}  // namespace palpate
