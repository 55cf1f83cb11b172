// The live view's page with tools of one contact (tests/support/view_page.h).
#include "tests/support/view_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/database/response_database.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kStiffness = 200.0;   // [N/m] of every node, without friction
constexpr double kBallRadius = 0.008;  // [m] of the ball

ResponseDatabase pressed_plate(const ToolShape& tool) {
  return sample_database(
      plate(0.1, 20), tool,
      [](Eigen::Index, double d) {
        return kStiffness * d;
      },
      0.01);
}

TEST(ViewPage, PressesByMouseAndByKeysAndShowsTheRuntimesNumbers) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const nlohmann::json seen =
      seen_on_page(pressed_plate(ball(kBallRadius, 0.0, 0.0)), "");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], nlohmann::json::array());
  EXPECT_EQ(seen["watcher"], "watcher");
  EXPECT_EQ(seen["refusal"], "another page steers, this one watches");
  EXPECT_EQ(seen["address"].get<std::string>().find('#'), std::string::npos);
  EXPECT_NE(seen["without_token"].get<std::string>().find("token"), std::string::npos);

  // What stands on the page is what the runtime said to another page, rounded.
  const nlohmann::json& paused = seen["paused"];
  const double force_n = norm(paused["force_n"]);
  EXPECT_EQ(paused["shown_force_n"], fmt::format("{:.3f}", force_n));
  EXPECT_EQ(paused["shown_depth_mm"],
            fmt::format("{:.2f}", 1e3 * paused["depth_m"].get<double>()));
  EXPECT_EQ(paused["shown_energy_mj"],
            fmt::format("{:.3f}", 1e3 * paused["stored_j"].get<double>()));
  // And it is the body's response.
  EXPECT_NEAR(force_n, kStiffness * paused["depth_m"].get<double>(), 1e-3 * force_n);
  EXPECT_EQ(paused["fault"], "none");

  EXPECT_GT(seen["deeper_force_n"], seen["mouse_force_n"]);
  EXPECT_EQ(norm(seen["released_force_n"]), 0.0);
  EXPECT_GT(seen["keys_force_n"], 0.01);
  EXPECT_NE(seen["curve"].get<std::string>().find("slope 200 N/m"), std::string::npos)
      << seen["curve"];
  EXPECT_EQ(seen["exit_code"], 0);
}

// The page begins at the corner x = y = -0.05 m of the plate.
constexpr double kFieldsToM = -0.044;

// Fields of the plate's first two rows of nodes: mixtures of three waves, 2 mm high.
ResponseDatabase plate_with_fields() {
  ResponseDatabase database = pressed_plate(ball(kBallRadius, 0.0, 0.0));
  const Points& position = database.body.position_m;
  DisplacementField& field = database.tools[0].displacement;
  field.basis.resize(3 * position.rows(), 3);
  std::vector<std::array<float, 3>> rows;
  for (Eigen::Index i = 0; i < position.rows(); ++i) {
    const double x = 60.0 * position(i, 0), y = 60.0 * position(i, 1);
    field.basis.middleRows(3 * i, 3) =
        (Eigen::Matrix3d() << std::sin(x), 0.3, std::cos(y), std::cos(x + y), 0.5,
         std::sin(y), -1.0, std::sin(x - y), -0.7)
            .finished()
            .cast<float>();
    if (position(i, 0) < kFieldsToM) {
      field.node.push_back(static_cast<std::int32_t>(i));
      field.depth_m.push_back(0.004 + 1e-5 * static_cast<double>(i));
      rows.push_back({0.002F, static_cast<float>(1e-3 * std::sin(x)),
                      static_cast<float>(1e-3 * std::cos(y))});
    }
  }
  field.error_relative.assign(rows.size(), 0.0);
  field.coefficient.resize(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t j = 0; j < rows.size(); ++j) {
    field.coefficient.row(static_cast<Eigen::Index>(j)) << rows[j][0], rows[j][1],
        rows[j][2];
  }
  return database;
}

// How a vertex is drawn to have moved.
Eigen::Vector3d moved_m(const nlohmann::json& drawn, std::size_t vertex) {
  const nlohmann::json& all = drawn.at("moved_m");
  return {all.at(3 * vertex).get<double>(), all.at(3 * vertex + 1).get<double>(),
          all.at(3 * vertex + 2).get<double>()};
}

// (3 n) [m] the stored fields of a contact's nodes, each with its share, and how much
// all shares of nodes with a field are.
std::pair<Eigen::VectorXd, double> stored_m(const DisplacementField& field,
                                            const nlohmann::json& drawn) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(field.basis.rows());
  double shares = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = std::find(field.node.begin(), field.node.end(),
                              drawn["nodes"][k].get<std::int32_t>());
    if (at != field.node.end()) {
      const auto j = at - field.node.begin();
      const double share = drawn["shares"][k].get<double>();
      shares += share;
      sum += share * drawn["penetration_m"].get<double>() /
             field.depth_m[static_cast<std::size_t>(j)] *
             (field.basis * field.coefficient.row(j).transpose()).cast<double>();
    }
  }
  return {sum, shares};
}

