#include "precompute/contact_surface.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/box_tets.h"

namespace palpate {
namespace {

ContactSurface unit_cube() {
  const BoxTets box = box_tets({0, 0.3, 1}, {0, 0.6, 1}, {0, 0.5, 1});
  return make_contact_surface(make_quadratic(box.tets, box.surface));
}

TEST(ContactSurface, HatsShareTheWholeArea) {
  double area = 0.0;
  for (const ContactNode& node : unit_cube().node) {
    area += node.area_m2;
  }
  EXPECT_NEAR(area, 6.0, 1e-12);
}

TEST(ContactSurface, AUnitLoadPushesInwardsWithOneNewtonOnAFlatFace) {
  for (const ContactNode& node : unit_cube().node) {
    const bool on_top_inside = node.position_m.z() == 1.0 && node.position_m.x() > 0 &&
                               node.position_m.x() < 1 && node.position_m.y() > 0 &&
                               node.position_m.y() < 1;
    if (on_top_inside) {
      Eigen::Vector3d total = Eigen::Vector3d::Zero();
      Eigen::Vector3d moment = Eigen::Vector3d::Zero();
      double weights = 0.0;
      for (const NodalForce& entry : node.load) {
        total += entry.force;
      }
      for (const GapPoint& point : node.gap_points) {
        weights += point.weight;
        moment += point.weight * point.position_m;
      }
      EXPECT_NEAR((total - Eigen::Vector3d(0, 0, -1)).norm(), 0.0, 1e-12);
      EXPECT_NEAR(weights, 1.0, 1e-12);
      EXPECT_GT(node.normal.z(), 1.0 - 1e-12);
    }
  }
}

// Quadratic faces carry a linear displacement exactly: its average over the hat, taken
// by the consistent load, is the average over the quadrature points.
TEST(ContactSurface, LoadAndGapAverageWithTheSameHat) {
  const BoxTets box = box_tets({0, 0.3, 1}, {0, 0.6, 1}, {0, 0.5, 1});
  const QuadraticMesh mesh = make_quadratic(box.tets, box.surface);
  const auto displacement = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(0.1 + p.x() - 2 * p.y() * p.z(), p.z() * p.z(),
                           3 * p.x() - p.y() * p.x());
  };
  for (const ContactNode& node : make_contact_surface(mesh).node) {
    double by_load = 0.0;
    for (const NodalForce& entry : node.load) {
      by_load +=
          entry.force.dot(displacement(mesh.position_m.row(entry.node).transpose()));
    }
    double by_points = 0.0;
    for (const GapPoint& point : node.gap_points) {
      by_points -= point.weight * point.normal.dot(displacement(point.position_m));
    }
    EXPECT_NEAR(by_load, by_points, 1e-12);
  }
}

TEST(SphereGap, IsTheDistanceAlongTheNormalOfAFlatSurface) {
  const PressedSphere sphere{{0.1, -0.2, 1.5}, {0, 0, 1}, 1.0};
  const Gap on_axis = sphere_gap({0.1, -0.2, 0.0}, {0, 0, 1}, sphere);
  EXPECT_NEAR(on_axis.distance_m, 0.5, 1e-15);
  EXPECT_NEAR((on_axis.by_centre - Eigen::Vector3d(0, 0, 1)).norm(), 0.0, 1e-15);
  const Gap beside = sphere_gap({0.7, -0.2, 0.0}, {0, 0, 1}, sphere);
  EXPECT_NEAR(beside.distance_m, 1.5 - 0.8, 1e-15);  // 0.6, 0.8, 1
}

TEST(SphereGap, PushesATiltedSurfaceAlongItsNormalWhereItTouches) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.4, 0.0, 1.0).normalized();
  const Eigen::Vector3d foot(0.3, -0.1, 0.2);
  const PressedSphere sphere{foot + 0.5 * normal, Eigen::Vector3d::UnitZ(), 0.5};
  const Gap touching = sphere_gap(foot, normal, sphere);
  EXPECT_NEAR(touching.distance_m, 0.0, 1e-15);
  EXPECT_NEAR((touching.by_centre - normal).norm(), 0.0, 1e-15);
  // Beside the foot the gap opens as a sphere's: s^2 / 2R to leading order.
  const Eigen::Vector3d beside = foot + 1e-3 * normal.cross(Eigen::Vector3d::UnitY());
  EXPECT_NEAR(sphere_gap(beside, normal, sphere).distance_m, 1e-6, 1e-8);
}

TEST(SphereGap, OfASurfaceThatFacesAwayIsZero) {
  const PressedSphere sphere{{0, 0, 1}, {0, 0, 1}, 1.0};
  const Gap gap = sphere_gap({0.1, 0, 0.3}, {0, 0.6, -0.8}, sphere);
  EXPECT_EQ(gap.distance_m, 0.0);
  EXPECT_EQ(gap.by_centre.norm(), 0.0);
}

TEST(SphereGap, DerivativeWithTheCentreIsTheDifference) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.1, 1.0).normalized();
  const Eigen::Vector3d press = Eigen::Vector3d(-0.1, 0.3, 1.0).normalized();
  const double h = 1e-6;
  for (const double x : {0.0, 0.3, 0.9, 0.96, 1.4}) {  // also beyond the straight part
    const Eigen::Vector3d p(x, 0.1, 0.0);
    const Eigen::Vector3d centre(0.0, 0.05, 0.9);
    const Gap gap = sphere_gap(p, normal, {centre, press, 1.0});
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(axis);
      const double ahead =
          sphere_gap(p, normal, {centre + step, press, 1.0}).distance_m;
      const double behind =
          sphere_gap(p, normal, {centre - step, press, 1.0}).distance_m;
      EXPECT_NEAR(gap.by_centre[axis], (ahead - behind) / (2 * h), 1e-7) << "x " << x;
    }
  }
}

}  // namespace
}  // namespace palpate
