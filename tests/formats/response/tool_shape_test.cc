#include "formats/response/tool_shape.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/convex_mesh.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

const ToolShape kBall{"ball", "sphere", 0.005, 0.3, 0.0005};

std::string error_of(const ToolShape& tool) {
  try {
    check(tool);
  } catch (const InputError& error) {
    return error.what();
  }
  return "good";
}

TEST(ToolShape, AGoodToolPasses) {
  EXPECT_EQ(error_of(kBall), "good");
  EXPECT_EQ(error_of({"ball", "sphere", 0.005, 0.0, 0.0}), "good");
}

TEST(ToolShape, ValuesOutOfRangeAreNamed) {
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  for (const double radius_m : {0.0, -0.1, nan, inf}) {
    EXPECT_NE(error_of({"ball", "sphere", radius_m, 0.0, 0.0}).find("radius_m is"),
              std::string::npos);
  }
  for (const double friction : {-0.1, 10.1, nan, inf}) {
    EXPECT_NE(error_of({"ball", "sphere", 0.1, friction, 0.1}).find("friction is"),
              std::string::npos);
  }
  for (const double presliding_m : {-0.1, nan, inf}) {
    EXPECT_NE(error_of({"ball", "sphere", 0.1, 0.1, presliding_m}).find("presliding_m"),
              std::string::npos);
  }
  EXPECT_EQ(
      error_of({"ball", "sphere", 0.1, 0.1, 0.0}),
      "tool \"ball\": friction 0.1 needs presliding_m > 0, the displacement before "
      "sliding");
}

TEST(ToolShape, AnUnknownShapeIsRefusedWithThoseThatThereAre) {
  EXPECT_EQ(error_of({"ball", "egg", 0.1, 0.0, 0.0}),
            "tool \"ball\": shape \"egg\" is not available; available: sphere, "
            "flat-punch, cone, capsule, mesh");
}

TEST(ToolShape, EveryKindHasAGoodTool) {
  EXPECT_EQ(error_of(flat_punch(0.005, 0.0)), "good");
  EXPECT_EQ(error_of(flat_punch(0.005, 0.001)), "good");
  EXPECT_EQ(error_of(cone(0.5, 0.0)), "good");
  EXPECT_EQ(error_of(cone(0.5, 0.001)), "good");
  EXPECT_EQ(error_of(capsule(0.005, 0.02)), "good");
  EXPECT_EQ(error_of(box_tool({0.01, 0.02, 0.03})), "good");
  ToolShape tilted = cone(0.5, 0.0);
  tilted.axis = Eigen::Vector3d(0.6, 0.0, 0.8);
  tilted.sticking = true;
  EXPECT_EQ(error_of(tilted), "good");
}

TEST(ToolShape, ValuesOfOtherKindsOutOfRangeAreNamed) {
  EXPECT_EQ(error_of(flat_punch(0.005, 0.005)),
            "tool \"punch\": edge_radius_m is 0.005, must be zero or more and below "
            "radius_m = 0.005");
  EXPECT_EQ(error_of(flat_punch(0.0, 0.0)),
            "tool \"punch\": radius_m is 0, must be positive and finite");
  EXPECT_EQ(error_of(flat_punch(1e-300, 0.0)),
            "tool \"punch\": radius_m is 1e-300, must be at least 1e-9 m");
  EXPECT_EQ(error_of(cone(0.0, 0.0)),
            "tool \"cone\": half_angle_rad is 0, must be above 0 and below pi/2");
  EXPECT_NE(error_of(cone(1.6, 0.0)).find("half_angle_rad is 1.6"), std::string::npos);
  EXPECT_NE(error_of(cone(0.5, -1.0)).find("tip_radius_m is -1"), std::string::npos);
  EXPECT_NE(error_of(cone(0.5, std::nan(""))).find("tip_radius_m is nan"),
            std::string::npos);
  EXPECT_EQ(error_of(capsule(0.005, 0.0)),
            "tool \"capsule\": length_m is 0, must be positive and finite");
  ToolShape turned = kBall;
  turned.axis = Eigen::Vector3d(0.0, 0.0, 2.0);
  EXPECT_EQ(error_of(turned),
            "tool \"ball\": axis has the length 2, must be a unit vector");
}

