#include "fitting/insertion/toughness.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

IntervalEstimate cutting_force(double newtons) {
  return {newtons, 0.01 * newtons, 0.98 * newtons, 1.02 * newtons, {}};
}

// Gokgol 2012: 164 J/m^2 in bovine liver; an edge of 1.5 mm cuts it with 0.25 N.
TEST(Toughness, OfLiverComesBack) {
  const IntervalEstimate found = toughness_of(cutting_force(164.0 * 1.5e-3), 1.5e-3);
  EXPECT_NEAR(found.value, 164.0, 1e-9);
  EXPECT_NEAR(found.low, 0.98 * 164.0, 1e-9);
  EXPECT_NEAR(164.0 * 1.5e-3, 0.25, 0.005);
  EXPECT_EQ(toughness_warning(found), "");
}

TEST(Toughness, OfATearTestIsWarnedOf) {
  const IntervalEstimate found = toughness_of(cutting_force(17100.0 * 0.7e-3), 0.7e-3);
  EXPECT_NE(toughness_warning(found).find("15 to 27 times"), std::string::npos);
  EXPECT_EQ(toughness_warning(toughness_of(cutting_force(1136.0 * 0.7e-3), 0.7e-3)),
            "");
}

TEST(Toughness, NeedsAnEdgeAndACuttingForce) {
  EXPECT_THROW(static_cast<void>(toughness_of(cutting_force(1.0), 0.0)), InputError);
  const double nothing = std::nan("");
  EXPECT_THROW(static_cast<void>(toughness_of(cutting_force(1.0), nothing)),
               InputError);
  EXPECT_EQ(toughness_of(refused_estimate("why"), 1e-3).refused, "why");
}

}  // namespace
}  // namespace palpate
