// Two curves of a node, compared where the tool is at the same place.
#include "formats/response/force_difference.h"

#include <cmath>
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
