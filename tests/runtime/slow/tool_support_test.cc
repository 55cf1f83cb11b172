#include "formats/response/tool_support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/fast/fast_step.h"
#include "runtime/slow/memory_elements.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kTiny = 1e-15;  // rounding of lengths of some millimetres

// A normal that leans away from +z by that angle.
Eigen::Vector3d leaning(double angle_rad, double about_rad = 0.4) {
  return {std::sin(angle_rad) * std::cos(about_rad),
          std::sin(angle_rad) * std::sin(about_rad), std::cos(angle_rad)};
}

ToolShape standing(ToolShape tool) {
  tool.axis = Eigen::Vector3d::UnitZ();
  return tool;
}

TEST(ToolHeight, OfASphereIsItsRadiusOverEverySurface) {
  for (const double angle : {0.0, 1.0, 3.0}) {
    EXPECT_EQ(height_at_touch_m(standing(sphere(0.004)), leaning(angle)), 0.004);
  }
  EXPECT_EQ(nominal_height_m(sphere(0.004)), 0.004);
}

TEST(ToolHeight, OfAToolThatStandsAlongTheNormalIsTheSameEverywhere) {
  for (const double angle : {0.0, 1.0, 3.0}) {
    EXPECT_NEAR(height_at_touch_m(flat_punch(0.004, 0.001), leaning(angle)), 0.0,
                kTiny);
    EXPECT_NEAR(height_at_touch_m(cone(0.5, 0.001), leaning(angle)), 0.0, kTiny);
    EXPECT_NEAR(height_at_touch_m(capsule(0.003, 0.02), leaning(angle)), 0.003, kTiny);
  }
  EXPECT_NEAR(nominal_height_m(flat_punch(0.004, 0.001)), 0.0, kTiny);
  EXPECT_EQ(nominal_height_m(capsule(0.003, 0.02)), 0.003);
}

TEST(ToolHeight, OfALeaningPunchIsThatOfTheRimItTouchesWith) {
  const double angle = 0.3;
  // Centre of the rim's rounding at (R - e, e), the ball of radius e around it.
  EXPECT_NEAR(height_at_touch_m(standing(flat_punch(0.004, 0.001)), leaning(angle)),
              0.003 * std::sin(angle) - 0.001 * std::cos(angle) + 0.001, kTiny);
}

TEST(ToolHeight, OfALeaningConeIsItsTipUntilTheFlankLiesFlat) {
  const double half_angle = 0.5;
  const double flat = 0.5 * std::numbers::pi - half_angle;
  const ToolShape endless = standing(cone(half_angle, 0.0));
  EXPECT_NEAR(height_at_touch_m(endless, leaning(flat - 0.01)), 0.0, kTiny);
  EXPECT_EQ(height_at_touch_m(endless, leaning(flat + 0.01)),
            std::numeric_limits<double>::infinity());
  const ToolShape ended = standing(cone(half_angle, 0.0, 0.01));
  // The rim, at (h tan a, h) from the tip.
  EXPECT_NEAR(
      height_at_touch_m(ended, leaning(flat + 0.2)),
      0.01 * std::tan(half_angle) * std::sin(flat + 0.2) - 0.01 * std::cos(flat + 0.2),
      kTiny);
}

TEST(ToolHeight, OfAMeshIsThatOfItsLowestVertexUnderAnyAxis) {
  ToolShape box = box_tool({0.004, 0.006, 0.02});
  box.axis = leaning(0.7, 2.0);
  const Eigen::Vector3d n = leaning(0.4, -1.0);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *box.axis);
  double lowest = std::numeric_limits<double>::infinity();
  for (Eigen::Index v = 0; v < box.mesh.position_m.rows(); ++v) {
    lowest = std::min(lowest, n.dot(turn * box.mesh.position_m.row(v).transpose()));
  }
  EXPECT_NEAR(height_at_touch_m(box, n), -lowest, kTiny);
}

// Force along the normal of a node, of a tool that comes down along it by depth_m.
double rendered_n(const ResponseDatabase& database, Eigen::Index node, double depth_m,
                  LocalModel model) {
  const ToolShape& tool = database.tools[0].tool;
  ElementStream stream(database, database.tools[0]);
  const auto state = std::make_unique<FastState>();
  state->config.model = model;
  state->config.tool_radius_m = nominal_height_m(tool);
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  const auto fifo = std::make_unique<ElementFifo>();
  const Eigen::Vector3d n = database.normal.row(node).transpose();
  const Eigen::Vector3d v = database.body.position_m.row(node).transpose();
  double force_n = 0.0;
  constexpr int kSteps = 60;
  for (int i = 0; i <= kSteps; ++i) {
    const double depth = -0.001 + (depth_m + 0.001) * i / kSteps;
    const Eigen::Vector3d x = v + (height_at_touch_m(tool, n) - depth) * n;
    const FastContact at = contact(*state);
    (void)stream.update({.sequence = static_cast<std::uint64_t>(i + 1),
                         .time_ns = 0,
                         .position_m = x,
                         .triangle = at.triangle,
                         .in_contact = at.in_contact},
                        0, *fifo);
    while (const Element* element = fifo->front()) {
      accept(*state, *element);
      fifo->pop();
    }
    force_n = step(*state, {x, 0}, 0.0005).force_n.dot(n);
  }
  EXPECT_EQ(state->safety.fault, Fault::kNone);
  return force_n;
}

TEST(ToolHeight, EveryToolRendersTheCurveOfTheNodeThatItPresses) {
  for (ToolShape tool : {sphere(0.004), flat_punch(0.004, 0.001), cone(0.4, 0.001),
                         capsule(0.003, 0.02), box_tool({0.004, 0.006, 0.02})}) {
    tool.name = tool.kind;
    for (const bool stands : {false, true}) {
      const ResponseDatabase database = sample_database(
          sphere_surface(0.05, 2), stands ? standing(tool) : tool,
          [](Eigen::Index, double d) {
            return 400.0 * d;
          },
          0.006);
      for (Eigen::Index node = 0; node < database.body.position_m.rows(); node += 7) {
        if (database.normal(node, 2) < 0.9) {
          continue;  // out of reach of a tool that stands upright
        }
        for (const LocalModel model : {LocalModel::kElement, LocalModel::kPotential}) {
          // The field's coordinates are found to 1e-14 of an edge and curves are
          // linear; the element model follows its contact point by one step a tick.
          const double tolerance = model == LocalModel::kPotential ? 1e-6 : 0.03;
          EXPECT_NEAR(rendered_n(database, node, 0.003, model), 1.2, tolerance)
              << tool.kind << " at node " << node << ", " << name(model);
        }
      }
    }
  }
}

TEST(ToolHeight, NamesAnEndlessToolThatLiesBelowItsTip) {
  ToolShape tool = cone(0.5, 0.0);
  tool.name = "needle";
  tool.axis = -Eigen::Vector3d::UnitZ();
  const ResponseDatabase database = sample_database(
      plate(0.1, 2), tool,
      [](Eigen::Index, double d) {
        return 400.0 * d;
      },
      0.006);
  const ElementStream stream(database, database.tools[0]);
  try {
    (void)stream.element(0);
    FAIL() << "no exception";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("needle"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate
