#include "precompute/contact/contact_gap.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kPi = std::numbers::pi;

struct PressedSphere {
  Eigen::Vector3d centre_m;
  Eigen::Vector3d press;
  double radius_m;
};

PlacedTool placed(const ToolSurface& surface, const Eigen::Vector3d& reference_m,
                  const Eigen::Vector3d& press) {
  PlacedTool tool = place_on_path(surface, Eigen::Vector3d::Zero(), press, 0.0);
  tool.reference_m = reference_m;
  return tool;
}

Gap sphere_gap(const Eigen::Vector3d& p_m, const Eigen::Vector3d& normal,
               const PressedSphere& ball) {
  const ToolSurface surface(sphere(ball.radius_m));
  return tool_gap(p_m, normal, placed(surface, ball.centre_m, ball.press));
}

TEST(SphereGap, IsTheDistanceAlongTheNormalOfAFlatSurface) {
  const PressedSphere sphere{{0.1, -0.2, 1.5}, {0, 0, 1}, 1.0};
  const Gap on_axis = sphere_gap({0.1, -0.2, 0.0}, {0, 0, 1}, sphere);
  EXPECT_NEAR(on_axis.distance_m, 0.5, 1e-15);
  EXPECT_NEAR((on_axis.by_tool - Eigen::Vector3d(0, 0, 1)).norm(), 0.0, 1e-15);
  const Gap beside = sphere_gap({0.7, -0.2, 0.0}, {0, 0, 1}, sphere);
  EXPECT_NEAR(beside.distance_m, 1.5 - 0.8, 1e-15);  // 0.6, 0.8, 1
}

TEST(SphereGap, PushesATiltedSurfaceAlongItsNormalWhereItTouches) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.4, 0.0, 1.0).normalized();
  const Eigen::Vector3d foot(0.3, -0.1, 0.2);
  const PressedSphere sphere{foot + 0.5 * normal, Eigen::Vector3d::UnitZ(), 0.5};
  const Gap touching = sphere_gap(foot, normal, sphere);
  EXPECT_NEAR(touching.distance_m, 0.0, 1e-15);
  EXPECT_NEAR((touching.by_tool - normal).norm(), 0.0, 1e-15);
  // Beside the foot the gap opens as a sphere's: s^2 / 2R to leading order.
  const Eigen::Vector3d beside = foot + 1e-3 * normal.cross(Eigen::Vector3d::UnitY());
  EXPECT_NEAR(sphere_gap(beside, normal, sphere).distance_m, 1e-6, 1e-8);
}

TEST(SphereGap, OfAWallFarBelowIsNoLessThanTheDistanceToTheBall) {
  const PressedSphere ball{{0, 0, 0.006}, {0, 0, 1}, 0.012};
  const Eigen::Vector3d wall(0.0092, 0.0, -0.0056);
  const Eigen::Vector3d normal = Eigen::Vector3d(1.0, 0.0, 0.12).normalized();
  const double distance_m = std::hypot(0.0092, 0.0116) - 0.012;
  const Gap gap = sphere_gap(wall, normal, ball);
  EXPECT_NEAR(gap.distance_m, distance_m, 1e-15);
  EXPECT_NEAR((gap.by_tool - Eigen::Vector3d(-0.0092, 0.0, 0.0116).normalized()).norm(),
              0.0, 1e-12);
  // Its height times the cosine would be a fifth of that.
  const double height_m = 0.006 - std::sqrt(0.012 * 0.012 - 0.0092 * 0.0092) + 0.0056;
  EXPECT_LT(0.12 * height_m, 0.25 * distance_m);
  // Within the ball, and where the surface lies across the press, heights count.
  const double inside_m = -0.006 + std::sqrt(0.012 * 0.012 - 0.0092 * 0.0092) - 0.001;
  EXPECT_NEAR(sphere_gap({0.0092, 0.0, -inside_m}, normal, ball).distance_m,
              normal.z() * -0.001, 1e-12);
  EXPECT_NEAR(sphere_gap(wall, {0, 0, 1}, ball).distance_m, height_m, 1e-15);
}

TEST(SphereGap, OfASurfaceThatFacesAwayIsZero) {
  const PressedSphere sphere{{0, 0, 1}, {0, 0, 1}, 1.0};
  const Gap gap = sphere_gap({0.1, 0, 0.3}, {0, 0.6, -0.8}, sphere);
  EXPECT_EQ(gap.distance_m, 0.0);
  EXPECT_EQ(gap.by_tool.norm(), 0.0);
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
      EXPECT_NEAR(gap.by_tool[axis], (ahead - behind) / (2 * h), 1e-7) << "x " << x;
    }
  }
}

// The formula of the sphere, written out.
double height_above_sphere(double s, double R) {
  const double inside = std::min(s, 0.95 * R);
  const double depth = std::sqrt(R * R - inside * inside);
  return R - depth + inside / depth * (s - inside);
}

