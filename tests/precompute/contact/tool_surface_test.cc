#include "precompute/contact/tool_surface.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/contact/convex_distance.h"
#include "tests/support/small_database.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

std::vector<ToolShape> all_kinds() {
  return {sphere(0.01),
          flat_punch(0.01, 0.0),
          flat_punch(0.01, 0.003),
          cone(std::numbers::pi / 6, 0.0),
          cone(1.2, 0.002),
          cone(std::numbers::pi / 6, 0.002, 0.03),
          capsule(0.006, 0.02),
          box_tool({0.02, 0.012, 0.016})};
}

std::string name_of(const testing::TestParamInfo<ToolShape>& info) {
  return info.param.name + std::to_string(info.index);
}

class EveryTool : public testing::TestWithParam<ToolShape> {
 protected:
  const ToolSurface surface_{GetParam()};
  std::mt19937 random_{7};

  Eigen::Vector3d random_point(double half_m = 0.03) {
    std::uniform_real_distribution<double> number(-half_m, half_m);
    return {number(random_), number(random_), number(random_)};
  }
};
INSTANTIATE_TEST_SUITE_P(Kinds, EveryTool, testing::ValuesIn(all_kinds()), name_of);

// What defines the distance to a convex body from outside: the foot p - d n lies on the
// surface, and the plane through it with normal n supports the body.
TEST_P(EveryTool, OutsideTheFootLiesOnTheSurfaceAndItsPlaneSupportsTheTool) {
  int outside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p = random_point();
    const ToolDistance d = surface_.distance(p);
    EXPECT_NEAR(d.normal.norm(), 1.0, 1e-12);
    if (d.distance_m > 1e-6) {
      ++outside;
      const Eigen::Vector3d foot = p - d.distance_m * d.normal;
      EXPECT_NEAR(surface_.distance(foot).distance_m, 0.0, 1e-12);
      EXPECT_NEAR(surface_.support_m(d.normal), foot.dot(d.normal), 1e-12);
    }
  }
  EXPECT_GT(outside, 500);
}

// Inside, -d is the least over all directions of the way to the supporting plane.
TEST_P(EveryTool, InsideTheDistanceIsTheWayToTheNearestSupportingPlane) {
  int inside = 0;
  for (int i = 0; i < 400 && inside < 60; ++i) {
    const Eigen::Vector3d p = random_point(0.01);
    const ToolDistance d = surface_.distance(p);
    if (d.distance_m < -1e-6) {
      ++inside;
      EXPECT_NEAR(surface_.support_m(d.normal) - d.normal.dot(p), -d.distance_m, 1e-12);
      for (int k = 0; k < 200; ++k) {
        const Eigen::Vector3d n = random_point().normalized();
        EXPECT_GE(surface_.support_m(n) - n.dot(p), -d.distance_m - 1e-12);
      }
    }
  }
  EXPECT_GT(inside, 10);
}

TEST_P(EveryTool, NormalIsTheGradientAndCurvatureTheHessian) {
  const double h = 1e-7;
  int smooth = 0;
  int outside = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p = random_point();
    const ToolDistance d = surface_.distance(p);
    if (d.distance_m < 5e-4) {
      continue;
    }
    ++outside;
    Eigen::Matrix3d hessian;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(axis);
      const ToolDistance ahead = surface_.distance(p + step);
      const ToolDistance behind = surface_.distance(p - step);
      EXPECT_NEAR(d.normal[axis], (ahead.distance_m - behind.distance_m) / (2 * h),
                  1e-6);
      hessian.col(axis) = (ahead.normal - behind.normal) / (2 * h);
    }
    // The Hessian jumps from piece to piece, where a difference sees both sides.
    smooth += (hessian - d.curvature_per_m).norm() < 1e-4 * (1.0 + hessian.norm());
  }
  EXPECT_GE(smooth, outside - 3);
  EXPECT_GT(outside, 50);
}

TEST_P(EveryTool, DistanceIsConvexAndOneLipschitz) {
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d a = random_point();
    const Eigen::Vector3d b = random_point();
    const double da = surface_.distance(a).distance_m;
    const double db = surface_.distance(b).distance_m;
    EXPECT_LE(surface_.distance(0.5 * (a + b)).distance_m, 0.5 * (da + db) + 1e-14);
    EXPECT_LE(std::abs(da - db), (a - b).norm() + 1e-14);
  }
}

