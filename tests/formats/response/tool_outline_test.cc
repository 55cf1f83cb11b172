// Outlines of tools against the heights that the runtime renders with.
#include "formats/response/tool_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/response/tool_support.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

// Largest extent of what turns about z, along a direction of the half plane.
double support_m(const std::vector<OutlinePiece>& pieces, const Eigen::Vector2d& d) {
  double most = -1.0;
  for (const OutlinePiece& piece : pieces) {
    for (const Eigen::Vector2d& p : piece) {
      most = std::max(most, p.dot(d));
    }
  }
  return most;
}

class ToolOutline : public testing::TestWithParam<ToolShape> {};

TEST_P(ToolOutline, TouchesASurfaceWhereTheToolDoes) {
  ToolShape tool = GetParam();
  tool.axis = Eigen::Vector3d::UnitZ();
  const auto pieces = tool_outline_m(tool, 0.1);
  // A polygon lies inside its circle by at most the sagitta of half a step.
  constexpr double kRadius = 0.006;  // largest of a rounding below
  const double sagitta_m = kRadius * (1.0 - std::cos(0.5 * kArcStepRad));
  for (double lean = 0.0; lean <= std::numbers::pi; lean += 0.05) {
    const Eigen::Vector3d outward(std::sin(lean), 0.0, std::cos(lean));
    const double height_m = height_at_touch_m(tool, outward);
    if (!std::isfinite(height_m)) {
      continue;  // where it is endless it is cut off
    }
    EXPECT_LE(support_m(pieces, {std::sin(lean), -std::cos(lean)}), height_m + 1e-15);
    EXPECT_GE(support_m(pieces, {std::sin(lean), -std::cos(lean)}),
              height_m - sagitta_m - 1e-15)
        << lean;
  }
}

TEST_P(ToolOutline, IsOneLineFromTheTipToTheTop) {
  const auto pieces = tool_outline_m(GetParam(), 0.1);
  ASSERT_FALSE(pieces.empty());
  EXPECT_EQ(pieces.front().front().x(), 0.0);
  EXPECT_EQ(pieces.back().back().x(), 0.0);
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    EXPECT_LT((pieces[i].front() - pieces[i - 1].back()).norm(), 1e-15) << i;
  }
  for (const OutlinePiece& piece : pieces) {
    for (std::size_t i = 1; i < piece.size(); ++i) {
      EXPECT_GT((piece[i] - piece[i - 1]).norm(), 0.0);  // else it has no normal
      EXPECT_GE(piece[i].x(), 0.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ToolOutline,
                         testing::Values(sphere(0.006), capsule(0.004, 0.02),
                                         flat_punch(0.005, 0.0),
                                         flat_punch(0.005, 0.001), cone(0.5, 0.0),
                                         cone(0.5, 0.001), cone(1.2, 0.002),
                                         cone(0.5, 0.001, 0.01), cone(0.5, 0.0, 0.01)));

TEST(ToolOutlineOfAMesh, IsEmpty) {
  EXPECT_TRUE(tool_outline_m(box_tool({0.01, 0.01, 0.01}), 0.1).empty());
}

TEST(ToolOutlineOfAnEndlessTool, EndsWhereItIsCutOff) {
  EXPECT_EQ(tool_outline_m(flat_punch(0.005, 0.0), 0.07).back().back().y(), 0.07);
  const auto wide = tool_outline_m(cone(1.4, 0.0), 0.07);
  EXPECT_NEAR(wide.back().front().x(), 0.035, 1e-15);
}

}  // namespace
}  // namespace palpate