TEST(SphereGap, IsTheFormulaToRounding) {
  const PressedSphere ball{{0, 0, 0.02}, {0, 0, 1}, 0.02};
  for (double s = 0.0; s < 0.05; s += 0.001) {
    EXPECT_NEAR(sphere_gap({s, 0, 0}, {0, 0, 1}, ball).distance_m,
                height_above_sphere(s, 0.02), 1e-16);
  }
}

double height_at(const ToolShape& shape, double s) {
  const ToolSurface surface(shape);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  return tool_gap({s, 0, 0}, up,
                  place_on_path(surface, Eigen::Vector3d::Zero(), up, 0.0))
      .distance_m;
}

TEST(ToolGap, ProfilesOfTheUprightKinds) {
  const double slope = 0.95 / std::sqrt(1 - 0.95 * 0.95);
  EXPECT_NEAR(height_at(cone(kPi / 4, 0.0), 0.013), 0.013, 1e-17);
  EXPECT_NEAR(height_at(cone(kPi / 3, 0.0), 0.013), 0.013 / std::sqrt(3.0), 1e-17);
  // A rounded tip: its sphere to s = rho cos(alpha), then the flank, which a sharp
  // cone's tip rho (1 / sin(alpha) - 1) below would have.
  const double rho = 0.002;
  EXPECT_NEAR(height_at(cone(kPi / 6, rho), 0.001), rho - std::sqrt(3.0) * 1e-3, 1e-17);
  EXPECT_NEAR(height_at(cone(kPi / 6, rho), 0.01), 0.01 * std::sqrt(3.0) - rho, 1e-17);
  EXPECT_NEAR(height_at(flat_punch(0.01, 0.0), 0.0099), 0.0, 1e-17);
  EXPECT_NEAR(height_at(flat_punch(0.01, 0.0), 0.012), 0.002 * slope, 1e-17);
  EXPECT_NEAR(height_at(flat_punch(0.01, 0.002), 0.008), 0.0, 1e-17);
  EXPECT_NEAR(height_at(flat_punch(0.01, 0.002), 0.0092), 0.0004, 1e-17);  // 3, 4, 5
  // A needle's flank counts, however steep.
  EXPECT_NEAR(height_at(cone(0.1, 0.0), 0.001), 0.001 / std::tan(0.1), 1e-16);
}

TEST(ToolGap, AnUprightCapsuleIsItsLowerSphere) {
  for (const double s : {0.0, 0.001, 0.004, 0.0058, 0.02}) {
    EXPECT_NEAR(height_at(capsule(0.006, 0.02), s), height_at(sphere(0.006), s), 1e-17);
  }
}

// The two ways to the near side: by profile where the tool stands along the press, and
// along the line, here forced by a tilt too small to matter.
TEST(ToolGap, TheLineFindsWhatTheProfileSays) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const ToolShape& shape :
       {flat_punch(0.01, 0.003), cone(kPi / 6, 0.0), cone(1.2, 0.002),
        capsule(0.006, 0.02), cone(0.15, 0.001)}) {
    const ToolSurface surface(shape);
    PlacedTool tool = place_on_path(surface, Eigen::Vector3d::Zero(), up, 0.001);
    for (const double x : {0.0, 0.0013, 0.0055, 0.0079, 0.0098, 0.012, 0.04}) {
      const Eigen::Vector3d p(x, -0.3 * x, 1e-4);
      const Gap profile = tool_gap(p, up, tool);
      tool.rotation = Eigen::AngleAxisd(3e-8, Eigen::Vector3d::UnitY()).matrix();
      const Gap line = tool_gap(p, up, tool);
      tool.rotation.setIdentity();
      EXPECT_NEAR(line.distance_m, profile.distance_m, 1e-8) << shape.name << x;
      if (x > 0.0) {
        EXPECT_NEAR((line.by_tool - profile.by_tool).norm(), 0.0, 1e-4)
            << shape.name << x;
      }
    }
  }
}

TEST(ToolGap, ALyingCapsuleIsACylinder) {
  ToolShape shape = capsule(0.006, 0.05);
  shape.axis = Eigen::Vector3d::UnitX();
  const ToolSurface surface(shape);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const PlacedTool tool = place_on_path(surface, Eigen::Vector3d::Zero(), up, 0.0);
  for (const double x : {0.0, 0.01, 0.04}) {
    for (const double y : {-0.0055, 0.0, 0.003, 0.009}) {
      const Gap gap = tool_gap({x, y, 0.0}, up, tool);
      EXPECT_NEAR(gap.distance_m, height_above_sphere(std::abs(y), 0.006), 1e-13);
      EXPECT_NEAR(gap.by_tool.x(), 0.0, 1e-9);
    }
  }
  EXPECT_NEAR(tool_gap({-0.003, 0.0, 0.0}, up, tool).distance_m,
              height_above_sphere(0.003, 0.006), 1e-13);
}

