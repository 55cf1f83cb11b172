// Mesh tools whose faces are slanted to every axis, against bodies in closed form: on
// their own faces, edges and corners, where rounding decides what looks at a point, and
// anywhere else.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "precompute/contact/contact_gap.h"
#include "precompute/contact/tool_surface.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/small_database.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kSizeM = 0.01;
constexpr double kRoundingM =
    1e-15;  // of coordinates of kSizeM, through a few products

class TurnedPolyhedra : public testing::Test {
 protected:
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Eigen::Vector3d random_point(double half_m) {
    return {uniform(-half_m, half_m), uniform(-half_m, half_m),
            uniform(-half_m, half_m)};
  }
  Eigen::Matrix3d random_turn() {
    std::normal_distribution<double> number;
    return Eigen::Quaterniond(number(random_), number(random_), number(random_),
                              number(random_))
        .normalized()
        .toRotationMatrix();
  }

  // Anywhere around the mesh, on its faces, its edges and its corners.
  std::vector<Eigen::Vector3d> places(const SurfaceMesh& mesh) {
    std::vector<Eigen::Vector3d> all;
    const double half_m = 1.5 * mesh.position_m.cwiseAbs().maxCoeff();
    for (int i = 0; i < 300; ++i) {
      all.push_back(random_point(half_m));
    }
    for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
      Eigen::Matrix3d corner;
      for (int k = 0; k < 3; ++k) {
        corner.col(k) = mesh.position_m.row(mesh.triangle(t, k)).transpose();
      }
      for (int i = 0; i < 8; ++i) {
        Eigen::Vector3d share(uniform(0, 1), i < 4 ? uniform(0, 1) : 0.0,
                              uniform(0, 1));
        share /= share.sum();
        all.emplace_back(corner * share);
      }
      all.emplace_back(corner.col(0));
    }
    return all;
  }

  std::mt19937 random_{11};
};

SurfaceMesh turned(const Eigen::Matrix3d& turn, SurfaceMesh mesh) {
  mesh.position_m = (mesh.position_m * turn.transpose()).eval();
  return mesh;
}

// Distance to a box about the origin, by its half sides.
double box_distance_m(const Eigen::Vector3d& p_m, const Eigen::Vector3d& half_m) {
  const Eigen::Vector3d beyond = p_m.cwiseAbs() - half_m;
  return beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : beyond.maxCoeff();
}

TEST_F(TurnedPolyhedra, ABoxIsTheBoxInClosedForm) {
  const Eigen::Vector3d sides(0.02, 0.012, 0.016);
  SurfaceMesh box = box_tool(sides).mesh;
  box.position_m.col(2).array() -= 0.5 * sides.z();
  for (int k = 0; k < 10; ++k) {
    const Eigen::Matrix3d turn = random_turn();
    const ToolSurface surface(mesh_tool("box", turned(turn, box)));
    for (const Eigen::Vector3d& p : places(surface.shape().mesh)) {
      EXPECT_NEAR(surface.distance(p).distance_m,
                  box_distance_m(turn.transpose() * p, 0.5 * sides), kRoundingM)
          << p.transpose();
    }
  }
}

TEST_F(TurnedPolyhedra, AnOctahedronIsTheOctahedronInClosedForm) {
  for (int k = 0; k < 10; ++k) {
    const Eigen::Matrix3d turn = random_turn();
    const ToolSurface surface(
        mesh_tool("octahedron", turned(turn, octahedron(kSizeM))));
    for (const Eigen::Vector3d& p : places(surface.shape().mesh)) {
      // Outside, the nearest point of |x| + |y| + |z| = r has every coordinate smaller
      // by as much, but none below 0 (Duchi et al. 2008, the simplex).
      Eigen::Vector3d size = (turn.transpose() * p).cwiseAbs();
      std::sort(size.begin(), size.end());
      double expected = (size.sum() - kSizeM) / std::sqrt(3.0);
      if (expected > 0.0) {
        double by = (size.sum() - kSizeM) / 3.0;
        if (size[0] < by) {
          by = (size[1] + size[2] - kSizeM) / 2.0;
          by = size[1] < by ? size[2] - kSizeM : by;
        }
        expected = size.cwiseMin(by).norm();
      }
      EXPECT_NEAR(surface.distance(p).distance_m, expected, kRoundingM)
          << p.transpose();
    }
  }
}

// A body between two others is no nearer than the outer and no farther than the inner.
void expect_between(const ToolSurface& inner, const ToolSurface& outer,
                    const ToolSurface& surface, const Eigen::Vector3d& p) {
  const ToolDistance found = surface.distance(p);
  EXPECT_LE(found.distance_m, inner.distance_m(p) + kRoundingM) << p.transpose();
  EXPECT_GE(found.distance_m, outer.distance_m(p) - kRoundingM) << p.transpose();
  EXPECT_NEAR(found.normal.norm(), 1.0, 1e-12) << p.transpose();
}

// Distance of the nearest face from the origin, which lies inside.
double inscribed_radius_m(const SurfaceMesh& mesh) {
  return -ToolSurface(mesh_tool("body", mesh)).distance_m(Eigen::Vector3d::Zero());
}

