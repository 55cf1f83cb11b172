// Two curves of a node, compared where the tool is at the same place.
#include "formats/response/force_difference.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "formats/response/response_curve.h"

namespace palpate {
namespace {

// F = k d over so many samples.
ResponseCurve line(double k_n_per_m, double depth_m, int samples = 20) {
  std::vector<double> d;
  std::vector<double> f;
  for (int i = 0; i <= samples; ++i) {
    d.push_back(depth_m * i / samples);
    f.push_back(k_n_per_m * d.back());
  }
  return {d, f};
}

TEST(ForceDifference, IsRelativeToTheReferencesForce) {
  const ResponseCurve one = line(103.0, 0.01);
  const ResponseCurve better = line(100.0, 0.01);
  EXPECT_NEAR(force_difference({one.view()}, {better.view()}), 0.03, 1e-12);
  EXPECT_EQ(force_difference({better.view()}, {better.view()}), 0.0);
}

TEST(ForceDifference, ComparesAtEqualToolPosition) {
  // The same force at the same place, stored from another first touch on and along a
  // direction 60 deg off the normal: half of the penetration.
  const ResponseCurve straight = line(100.0, 0.01);
  const ResponseCurve slanted = line(200.0, 0.005);
  EXPECT_NEAR(
      force_difference({straight.view(), 0.001, 1.0}, {slanted.view(), 0.001, 0.5}),
      0.0, 1e-12);
  // First touches 0.1 mm apart are an error of force: largest where the force is least,
  // but relative to a tenth of the largest force at least.
  const double late = force_difference({straight.view(), 1e-4}, {straight.view()});
  EXPECT_NEAR(late, 1e-4 / 1e-3, 1e-9);
}

// Unit vectors in the plane of x and z, at an angle to z.
Eigen::Vector3d leaning(double angle_rad) {
  return {std::sin(angle_rad), 0.0, std::cos(angle_rad)};
}

constexpr double kTwentyDegrees = std::numbers::pi / 9.0;
const double kChordOfTwenty = 2.0 * std::sin(0.5 * kTwentyDegrees);

// Equal magnitudes that point 20 degrees apart are a chord apart, however the direction
// is told.
TEST(ForceDifference, CountsDirections) {
  const ResponseCurve curve = line(100.0, 0.01);
  const PlacedCurve straight{curve.view()};
  PlacedCurve turned{curve.view()};
  turned.direction = leaning(kTwentyDegrees);
  EXPECT_NEAR(force_difference(turned, straight), kChordOfTwenty, 1e-12);
  EXPECT_NEAR(force_difference(straight, turned), kChordOfTwenty, 1e-12);
  PlacedCurve tilted_by_line{curve.view()};
  tilted_by_line.tilt =
      TiltLine{.tilt = Eigen::Vector3d(std::tan(kTwentyDegrees), 0.0, 0.0)};
  EXPECT_NEAR(force_difference(tilted_by_line, straight), kChordOfTwenty, 1e-12);
  EXPECT_NEAR(force_difference(tilted_by_line, turned), 0.0, 1e-12);
}

// Across to a force that is 3 % larger: the hypotenuse.
TEST(ForceDifference, JoinsMagnitudeAndDirection) {
  const ResponseCurve better = line(100.0, 0.01);
  const ResponseCurve larger = line(103.0, 0.01);
  PlacedCurve turned{larger.view()};
  turned.direction = leaning(0.1);
  EXPECT_NEAR(force_difference(turned, {better.view()}),
              std::hypot(0.03, std::sqrt(1.03) * 2.0 * std::sin(0.05)), 1e-12);
}

TEST(ForceDifference, FollowsDirectionsByDepth) {
  constexpr int kSamples = 20;
  const ResponseCurve curve = line(100.0, 0.01, kSamples);
  std::vector<double> direction;
  for (int k = 0; k <= kSamples; ++k) {
    const Eigen::Vector3d u = leaning(kTwentyDegrees * k / kSamples);
    direction.insert(direction.end(), u.begin(), u.end());
  }
  PlacedCurve turning{curve.view()};
  turning.sample_direction = direction;
  // Largest at the end.
  EXPECT_NEAR(force_difference(turning, {curve.view()}), kChordOfTwenty, 1e-12);
  EXPECT_LT((turning.direction_at(0.005) - leaning(0.5 * kTwentyDegrees)).norm(),
            1e-12);
  EXPECT_LT((turning.direction_at(1.0) - leaning(kTwentyDegrees)).norm(), 1e-12);
  // A line of tilts that follows them, but for the tangent's bend.
  PlacedCurve by_line{curve.view()};
  by_line.tilt = TiltLine{
      .by_depth_per_m = Eigen::Vector3d(std::tan(kTwentyDegrees) / 0.01, 0.0, 0.0)};
  EXPECT_LT(force_difference(by_line, turning), 0.02);
  // Where there is a line, it is what a hand gets, whatever the samples say.
  by_line.sample_direction = turning.sample_direction;
  by_line.tilt = TiltLine{};
  EXPECT_NEAR(force_difference(by_line, turning), kChordOfTwenty, 1e-12);
}

// In a table: stored tilts, else directions by sample, else the one direction.
TEST(ForceDifference, OfTwoTablesIsThatOfTheirVectors) {
  NodeResponse straight;
  straight.direction = Eigen::Vector3d::UnitZ();
  straight.origin = ResponseOrigin::kSimulated;
  for (int k = 0; k <= 4; ++k) {
    straight.depth_m.push_back(1e-3 * k);
    straight.force_n.push_back(0.1 * k);
  }
  NodeResponse turned = straight;
  turned.direction = leaning(kTwentyDegrees);
  for (double& depth_m : turned.depth_m) {
    depth_m *= std::cos(kTwentyDegrees);  // the same penetrations
  }
  NodeResponse by_sample = straight;
  by_sample.sample_direction.assign(5, leaning(kTwentyDegrees));
  NodeResponse by_tilt = straight;
  by_tilt.tilt = TiltLine{.tilt = Eigen::Vector3d(std::tan(kTwentyDegrees), 0.0, 0.0)};
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const ResponseTable reference = make_table({"tip", "sphere", 0.002}, {straight});
  for (const NodeResponse& response : {turned, by_sample, by_tilt}) {
    const ResponseTable table = make_table({"tip", "sphere", 0.002}, {response});
    EXPECT_NEAR(
        force_difference(placed_curve(table, 0, up), placed_curve(reference, 0, up)),
        kChordOfTwenty, 1e-12);
  }
}

TEST(ForceDifference, CountsFromATenthOfTheDepthOn) {
  const ResponseCurve better = line(100.0, 0.01, 100);
  std::vector<double> d;
  std::vector<double> f;
  for (int i = 0; i <= 100; ++i) {
    d.push_back(1e-4 * i);
    f.push_back(100.0 * d.back() * (i < 9 ? 3.0 : 1.0));
  }
  const ResponseCurve wrong_at_first(d, f);
  EXPECT_LT(force_difference({wrong_at_first.view()}, {better.view()}), 1e-9);
}

TEST(ForceDifference, OfNothingAndSomethingIsAllOfIt) {
  const ResponseCurve curve = line(100.0, 0.01);
  EXPECT_EQ(force_difference({}, {}), 0.0);
  EXPECT_EQ(force_difference({curve.view()}, {}), 1.0);
  EXPECT_EQ(force_difference({}, {curve.view()}), 1.0);
}

}  // namespace
}  // namespace palpate
