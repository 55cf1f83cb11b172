#include "runtime/attach/placed_device.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

const Eigen::Vector3d rest_m(0.0, 0.09, 0.0);

HandScript pressed(const Eigen::Vector3d& normal) {
  return {.surface_m = {0.02, -0.01, 0.03},
          .normal = normal.normalized(),
          .touch_m = 0.005,
          .clear_m = 0.01};
}

TEST(PlacedDevice, ItsRightIsThePicturesAsFarAsTheNormalLets) {
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(0.3, -0.5, 0.8), Eigen::Vector3d(1.0, 0.05, 0.0)}) {
    for (const Eigen::Vector3d& right :
         {Eigen::Vector3d(0.6, 0.8, 0.0), Eigen::Vector3d(-1.0, 0.0, 0.0),
          Eigen::Vector3d::Zero().eval()}) {
      const HandScript script = pressed(normal);
      const Placement placed = placement_over(script, rest_m, right);
      EXPECT_TRUE((placed.rotation * placed.rotation.transpose()).isIdentity(1e-12));
      EXPECT_NEAR(placed.rotation.determinant(), 1.0, 1e-12);
      EXPECT_TRUE(placed.rotation.col(1).isApprox(script.normal, 1e-12));
      if (std::abs(right.dot(script.normal)) < 0.9 && !right.isZero()) {
        const Eigen::Vector3d across =
            (right - right.dot(script.normal) * script.normal).normalized();
        EXPECT_TRUE(placed.rotation.col(0).isApprox(across, 1e-12));
      }
    }
  }
}

TEST(PlacedDevice, InASectionStaysInItWhereverTheDeviceGoes) {
  for (int axis = 0; axis < 2; ++axis) {
    const Placement placement = placement_in({.axis = axis, .offset_m = 0.007},
                                             pressed({0.3, 0.2, 1.0}), rest_m);
    for (const double x : {-0.05, 0.0, 0.04}) {
      for (const double y : {0.03, 0.09, 0.12}) {
        EXPECT_NEAR(placement.to_body({x, y, 0.0})[axis], 0.007, 1e-15);
      }
    }
    EXPECT_LT((placement.rotation.transpose() * placement.rotation -
               Eigen::Matrix3d::Identity())
                  .norm(),
              1e-14);
    EXPECT_NEAR(placement.rotation.determinant(), 1.0, 1e-14);
  }
}

TEST(PlacedDevice, InASectionPressesAgainstTheNormalsPartInIt) {
  const HandScript script = pressed({0.0, 0.3, 1.0});
  const Placement placement =
      placement_in({.axis = 1, .offset_m = -0.01}, script, rest_m);
  const Eigen::Vector3d up = placement.rotation.col(1);
  EXPECT_NEAR(up.z(), 1.0, 1e-14);
  EXPECT_EQ(up.y(), 0.0);
  EXPECT_NEAR(placement.to_body(rest_m).z(), 0.03 + 0.015, 1e-14);
}

TEST(PlacedDevice, ASectionAlongTheSurfaceIsRefused) {
  EXPECT_THROW((void)placement_in({.axis = 2}, pressed({0.0, 0.1, 1.0}), rest_m),
               InputError);
}

TEST(PlacedDevice, APlaneIsAnAxisAndADistance) {
  EXPECT_EQ(parse_plane("y=-0.02").axis, 1);
  EXPECT_EQ(parse_plane("y=-0.02").offset_m, -0.02);
  for (const char* wrong : {"", "x", "x=", "w=1", "x=1mm", "x=inf", "x=nan", "x:1"}) {
    EXPECT_THROW((void)parse_plane(wrong), InputError) << wrong;
  }
}

}  // namespace
}  // namespace palpate
