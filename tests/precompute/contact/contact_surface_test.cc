#include "precompute/contact/contact_surface.h"

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

}  // namespace
}  // namespace palpate
