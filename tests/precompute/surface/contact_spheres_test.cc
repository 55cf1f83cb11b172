// Spheres found for tools' surfaces.
#include "precompute/surface/contact_spheres.h"

#include <cmath>

#include <gtest/gtest.h>

#include "precompute/surface/primitive_bodies.h"

namespace palpate {
namespace {

TEST(ContactSpheres, OfABallAreTheBallWhereTheyMayBeAsLarge) {
  const SurfaceMesh ball = sphere_surface(Eigen::Vector3d(0.0, 0.0, 0.01), 0.01, 0.001);
  const ContactSpheres spheres = contact_spheres(ball, 3, 0.0);
  EXPECT_EQ(spheres.centre_m.rows(), 3);
  EXPECT_NEAR(spheres.radius_m, 0.01, 2e-4);
  // Faces of edges of 1 mm lie 1^2 / 6 / 10 mm below the ball.
  EXPECT_LT(spheres.largest_error_m, 2e-4);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_LT((spheres.centre_m.row(i) - Eigen::RowVector3d(0.0, 0.0, 0.01)).norm(),
              2e-4);
  }
}

TEST(ContactSpheres, TouchTheSurfaceFromInside) {
  const SurfaceMesh ball = sphere_surface(Eigen::Vector3d::Zero(), 0.01, 0.001);
  const ContactSpheres spheres = contact_spheres(ball, 8, 0.004);
  EXPECT_EQ(spheres.radius_m, 0.004);
  for (Eigen::Index i = 0; i < 8; ++i) {
    EXPECT_NEAR(spheres.centre_m.row(i).norm(), 0.006, 1e-4);
    for (Eigen::Index j = 0; j < i; ++j) {
      EXPECT_GT((spheres.centre_m.row(i) - spheres.centre_m.row(j)).norm(), 0.003);
    }
  }
  // The first at the tip.
  EXPECT_NEAR(spheres.centre_m(0, 2), -0.006, 2e-4);
  EXPECT_GT(spheres.largest_error_m, 1e-4);
  EXPECT_GE(spheres.largest_error_m, spheres.rms_error_m);
}

TEST(ContactSpheres, MoreOfThemAreNearer) {
  const SurfaceMesh body = organ(2);
  double before_m = 1.0;
  for (const std::size_t count : {4, 16, 64}) {
    const double rms_m = contact_spheres(body, count, 0.0).rms_error_m;
    EXPECT_LT(rms_m, before_m);
    before_m = rms_m;
  }
}

}  // namespace
}  // namespace palpate