bool says(const nlohmann::json& drawn, const std::string& part) {
  return drawn["label"].get<std::string>().find(part) != std::string::npos;
}

TEST(ViewPage, TheSurfaceMovesByTheStoredDisplacementAndElseByATemplate) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const ResponseDatabase database = plate_with_fields();
  const nlohmann::json seen = seen_on_page(database, "--dimple");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], nlohmann::json::array());
  const DisplacementField& field = database.tools[0].displacement;
  // Steps of int16 of 4 mm at most, and singles of a plate of 0.1 m.
  constexpr double kDigitsM = 4e-3 / 32767 + 2e-8;
  constexpr std::size_t kMiddle = 1;
  for (std::size_t place = 0; place < 3; ++place) {
    const nlohmann::json& drawn = seen["dimples"][place];
    const auto [expected_m, shares] = stored_m(field, drawn);
    const Eigen::Vector3d contact_m(drawn["contact_m"][0], drawn["contact_m"][1], 0.0);
    const double depth_m = drawn["penetration_m"];
    ASSERT_GT(depth_m, 0.001);
    double moved = 0.0;
    for (Eigen::Index i = 0; i < database.body.position_m.rows(); ++i) {
      // The template acts along the normal, z: near the axis of a ball as a parabola.
      const Eigen::Vector3d rest_m = database.body.position_m.row(i).transpose();
      const double r = (rest_m - contact_m).norm();
      Eigen::Vector3d at_m = expected_m.segment<3>(3 * i);
      at_m.z() -= (1.0 - shares) * (depth_m - r * r / (2.0 * kBallRadius));
      Eigen::Vector3d off_m = moved_m(drawn, static_cast<std::size_t>(i)) - at_m;
      if (shares < 1.0 - 1e-6 && r > std::sqrt(kBallRadius * depth_m)) {
        off_m.z() = 0.0;
      }
      EXPECT_LT(off_m.cwiseAbs().maxCoeff(), kDigitsM) << place << " " << i;
      moved = std::max(moved, at_m.norm());
    }
    EXPECT_GT(moved, 1e-3);
    EXPECT_EQ(says(drawn, "computed displacement"), place <= kMiddle) << drawn["label"];
    EXPECT_EQ(says(drawn, "template"), place >= kMiddle) << drawn["label"];
    EXPECT_NEAR(drawn["lowest_m"].get<double>(),
                drawn["tool_m"][2].get<double>() - kBallRadius, 1e-6);
  }
}

// The lowest point of the drawn tool is as far below its pose as its height at touch,
// which ends its way into the plate.
void expect_drawn_standing(const ToolShape& tool, double height_m) {
  const nlohmann::json seen = seen_on_page(pressed_plate(tool), "--standing");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], nlohmann::json::array());
  ASSERT_EQ(seen["dimples"].size(), 1U);
  for (const nlohmann::json& drawn : seen["dimples"]) {
    const double tool_m = drawn["tool_m"][2];
    // Drawn with 64 sides, roundings of 1 mm as polygons of steps of 0.06 rad.
    EXPECT_NEAR(drawn["lowest_m"].get<double>(), tool_m - height_m, 1e-5);
    EXPECT_NEAR(drawn["penetration_m"].get<double>(), height_m - tool_m, 1e-12);
    EXPECT_NEAR(drawn["depth_m"].get<double>(), height_m - tool_m, 1e-12);
    EXPECT_TRUE(says(drawn, "template")) << drawn["label"];
  }
}

TEST(ViewPage, AConeThatLiesOnTheUpperEndOfItsFlankIsDrawnSo) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  constexpr double kHalfAngle = 0.5, kTip = 0.001, kLength = 0.02;
  ToolShape tool = cone(kHalfAngle, kTip, kLength);
  tool.axis = Eigen::Vector3d(0.96, 0.0, 0.28);
  expect_drawn_standing(
      tool, kTip * (1.0 - 0.28) + kLength * (std::tan(kHalfAngle) * 0.96 - 0.28));
}

TEST(ViewPage, AMeshThatStandsOnItsEdgeIsDrawnSo) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  ToolShape tool = box_tool({0.01, 0.012, 0.008});
  tool.axis = Eigen::Vector3d(0.6, 0.0, 0.8);
  expect_drawn_standing(tool, 0.5 * 0.01 * 0.6);
}

TEST(ViewPage, WithoutWebGlNumbersAndKeysRemain) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const nlohmann::json seen =
      seen_on_page(pressed_plate(ball(kBallRadius, 0.0, 0.0)), "--no-3d");
  ASSERT_TRUE(seen.is_object());
  EXPECT_TRUE(seen["no_webgl"]);
  EXPECT_GT(seen["keys_force_n"], 0.01);
}

}  // namespace
}  // namespace palpate