TEST_F(TurnedPolyhedra, AnIcosphereIsBetweenItsBalls) {
  for (const int levels : {0, 1, 2}) {
    const SurfaceMesh ball = icosphere(kSizeM, levels);
    const ToolSurface inner(sphere(inscribed_radius_m(ball)));
    const ToolSurface outer(sphere(kSizeM));
    for (int k = 0; k < 3; ++k) {
      const ToolSurface surface(mesh_tool("ball", turned(random_turn(), ball)));
      for (const Eigen::Vector3d& p : places(surface.shape().mesh)) {
        expect_between(inner, outer, surface, p);
      }
    }
  }
}

TEST_F(TurnedPolyhedra, APyramidIsBetweenItsCones) {
  const int sides = 16;
  const double height_m = 0.03;
  const double inner_m = kSizeM * std::cos(kHalfTurn / sides);
  const ToolSurface inner(cone(std::atan(inner_m / height_m), 0.0, height_m));
  const ToolSurface outer(cone(std::atan(kSizeM / height_m), 0.0, height_m));
  for (int k = 0; k < 5; ++k) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(uniform(0, kHalfTurn), Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
    const ToolSurface surface(
        mesh_tool("cone", turned(turn, upturned_pyramid(sides, kSizeM, height_m))));
    for (const Eigen::Vector3d& p : places(surface.shape().mesh)) {
      expect_between(inner, outer, surface, p);
    }
  }
}

// The way along the press to the near side, and what moves it.
TEST_F(TurnedPolyhedra, GapsAreBetweenThoseOfTheirBalls) {
  const SurfaceMesh ball = icosphere(kSizeM, 2);
  const ToolSurface inner(sphere(inscribed_radius_m(ball)));
  const ToolSurface outer(sphere(kSizeM));
  const ToolSurface surface(mesh_tool("ball", ball));
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d press = random_point(1.0).normalized();
    const Eigen::Vector3d p = random_point(1.2 * kSizeM) - kSizeM * press;
    const Eigen::Vector3d normal = (press + 0.5 * random_point(1.0)).normalized();
    const auto gap_to = [&](const ToolSurface& tool) {
      return tool_gap(p, normal,
                      {&tool, random_turn(), Eigen::Vector3d::Zero(), press});
    };
    const Gap gap = gap_to(surface);
    const double tolerance_m = 1e-11;  // of the search along the line
    EXPECT_LE(gap.distance_m, gap_to(inner).distance_m + tolerance_m) << i;
    EXPECT_GE(gap.distance_m, gap_to(outer).distance_m - tolerance_m) << i;
    EXPECT_TRUE(gap.by_tool.allFinite()) << i;
  }
}

// On the way down the search for the near side ends on a face, whatever it lies in.
TEST_F(TurnedPolyhedra, AGapIsTheWayToTheFaceThatIsMet) {
  const std::vector<SurfaceMesh> bodies{octahedron(kSizeM), icosphere(kSizeM, 1),
                                        prism(6, kSizeM, 0.02),
                                        box_tool({0.02, 0.012, 0.016}).mesh};
  for (const SurfaceMesh& body : bodies) {
    const ToolSurface surface(mesh_tool("body", body));
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Matrix3d turn = random_turn();
      const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
      const PlacedTool tool{&surface, turn, Eigen::Vector3d::Zero(), up};
      const Eigen::Vector3d p =
          random_point(kSizeM) -
          (surface.support_m(-(turn.transpose() * up)) + kSizeM) * up;
      const Gap gap = tool_gap(p, up, tool);
      ASSERT_TRUE(std::isfinite(gap.distance_m) && gap.by_tool.allFinite()) << i;
      // Where the near side is met it is met, and else stands aside.
      const Eigen::Vector3d met = p + gap.distance_m * up;
      EXPECT_GE(distance_m(tool, met), -1e-12) << i;
      EXPECT_NEAR(gap.by_tool.dot(up), 1.0, 1e-9) << i;
    }
  }
}

// Coordinates of binary32: faces of one plane come apart by more than rounding.
TEST_F(TurnedPolyhedra, ACoarselyRoundedBoxIsStillTheBox) {
  const Eigen::Vector3d sides(0.02, 0.012, 0.016);
  SurfaceMesh box = box_tool(sides).mesh;
  box.position_m.col(2).array() -= 0.5 * sides.z();
  for (int k = 0; k < 10; ++k) {
    const Eigen::Matrix3d turn = random_turn();
    SurfaceMesh rounded = turned(turn, box);
    rounded.position_m = rounded.position_m.cast<float>().cast<double>().eval();
    const ToolSurface surface(mesh_tool("box", rounded));
    for (const Eigen::Vector3d& p : places(rounded)) {
      EXPECT_NEAR(surface.distance(p).distance_m,
                  box_distance_m(turn.transpose() * p, 0.5 * sides), 1e-8)
          << p.transpose();
    }
  }
}

}  // namespace
}  // namespace palpate