TEST(ToolShape, ALengthThatTheKindDoesNotHaveIsRefused) {
  ToolShape ball = kBall;
  ball.half_angle_rad = 0.5;
  EXPECT_EQ(error_of(ball),
            "tool \"ball\": half_angle_rad is 0.5, but a sphere has none");
  ToolShape pointed = cone(0.5, 0.0);
  pointed.radius_m = 0.01;
  EXPECT_EQ(error_of(pointed), "tool \"cone\": radius_m is 0.01, but a cone has none");
  ball = kBall;
  ball.mesh = box_tool({1, 1, 1}).mesh;
  EXPECT_EQ(error_of(ball), "tool \"ball\": a sphere has no mesh of its own");
}

TEST(ToolShape, AMeshMustBeClosedConvexAndOutsideOut) {
  const ToolShape box = box_tool({0.01, 0.02, 0.03});
  ToolShape dented = box;
  dented.mesh.position_m.row(7) *= 0.6;
  EXPECT_NE(error_of(dented).find("the mesh is not convex: a vertex stands"),
            std::string::npos)
      << error_of(dented);
  ToolShape open = box;
  open.mesh.triangle.conservativeResize(11, 3);
  EXPECT_EQ(error_of(open), "tool \"box\": the mesh is open, must be closed");
  ToolShape turned = box;
  turned.mesh.triangle.col(1).swap(turned.mesh.triangle.col(2));
  EXPECT_NE(error_of(turned).find("must be a body, outside out"), std::string::npos);
  ToolShape foreign = box;
  foreign.mesh.triangle(3, 1) = 8;
  EXPECT_NE(error_of(foreign).find("triangle with vertex 8, must lie in [0, 8)"),
            std::string::npos);
  ToolShape empty = box;
  empty.mesh = {};
  EXPECT_NE(error_of(empty).find("0 triangles, must have 4"), std::string::npos);
  EXPECT_NEAR(convexity_defect_m(box.mesh), 0.0, 1e-18);
  // The corner's faces turn about their far edges: the largest height is that of a
  // corner beside, some way below the dent's own 0.4 of the corner's distance.
  EXPECT_GT(convexity_defect_m(dented.mesh), 1e-3);
}

TEST(ToolShape, IsDescribedInAFewWords) {
  EXPECT_EQ(describe(kBall), "sphere of radius 5 mm");
  EXPECT_EQ(describe(flat_punch(0.005, 0.0)), "flat-punch of radius 5 mm");
  ToolShape pointed = cone(0.5235987755982988, 0.0001);
  pointed.axis = Eigen::Vector3d::UnitZ();
  pointed.sticking = true;
  EXPECT_EQ(describe(pointed),
            "cone of half-angle 30 deg, tip radius 0.1 mm, axis (0, 0, 1), sticking");
  EXPECT_EQ(describe(box_tool({1, 1, 1})), "mesh of 12 triangles");
}

TEST(ToolShape, ANameMustFitAFileAndACommandLine) {
  for (const char* name : {"", "a b", "a/b", ".", "a\nb"}) {
    EXPECT_NE(error_of({name, "sphere", 0.1, 0.0, 0.0}).find("cannot be used"),
              std::string::npos)
        << name;
  }
  EXPECT_NE(
      error_of({std::string(65, 'a'), "sphere", 0.1, 0.0, 0.0}).find("cannot be used"),
      std::string::npos);
  EXPECT_EQ(error_of({"bölli-2.1", "sphere", 0.1, 0.0, 0.0}), "good");
}

}  // namespace
}  // namespace palpate
