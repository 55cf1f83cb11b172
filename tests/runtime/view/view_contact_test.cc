// Where the tool is drawn over the body, and how it stands.
#include "runtime/view/view_contact.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/response/tool_support.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

class ViewContactTest : public testing::Test {
 protected:
  ViewContact over(const ToolShape& tool, const Eigen::Vector3d& x_m) {
    return view_contact(database_, tool, search_, x_m, -1);
  }
  ResponseDatabase database_ = sample_database(
      sphere_surface(0.05, 3), ball(0.005, 0.0, 0.0),
      [](Eigen::Index, double d) {
        return d;
      },
      0.01);
  SurfaceSearch search_{database_.body};
};

TEST_F(ViewContactTest, SharesLeadBackToThePoint) {
  const ViewContact at = over(sphere(0.005), {0.03, 0.02, 0.045});
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < 3; ++j) {
    point_m += at.share(static_cast<Eigen::Index>(j)) *
               database_.body.position_m.row(at.node[j]).transpose();
  }
  EXPECT_LT((point_m - at.point_m).norm(), 1e-15);
  EXPECT_NEAR(at.share.sum(), 1.0, 1e-15);
}

TEST_F(ViewContactTest, AToolWithoutAxisStandsAlongTheNormal) {
  const Eigen::Vector3d place_m(0.03, 0.02, 0.045);
  for (const ToolShape& tool :
       {sphere(0.005), flat_punch(0.004, 0.001), capsule(0.003, 0.02)}) {
    const ViewContact at = over(tool, place_m);
    EXPECT_LT((at.turn * Eigen::Vector3d::UnitZ() - at.normal).norm(), 1e-15);
    EXPECT_NEAR(at.penetration_m,
                nominal_height_m(tool) - (place_m - at.point_m).dot(at.normal), 1e-15);
    EXPECT_NEAR(at.over_nominal_m, 0.0, 1e-15);
  }
}

TEST_F(ViewContactTest, AToolOfFixedAxisStandsAlongItAndTouchesWithItsSide) {
  ToolShape tool = capsule(0.003, 0.02);
  tool.axis = Eigen::Vector3d(0.6, 0.0, -0.8);
  const Eigen::Vector3d place_m(0.0, 0.0, 0.06);
  const ViewContact at = over(tool, place_m);
  EXPECT_LT((at.turn * Eigen::Vector3d::UnitZ() - *tool.axis).norm(), 1e-15);
  // The upper end is the lower one: 0.8 of the length below the reference point.
  EXPECT_NEAR(at.penetration_m, 0.003 + 0.8 * 0.02 - 0.01, 2e-5);  // facets of a ball
  EXPECT_NEAR(at.over_nominal_m, 0.8 * 0.02, 1e-5);
}

TEST_F(ViewContactTest, WithoutANormalTheToolDoesNotPress) {
  database_.normal.setZero();
  const ViewContact at = over(sphere(0.005), {0.0, 0.0, 0.04});
  EXPECT_EQ(at.penetration_m, 0.0);
  EXPECT_EQ(at.turn.w(), 1.0);
}

}  // namespace
}  // namespace palpate