TEST_P(EveryTool, TheDistanceAloneIsTheSame) {
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p = random_point();
    EXPECT_EQ(surface_.distance_m(p), surface_.distance(p).distance_m);
  }
}

TEST_P(EveryTool, WhereItIsPlacedItsDistanceIsTurnedWithIt) {
  const Eigen::Matrix3d rotation =
      Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized().toRotationMatrix();
  const PlacedTool tool{&surface_, rotation, {0.1, -0.2, 0.3}, rotation.col(2)};
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = random_point();
    const Eigen::Vector3d placed = rotation * p + tool.reference_m;
    const ToolDistance expected = surface_.distance(p);
    const ToolDistance found = distance(tool, placed);
    EXPECT_NEAR(found.distance_m, expected.distance_m, 1e-15);
    EXPECT_NEAR(distance_m(tool, placed), expected.distance_m, 1e-15);
    EXPECT_LT((found.normal - rotation * expected.normal).norm(), 1e-12);
    EXPECT_LT((found.curvature_per_m -
               rotation * expected.curvature_per_m * rotation.transpose())
                  .norm(),
              1e-12 * (1.0 + expected.curvature_per_m.squaredNorm()));
  }
}

TEST(ToolSurface, ClosedFormsOfTheDistance) {
  const ToolSurface punch(flat_punch(0.01, 0.002));
  EXPECT_NEAR(punch.distance({0.003, 0.0, -0.005}).distance_m, 0.005, 1e-17);
  EXPECT_NEAR(punch.distance({0.0, 0.013, 0.05}).distance_m, 0.003, 1e-17);
  EXPECT_NEAR(punch.distance({0.011, 0.0, -0.002}).distance_m, 0.005 - 0.002, 1e-17);
  EXPECT_EQ(punch.distance({0.0, 0.0, -0.005}).curvature_per_m.norm(), 0.0);
  const ToolSurface pointed(cone(std::numbers::pi / 6, 0.0));
  EXPECT_NEAR(pointed.distance({0.0, 0.0, -0.004}).distance_m, 0.004, 1e-17);
  EXPECT_NEAR(pointed.distance({0.01, 0.0, 0.0}).distance_m,
              0.01 * std::cos(std::numbers::pi / 6), 1e-17);
  // The rounded cone's flank lies where a sphere of the tip's radius is tangent to it.
  const ToolSurface rounded(cone(std::numbers::pi / 6, 0.002));
  EXPECT_NEAR(rounded.distance({0.0, 0.0, 0.0}).distance_m, 0.0, 1e-17);
  EXPECT_NEAR(rounded.distance({0.0, 0.0, -0.003}).distance_m, 0.003, 1e-17);
  EXPECT_NEAR(rounded.distance({0.01, 0.0, 0.002}).distance_m,
              0.01 * std::cos(std::numbers::pi / 6) - 0.002, 1e-17);
  const ToolSurface rod(capsule(0.006, 0.02));
  EXPECT_NEAR(rod.distance({0.01, 0.0, 0.013}).distance_m, 0.004, 1e-17);
  EXPECT_NEAR(rod.distance({0.0, 0.0, 0.03}).distance_m, 0.004, 1e-17);
}

TEST(ToolSurface, SupportIsInfiniteWhereAToolHasNoEnd) {
  EXPECT_TRUE(std::isinf(ToolSurface(flat_punch(0.01, 0.0)).support_m({0, 0.1, 1})));
  EXPECT_EQ(ToolSurface(flat_punch(0.01, 0.0)).support_m({0, 0, -1}), 0.0);
  EXPECT_NEAR(ToolSurface(flat_punch(0.01, 0.0)).support_m({1, 0, 0}), 0.01, 1e-17);
  EXPECT_TRUE(std::isinf(ToolSurface(cone(0.5, 0.0)).support_m({1, 0, 0})));
  EXPECT_EQ(ToolSurface(cone(0.5, 0.0)).support_m({0, 0, -1}), 0.0);
}