TEST(ToolGap, ABoxIsFlatBelowAndSlopesBesideIt) {
  const ToolSurface surface(box_tool({0.02, 0.01, 0.03}));
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const PlacedTool tool = place_on_path(surface, Eigen::Vector3d::Zero(), up, 0.001);
  const double slope = 0.95 / std::sqrt(1 - 0.95 * 0.95);
  EXPECT_NEAR(tool_gap({0.009, -0.004, 0}, up, tool).distance_m, -0.001, 1e-15);
  EXPECT_NEAR(tool_gap({0.013, 0.002, 0}, up, tool).distance_m, -0.001 + 0.003 * slope,
              1e-12);
  EXPECT_NEAR(tool_gap({0.013, 0.009, 0}, up, tool).distance_m, -0.001 + 0.005 * slope,
              1e-12);
}

TEST(ToolGap, DerivativeWithTheToolsPositionIsTheDifference) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.1, 1.0).normalized();
  const Eigen::Vector3d press = Eigen::Vector3d(-0.1, 0.3, 1.0).normalized();
  const double h = 1e-8;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-0.015, 0.015);
  for (ToolShape shape : {sphere(0.01), flat_punch(0.01, 0.003), cone(kPi / 6, 0.001),
                          capsule(0.006, 0.02), box_tool({0.02, 0.012, 0.016})}) {
    for (const bool tilted : {false, true}) {
      if (tilted) {
        shape.axis = Eigen::Vector3d(0.3, 0.1, 0.9).normalized();
      }
      const ToolSurface surface(shape);
      const PlacedTool tool =
          place_on_path(surface, Eigen::Vector3d::Zero(), press, 0.002);
      int wrong = 0;
      for (int i = 0; i < 100; ++i) {
        const Eigen::Vector3d p(number(random), number(random), 0.1 * number(random));
        const Gap gap = tool_gap(p, normal, tool);
        for (int axis = 0; axis < 3; ++axis) {
          PlacedTool moved = tool;
          moved.reference_m[axis] += h;
          const double ahead = tool_gap(p, normal, moved).distance_m;
          moved.reference_m[axis] -= 2 * h;
          const double behind = tool_gap(p, normal, moved).distance_m;
          wrong += std::abs(gap.by_tool[axis] - (ahead - behind) / (2 * h)) > 1e-5;
        }
      }
      // A difference across an edge of the box sees both faces.
      EXPECT_LE(wrong, shape.kind == "mesh" ? 3 : 0) << shape.name << tilted;
    }
  }
}

TEST(ToolGap, OfATiltedToolIsConvexAlongTheSurface) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-0.02, 0.02);
  for (ToolShape shape :
       {flat_punch(0.01, 0.0), cone(kPi / 6, 0.0), box_tool({0.02, 0.012, 0.016})}) {
    shape.axis = Eigen::Vector3d(0.3, 0.1, 0.9).normalized();
    const ToolSurface surface(shape);
    const PlacedTool tool = place_on_path(surface, Eigen::Vector3d::Zero(), up, 0.0);
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d a(number(random), number(random), 0.0);
      const Eigen::Vector3d b(number(random), number(random), 0.0);
      const double ga = tool_gap(a, up, tool).distance_m;
      const double gb = tool_gap(b, up, tool).distance_m;
      EXPECT_LE(tool_gap(0.5 * (a + b), up, tool).distance_m, 0.5 * (ga + gb) + 1e-13);
      EXPECT_GE(ga, -1e-13);  // the lowest point is at the vertex's level
    }
  }
}

TEST(ShadowRadius, IsWhereTheNearSideReachesTheHeight) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const auto shadow = [&](const ToolShape& shape, double height_m) {
    return shadow_radius_m(
        place_on_path(ToolSurface(shape), Eigen::Vector3d::Zero(), up, 0.0), height_m);
  };
  EXPECT_NEAR(shadow(sphere(0.02), 1e-4), 2e-3, 1e-15);
  EXPECT_EQ(shadow(sphere(0.02), 1.0), 0.02);
  EXPECT_NEAR(shadow(cone(kPi / 4, 0.0), 1e-3), 1e-3, 2e-6);
  EXPECT_NEAR(shadow(flat_punch(0.01, 0.0), 1e-4), 0.01, 5e-5);
  EXPECT_NEAR(shadow(box_tool({0.03, 0.04, 1}), 1e-5), 0.025,
              5e-4);  // a corner between rays
  ToolShape lying = capsule(0.005, 0.03);
  lying.axis = Eigen::Vector3d::UnitY();
  EXPECT_NEAR(shadow(lying, 1e-4), 0.031, 1e-4);
}

}  // namespace
}  // namespace palpate
