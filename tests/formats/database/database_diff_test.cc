#include "formats/database/database_diff.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "tests/support/contact_database.h"

namespace palpate {
namespace {

TEST(CurveDifference, OfStraightLinesIsClosedForm) {
  // f_a = 100 d to 2 mm, f_b = 130 d to 1 mm: off = 30 d, rms over [0, D] 30 D /
  // sqrt 3.
  const ResponseCurve a(std::vector{0.0, 0.0007, 0.002}, std::vector{0.0, 0.07, 0.2});
  const ResponseCurve b(std::vector{0.0, 0.001}, std::vector{0.0, 0.13});
  const CurveDifference found = difference({a.view()}, {b.view()});
  EXPECT_DOUBLE_EQ(found.depth_m, 0.001);
  EXPECT_NEAR(found.largest_n, 0.03, 1e-15);
  EXPECT_NEAR(found.rms_n, 0.03 / std::numbers::sqrt3, 1e-15);
  EXPECT_NEAR(found.force_rms_n, 0.1 / std::numbers::sqrt3, 1e-15);
}

TEST(CurveDifference, OfACurveAndItselfOrNothingIsZero) {
  const ResponseDatabase database = small_database();
  const CurveView curve = database.tools[0].curve(2);
  EXPECT_EQ(difference({curve}, {curve}).largest_n, 0.0);
  EXPECT_EQ(difference({curve}, PlacedCurve{}).rms_n, 0.0);
}

// The same force of the tool's position, stored from two first touches and along two
// directions: no difference of force.
TEST(CurveDifference, IsTakenWhereTheToolIsAtTheSamePlace) {
  const ResponseCurve a(std::vector{0.0, 0.001, 0.002}, std::vector{0.0, 0.1, 0.2});
  const ResponseCurve b(std::vector{0.0, 0.0006, 0.0012}, std::vector{0.0, 0.1, 0.2});
  const PlacedCurve first{a.view(), 0.0003, 1.0};
  const PlacedCurve same{b.view(), 0.0003, 0.6};
  EXPECT_NEAR(difference(first, same).largest_n, 0.0, 1e-15);
  EXPECT_NEAR(force_difference(first, same), 0.0, 1e-12);
  // 0.1 mm later: 100 N/m times that everywhere, of a tenth of the largest at least.
  const PlacedCurve later{a.view(), 0.0004, 1.0};
  EXPECT_NEAR(difference(first, later).largest_n, 0.01, 1e-12);
  EXPECT_NEAR(force_difference(later, first), 0.01 / 0.02, 1e-9);
}

// Equal magnitudes, one of them turned by half a radian at all depths.
TEST(CurveDifference, IsThatOfVectors) {
  const ResponseCurve a(std::vector{0.0, 0.001, 0.002}, std::vector{0.0, 0.1, 0.2});
  const PlacedCurve straight{a.view()};
  PlacedCurve turned{a.view()};
  turned.direction = {std::sin(0.5), 0.0, std::cos(0.5)};
  const double chord = 2.0 * std::sin(0.25);
  const CurveDifference found = difference(straight, turned);
  EXPECT_NEAR(found.largest_n, 0.2 * chord, 1e-15);
  EXPECT_NEAR(found.rms_n / found.force_rms_n, chord, 1e-12);
}

TEST(DatabaseDifference, ListsTheNodeThatWasChangedFirst) {
  const ResponseDatabase a = small_database();
  ResponseDatabase b = a;
  ResponseTable& ball = b.tools[1];
  const auto begin = static_cast<std::size_t>(ball.sample_begin[3]);
  const auto end = static_cast<std::size_t>(ball.sample_begin[4]);
  for (std::size_t i = begin; i < end; ++i) {
    ball.force_n[i] *= 1.5;
    ball.stiffness_n_per_m[i] *= 1.5;
  }
  const std::vector<ToolDifference> found = difference(a, b, 2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(found[0].agrees(0.0));
  EXPECT_FALSE(found[1].agrees(0.49));
  EXPECT_TRUE(found[1].agrees(0.51));
  EXPECT_EQ(found[1].compared, 5);
  // The stated errors of the five are theirs in the first file; one differs by half.
  EXPECT_DOUBLE_EQ(found[1].stated.covered, 0.8);
  EXPECT_EQ(found[1].stated.found_median, 0.0);
  ASSERT_EQ(found[1].worst.size(), 2u);
  EXPECT_EQ(found[1].worst[0].node, 3);
  EXPECT_NEAR(found[1].worst[0].relative_rms, 0.5, 1e-12);
  EXPECT_EQ(found[1].worst[1].relative_rms, 0.0);
}

// A tenth more lateral stiffness, or a radius of the pressure that is a tenth larger.
TEST(DatabaseDifference, ComparesContacts) {
  const ResponseDatabase a = with_contacts();
  EXPECT_EQ(difference(a, a, 1).front().largest_contact, 0.0);
  ResponseDatabase stiffer = a;
  stiffer.tools.front().contact.lateral.row(2) *= 1.1F;
  EXPECT_NEAR(difference(a, stiffer, 1).front().largest_contact, 0.1, 1e-6);
  EXPECT_FALSE(difference(a, stiffer, 1).front().agrees(0.09));
  EXPECT_TRUE(difference(a, stiffer, 1).front().agrees(0.11));
  ResponseDatabase wider = a;
  wider.tools.front().contact.moment_m2.row(1) *= 1.21F;
  EXPECT_NEAR(difference(a, wider, 1).front().largest_contact, 0.1, 1e-6);
  ResponseDatabase without = a;
  without.tools.front().contact.lateral.resize(0, 0);
  EXPECT_EQ(difference(a, without, 1).front().largest_contact, 1.0);
  ResponseDatabase hole = a;
  hole.tools.front().contact.lateral.row(2).setZero();
  EXPECT_EQ(difference(a, hole, 1).front().largest_contact, 1.0);
}

TEST(DatabaseDifference, OtherBodiesAreRefusedWithTheNode) {
  const ResponseDatabase a = small_database();
  ResponseDatabase b = a;
  b.body.position_m(4, 2) = 0.051;
  try {
    (void)difference(a, b, 1);
    FAIL() << "compared";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("node 4 is at (0, 0, 0.05)"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace palpate
