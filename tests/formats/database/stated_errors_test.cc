#include "formats/database/stated_errors.h"

#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "formats/database/database_summary.h"

namespace palpate {
namespace {

constexpr double kEstimate = 0.01;
constexpr double kBudget = 0.05;
constexpr int kVertices = 7;

// A strip of five triangles, 0 1 2, 1 2 3 and so on, whose first vertex was hard.
SurfaceMesh strip() {
  SurfaceMesh body;
  body.position_m.resize(kVertices, 3);
  body.triangle.resize(kVertices - 2, 3);
  for (int v = 0; v < kVertices; ++v) {
    body.position_m.row(v) << 0.5 * v, v % 2, 0.0;
  }
  for (int t = 0; t + 2 < kVertices; ++t) {
    body.triangle.row(t) << t, t + 1, t + 2;
  }
  return body;
}

std::vector<NodeResponse> responses() {
  std::vector<NodeResponse> all(kVertices);
  for (NodeResponse& response : all) {
    response.origin = ResponseOrigin::kSimulated;
    response.error_relative = kEstimate;
  }
  all.front().flags = kNearSingular;
  return all;
}

// Of a press that knows itself well.
PlaceCheck check_in(std::int32_t triangle, double found) {
  PlaceCheck check{.vertex = triangle,
                   .place = {.triangle = triangle, .area_coordinate = {0.2, 0.3, 0.5}},
                   .response = {}};
  check.found = found;
  check.found_from.fill(found);
  return check;
}

class StateErrors : public testing::Test {
 protected:
  ErrorFactors state(const std::vector<PlaceCheck>& checks) {
    return state_errors(body_, kBudget, checks, response_);
  }
  [[nodiscard]] double stated_in(const PlaceCheck& check) const {
    const CheckCorners corners(body_, check);
    double blended = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      blended += corners.share(static_cast<Eigen::Index>(j)) *
                 response_[corners.vertex[j]].error_relative;
    }
    return blended;
  }

  const SurfaceMesh body_ = strip();
  std::vector<NodeResponse> response_ = responses();
};

// The hard vertex has a fifth of the place; its neighbours' errors count there, too.
TEST_F(StateErrors, CoverThePlacesOfElementsWithAHardNode) {
  const std::vector<PlaceCheck> checks{check_in(0, 0.08), check_in(4, 0.02)};
  const ErrorFactors factor = state(checks);
  EXPECT_NEAR(factor.hard.factor, 8.0, 1e-12);
  EXPECT_NEAR(factor.easy.factor, 2.0, 1e-12);
  EXPECT_NEAR(stated_in(checks[0]), 0.08, 1e-12);
  EXPECT_NEAR(stated_in(checks[1]), 0.02, 1e-12);
  for (std::size_t v = 0; v < response_.size(); ++v) {
    const bool beside = v < 3;
    EXPECT_NEAR(response_[v].error_relative, beside ? 0.08 : 0.02, 1e-12) << v;
    EXPECT_EQ((response_[v].flags & kErrorOverBudget) != 0, beside) << v;
  }
}

// Between nodes of both kinds lies an element without a hard node: its places are easy
// ones, which must not be covered worse.
TEST_F(StateErrors, StateNoLessBesideHardNodesThanElsewhere) {
  const std::vector<PlaceCheck> checks{check_in(0, 0.016), check_in(1, 0.03)};
  const ErrorFactors factor = state(checks);
  EXPECT_NEAR(factor.easy.factor, 3.0, 1e-12);
  EXPECT_NEAR(factor.hard.factor, 3.0, 1e-12);
  EXPECT_NEAR(stated_in(checks[1]), 0.03, 1e-12);
}

TEST_F(StateErrors, SayHowManyPlacesOfEachKindSoManyChecksCover) {
  std::vector<PlaceCheck> checks(4, check_in(4, 0.02));
  checks.push_back(check_in(0, 0.02));
  checks.push_back(check_in(0, std::numeric_limits<double>::infinity()));
  const ErrorFactors factor = state(checks);
  EXPECT_NEAR(factor.easy.covered, 4.0 / 5.0, 1e-12);
  EXPECT_NEAR(factor.hard.covered, 1.0 / 3.0, 1e-12);
  const AccuracyRecord record = accuracy_record(kBudget, factor, checks);
  EXPECT_EQ(record.verified, 5);
  EXPECT_EQ(record.between_nodes, 5);
  EXPECT_NEAR(record.hard_covered, 1.0 / 3.0, 1e-12);
}

TEST_F(StateErrors, HaveNoFactorOfAKindThatIsNotThere) {
  response_.front().flags = 0;
  const ErrorFactors factor = state({});
  EXPECT_EQ(factor.hard.factor, 0.0);
  EXPECT_EQ(factor.easy.factor, kLeastErrorFactor);
}

TEST(DescribedErrors, SayWhatHoldsWhereEveryPathWasHard) {
  AccuracyRecord record{.budget_relative = 0.05,
                        .hard_error_factor = 13.4,
                        .hard_covered = 0.95,
                        .verified = 19,
                        .between_nodes = 19,
                        .quantile_level = {},
                        .error_relative = {}};
  EXPECT_EQ(describe(record),
            "hold at 95 % of places: 13 times estimates, as every path was hard to "
            "follow, by 19 places that were solved again, better");
  record.error_factor = 1.5;
  record.covered = 0.9;
  EXPECT_EQ(describe(record),
            "hold at 90 % of places, 95 % where the path was hard to follow: 1.5 times "
            "estimates, 13 times where the path was hard to follow, by 19 places that "
            "were solved again, better");
  EXPECT_EQ(describe(AccuracyRecord{}), "");
}

}  // namespace
}  // namespace palpate