TEST(ToolSurface, WidthIsAcrossTheAxis) {
  EXPECT_NEAR(ToolSurface(sphere(0.01)).extent_m(), 0.02, 1e-17);
  EXPECT_NEAR(ToolSurface(flat_punch(0.01, 0.002)).extent_m(), 0.02, 1e-17);
  EXPECT_NEAR(ToolSurface(cone(std::numbers::pi / 4, 0.001)).extent_m(), 0.002, 1e-17);
  EXPECT_NEAR(ToolSurface(cone(std::numbers::pi / 4, 0.0, 0.03)).extent_m(), 0.06,
              1e-16);
  EXPECT_NEAR(ToolSurface(box_tool({0.03, 0.04, 1})).extent_m(), 0.05, 1e-16);
}

TEST(PlaceOnPath, TheLowestPointHasPassedTheVertexByThePenetration) {
  const Eigen::Vector3d vertex(0.1, 0.2, 0.3);
  const Eigen::Vector3d outward = Eigen::Vector3d(0.2, -0.1, 1.0).normalized();
  for (ToolShape shape : all_kinds()) {
    for (const bool tilted : {false, true}) {
      if (tilted) {
        shape.axis = Eigen::Vector3d(0.3, 0.1, 0.9).normalized();
      }
      const ToolSurface surface(shape);
      const PlacedTool tool = place_on_path(surface, vertex, outward, 0.002);
      const double lowest = tool.reference_m.dot(outward) -
                            surface.support_m(-(tool.rotation.transpose() * outward));
      EXPECT_NEAR(lowest, vertex.dot(outward) - 0.002, 1e-15) << shape.name;
      EXPECT_NEAR((tool.rotation.col(2) - shape.axis.value_or(outward)).norm(),
                  shape.kind == "sphere" && tilted ? (outward - *shape.axis).norm() : 0,
                  1e-14);
      EXPECT_NEAR((tool.reference_m - vertex).cross(outward).norm(), 0.0, 1e-15);
    }
  }
  const PlacedTool ball =
      place_on_path(ToolSurface(sphere(0.01)), vertex, outward, 0.002);
  EXPECT_NEAR((ball.reference_m - vertex - 0.008 * outward).norm(), 0.0, 1e-16);
}

TEST(PlaceOnPath, AHandleInTheWayGivesNoPlace) {
  ToolShape shape = flat_punch(0.01, 0.0);
  shape.axis = -Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(place_on_path(ToolSurface(shape), Eigen::Vector3d::Zero(),
                             Eigen::Vector3d::UnitZ(), 0.0)
                   .reference_m.allFinite());
}

TEST(ExpectedContactRadius, IsThatOfTheClosedForms) {
  EXPECT_NEAR(expected_contact_radius_m(sphere(0.01), 1e-4), 1e-3, 1e-17);
  EXPECT_EQ(expected_contact_radius_m(sphere(0.01), 1.0), 0.01);
  EXPECT_EQ(expected_contact_radius_m(flat_punch(0.01, 0.002), 1e-4), 0.01);
  EXPECT_NEAR(expected_contact_radius_m(cone(std::numbers::pi / 4, 0.0), 1e-3),
              2e-3 / std::numbers::pi, 1e-17);
  EXPECT_NEAR(expected_contact_radius_m(cone(std::numbers::pi / 4, 0.01), 1e-4), 1e-3,
              1e-17);
  EXPECT_NEAR(expected_contact_radius_m(capsule(0.01, 0.1), 1e-4), 1e-3, 1e-17);
  EXPECT_NEAR(expected_contact_radius_m(box_tool({0.02, 0.03, 1}), 1e-4),
              std::sqrt(6e-4 / std::numbers::pi), 1e-16);
}

TEST(ShadowArea, OfATipGrowsAsItsSection) {
  // An octahedron's corner: at height t the section is a square of diagonal 2 t.
  const SurfaceMesh mesh = octahedron(1.0);
  EXPECT_NEAR(shadow_area_m2(mesh, 0.25), 2 * 0.25 * 0.25, 1e-15);
  EXPECT_NEAR(shadow_area_m2(mesh, 1.5), 2.0, 1e-15);
}

}  // namespace
}  // namespace palpate
