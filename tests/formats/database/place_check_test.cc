#include "formats/database/place_check.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/error_calibration.h"
#include "formats/response/tool_support.h"
#include "tests/support/sample_units.h"

namespace palpate {
namespace {

constexpr std::int32_t kFails = 4;   // a vertex of the sample
constexpr double kCheckError = 0.2;  // that the check's press estimates of itself

// A place of a triangle of the octahedron that has the vertex.
SurfacePoint place_beside(const JobDescription& plan, std::int32_t vertex) {
  for (std::int32_t t = 0; t < plan.body.triangle.rows(); ++t) {
    const auto corner = plan.body.triangle.row(t);
    if ((corner.array() == vertex).any()) {
      return {.triangle = t, .area_coordinate = {0.2, 0.3, 0.5}};
    }
  }
  ADD_FAILURE() << "no such triangle";
  return {};
}

// The sample's check, moved to a place; the vertex that fails in the sample answers.
std::vector<WorkUnitOutcome> units_with(const SurfacePoint& place,
                                        bool all_answer = true) {
  std::vector<WorkUnitOutcome> units = sample_units();
  units.back().place = place;
  NodeResponse& response = units.back().node.front().response;
  response.touch_offset_m = 0.0;
  response.sample_direction.clear();
  response.error_relative = kCheckError;
  if (all_answer) {
    WorkUnitNode& failed = units[1].node.back();
    failed = units[0].node.front();
    failed.vertex = kFails;
    failed.response.direction = Eigen::Vector3d::UnitZ();
  }
  return units;
}

// What a press there gave, times a factor: found from where the tool is.
StoredForces times(double factor, const JobDescription& plan,
                   const std::vector<WorkUnitOutcome>& units, int& asked) {
  const NodeResponse response = units.back().node.front().response;
  const SurfacePoint place = units.back().place;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d outward = Eigen::Vector3d::Zero();
  for (int j = 0; j < 3; ++j) {
    const auto v = plan.body.triangle(place.triangle, j);
    at_m += place.area_coordinate(j) * plan.body.position_m.row(v).transpose();
    outward += place.area_coordinate(j) * plan.normal.row(v).transpose();
  }
  outward.normalize();
  const double height_m = height_at_touch_m(plan.tool.front(), outward);
  return [=, &asked](const ResponseDatabase& database, std::size_t tool,
                     const Points& x_m) {
    EXPECT_EQ(tool, 0U);
    EXPECT_EQ(database.tools.size(), 1U);
    ++asked;
    Points force_n(x_m.rows(), 3);
    const double along = std::abs(outward.dot(response.direction));
    for (Eigen::Index i = 0; i < x_m.rows(); ++i) {
      const double depth_m = height_m - (x_m.row(i).transpose() - at_m).dot(outward);
      const double d_m = depth_m * along;
      // The sample's law, whose cubic through nine points is within 2 % of it.
      force_n.row(i) =
          factor * 1100.0 * d_m * std::sqrt(d_m) * response.direction.transpose();
    }
    return force_n;
  };
}

TEST(PlaceCheck, ComparesTheFieldWhereThePlaceIs) {
  const JobDescription plan = sample_plan();
  const std::vector<WorkUnitOutcome> units = units_with(place_beside(plan, kFails));
  for (const double factor : {1.0, 1.3}) {
    int asked = 0;
    const Assembly all = assemble(plan, units, times(factor, plan, units, asked));
    EXPECT_EQ(asked, 1);
    ASSERT_EQ(all.checked.size(), 1U);
    EXPECT_NEAR(all.checked.front(), factor - 1.0, 0.03);
    const ResponseTable& table = all.database.tools.front();
    EXPECT_EQ(table.accuracy.verified, 1);
    EXPECT_EQ(table.accuracy.between_nodes, 1);
    EXPECT_EQ(table.verified_error_relative[0], all.checked.front());
    EXPECT_TRUE(std::isnan(table.verified_error_relative[1]));
  }
}

TEST(PlaceCheck, StatesWhatCoversThePlaceByTheCornersShares) {
  const JobDescription plan = sample_plan();
  const std::vector<WorkUnitOutcome> units = units_with(place_beside(plan, kFails));
  int asked = 0;
  const Assembly all = assemble(plan, units, times(1.5, plan, units, asked));
  const ResponseTable& table = all.database.tools.front();
  double stated = 0.0;
  for (int j = 0; j < 3; ++j) {
    stated += units.back().place.area_coordinate(j) *
              table.error_relative[static_cast<std::size_t>(
                  plan.body.triangle(units.back().place.triangle, j))];
  }
  EXPECT_NEAR(stated, std::hypot(all.checked.front(), kCheckError), 1e-12);
}

// A field that is 30 % off up to a quarter of the largest force, at 0.4 of the depth,
// and right below.
TEST(PlaceCheck, TellsErrorsByDepthWhereSoManyChecksAllow) {
  JobDescription plan = sample_plan();
  std::vector<WorkUnitOutcome> units = units_with(place_beside(plan, kFails));
  int asked = 0;
  const StoredForces right = times(1.0, plan, units, asked);
  const StoredForces wrong = times(1.3, plan, units, asked);
  const StoredForces both = [&](const ResponseDatabase& database, std::size_t tool,
                                const Points& x_m) {
    Points force_n = right(database, tool, x_m);
    const Points off_n = wrong(database, tool, x_m);
    const double quarter_n = 0.25 * 1100.0 * 0.003 * std::sqrt(0.003);
    for (Eigen::Index i = 0; i < force_n.rows(); ++i) {
      if (force_n.row(i).norm() < quarter_n) {
        force_n.row(i) = off_n.row(i);
      }
    }
    return force_n;
  };
  for (const std::size_t checks : {18U, 19U}) {
    while (units.size() < 2 + checks) {
      units.push_back(units.back());
      units.back().index = std::ssize(units) - 1;
    }
    plan.units = std::ssize(units);
    const Assembly all = assemble(plan, units, both);
    const AccuracyRecord& accuracy = all.database.tools.front().accuracy;
    EXPECT_EQ(accuracy.between_nodes, static_cast<std::int64_t>(checks));
    if (checks < kChecksToCalibrate) {
      EXPECT_TRUE(accuracy.depth_share.empty());
      continue;
    }
    ASSERT_EQ(accuracy.covering_relative.size(), 3U);
    EXPECT_NEAR(accuracy.covering_relative[0], std::hypot(0.3, kCheckError), 0.03);
    EXPECT_NEAR(accuracy.covering_relative[1], std::hypot(0.3, kCheckError), 0.03);
    EXPECT_NEAR(accuracy.covering_relative[2], kCheckError, 0.03);
  }
}

TEST(PlaceCheck, SaysNothingWhereTheElementDoesNotRespond) {
  const JobDescription plan = sample_plan();
  const std::vector<WorkUnitOutcome> units =
      units_with(place_beside(plan, kFails), false);
  int asked = 0;
  const Assembly all = assemble(plan, units, times(1.5, plan, units, asked));
  EXPECT_EQ(asked, 0);
  EXPECT_TRUE(all.checked.empty());
  EXPECT_EQ(all.database.tools.front().accuracy.verified, 0);
}

TEST(PlaceCheck, RefusesPlacesThatTheBodyDoesNotHave) {
  const JobDescription plan = sample_plan();
  for (const SurfacePoint& place :
       {SurfacePoint{.triangle = 8, .area_coordinate = {1.0, 0.0, 0.0}},
        SurfacePoint{.triangle = 0, .area_coordinate = {0.7, 0.7, -0.4}},
        SurfacePoint{.triangle = 0, .area_coordinate = {0.1, 0.1, 0.1}},
        SurfacePoint{.triangle = 0, .area_coordinate = {std::nan(""), 0.5, 0.5}}}) {
    EXPECT_THROW((void)assemble(plan, units_with(place), {}), InputError);
  }
}

TEST(PlaceCheck, SurvivesBytes) {
  const JobDescription plan = sample_plan();
  const WorkUnitOutcome unit = units_with(place_beside(plan, kFails)).back();
  const WorkUnitOutcome back = unit_from_bytes(to_bytes(unit), "unit");
  EXPECT_EQ(back.place.triangle, unit.place.triangle);
  EXPECT_EQ(back.place.area_coordinate, unit.place.area_coordinate);
}

}  // namespace
}  // namespace palpate
