// The live view's page with several contacts and two hands (tests/support/view_page.h).
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/padded_plate.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/view_page.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

Eigen::Vector3d vector(const Json& v) {
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
}

Eigen::Quaterniond quaternion(const Json& q) {
  return {q.at(3).get<double>(), q.at(0).get<double>(), q.at(1).get<double>(),
          q.at(2).get<double>()};
}

// Spheres stand where the pose puts them, and arrows are as long as what they show.
void expect_drawn(const Json& seen, std::size_t hand, const ToolShape& tool) {
  const Json& state = seen["state"];
  const Json& said = state["hands"][hand];
  const Json& drawn = seen["drawn"][hand];
  const Eigen::Vector3d at = vector(said["tool_m"]);
  const auto expect_at = [](const Json& point, const Eigen::Vector3d& wanted) {
    EXPECT_LT((vector(point) - wanted).norm(), kDrawnM) << point;
  };
  const auto count = static_cast<std::size_t>(tool.contact.point_m.rows());
  ASSERT_EQ(drawn["spheres"].size(), std::max<std::size_t>(1, count));
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d centre =
        tool.contact.point_m.row(static_cast<Eigen::Index>(i)).transpose();
    expect_at(drawn["spheres"][i], at + quaternion(said["turn"]) * centre);
  }
  const double per_n = seen["metres_per_n"];
  expect_at(drawn["force"], at + per_n * vector(said["force_n"]));
  expect_at(drawn["other"],
            at + per_n * vector(said[state["coupled"] ? "added_up_n" : "coupled_n"]));
  if (count > 1) {
    const Eigen::Vector3d torque = vector(said["torque_n_m"]);
    expect_at(drawn["torque"], at + seen["metres_per_n_m"].get<double>() * torque);
    std::size_t thin = 0;
    for (const Json& contact : state["contacts"]) {
      if (contact["hand"] == hand && norm(contact["force_n"]) > 1e-3) {
        ASSERT_LT(thin, drawn["thin"].size());
        expect_at(drawn["thin"][thin++],
                  vector(contact["centre_m"]) + per_n * vector(contact["force_n"]));
      }
    }
    EXPECT_GE(thin, 2U);
  }
}

// Of all hands, sizes added.
double sum_n(const Json& seen, const char* key) {
  double sum = 0.0;
  for (const Json& hand : seen["state"]["hands"]) {
    sum += norm(hand[key]);
  }
  return sum;
}

void expect_numbers(const Json& seen) {
  const Json& hands = seen["state"]["hands"];
  EXPECT_EQ(seen["force"], fmt::format("{:.3f}", norm(hands[0]["force_n"])));
  EXPECT_EQ(seen["coupled"], fmt::format("{:.3f}", sum_n(seen, "coupled_n")));
  EXPECT_EQ(seen["added"], fmt::format("{:.3f}", sum_n(seen, "added_up_n")));
  if (hands.size() > 1) {
    EXPECT_EQ(seen["force2"], fmt::format("{:.3f}", norm(hands[1]["force_n"])));
  }
}

// Pressing any node by kFieldM lowers the whole plate by half of that.
constexpr double kFieldM = 0.004;

ResponseDatabase padded_plate_with_fields() {
  ResponseDatabase database = padded_plate(3);
  const Eigen::Index nodes = database.body.position_m.rows();
  DisplacementField& field = database.tools[1].displacement;
  field.basis = RowsOf<float>::Zero(3 * nodes, 1);
  for (Eigen::Index i = 0; i < nodes; ++i) {
    field.basis(3 * i + 2, 0) = -1.0F;
    field.node.push_back(static_cast<std::int32_t>(i));
  }
  field.depth_m.assign(static_cast<std::size_t>(nodes), kFieldM);
  field.error_relative.assign(static_cast<std::size_t>(nodes), 0.0);
  field.coefficient =
      RowsOf<float>::Constant(nodes, 1, static_cast<float>(0.5 * kFieldM));
  return database;
}

// The fields of all contacts, each by what its own force sinks the body.
void expect_lowered(const Json& seen) {
  double own_m = 0.0;
  for (const Json& contact : seen["state"]["contacts"]) {
    own_m += std::max(0.0, contact["own_m"].get<double>());
  }
  EXPECT_GT(own_m, 0.003);
  EXPECT_NEAR(seen["lowered_m"].get<double>(), 0.5 * own_m, kDrawnM);
  EXPECT_NE(seen["label"].get<std::string>().find("computed displacement"),
            std::string::npos)
      << seen["label"];
}

TEST(ViewHandsPage, DrawsAToolOfSeveralContactsInItsPoseAndUncouplesIt) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const Json seen = seen_on_page(padded_plate_with_fields(), "--contacts");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], Json::array());
  EXPECT_EQ(seen["exit_code"], 0);
  for (const char* when : {"flat", "turned", "uncoupled", "again"}) {
    SCOPED_TRACE(when);
    expect_drawn(seen[when], 0, pads(3));
    expect_numbers(seen[when]);
    EXPECT_EQ(seen[when]["state"]["fault"], "none");
    EXPECT_FALSE(seen[when]["hands"]);
    expect_lowered(seen[when]);
    EXPECT_GE(seen[when]["state"]["net_j"].get<double>(), -1e-12);
  }
  // Keys and dragging have turned and tilted it.
  const Eigen::Quaterniond upright =
      quaternion(seen["flat"]["state"]["hands"][0]["turn"]);
  const Eigen::Quaterniond turned =
      quaternion(seen["turned"]["state"]["hands"][0]["turn"]);
  EXPECT_GT(upright.angularDistance(turned), 0.3);
  EXPECT_GT(norm(seen["turned"]["state"]["hands"][0]["torque_n_m"]), 1e-4);
  EXPECT_EQ(seen["flat"]["error"], "its error has not been measured");
  // As soon as it has been lifted, it is what adding up gives.
  EXPECT_TRUE(seen["flat"]["switched"]);
  EXPECT_FALSE(seen["uncoupled"]["switched"]);
  EXPECT_EQ(seen["uncoupled"]["other"], "what coupled contacts give");
  const Json& again = seen["again"]["state"]["hands"][0];
  EXPECT_NEAR(vector(again["force_n"]).z(), vector(again["added_up_n"]).z(),
              1e-3 * norm(again["force_n"]));
  EXPECT_GT(norm(again["added_up_n"]), 1.1 * norm(again["coupled_n"]));
  EXPECT_GT(norm(again["force_n"]),
            1.05 * norm(seen["flat"]["state"]["hands"][0]["force_n"]));
}

TEST(ViewHandsPage, PinchesWithTwoHandsAndMovesEachByItself) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const Json seen = seen_on_page(padded_plate(3), "--pinch");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], Json::array());
  const std::array<ToolShape, 2> tools{ball(kPadRadius, 0.3, 2e-3), pads(3)};
  for (const char* when : {"both", "opened", "first_alone", "by_mouse", "released"}) {
    SCOPED_TRACE(when);
    expect_drawn(seen[when], 0, tools[0]);
    expect_numbers(seen[when]);
    EXPECT_TRUE(seen[when]["hands"]);
    EXPECT_EQ(seen[when]["state"]["fault"], "none");
  }
  expect_drawn(seen["both"], 1, tools[1]);
  EXPECT_NE(seen["both"]["tool"].get<std::string>().find("ball"), std::string::npos);
  EXPECT_NE(seen["both"]["tool"].get<std::string>().find("pads"), std::string::npos);
  const auto force_n = [&](const char* when, std::size_t hand) {
    return norm(seen[when]["state"]["hands"][hand]["force_n"]);
  };
  const auto apart_m = [&](const char* when) {
    const Json& hands = seen[when]["state"]["hands"];
    return (vector(hands[0]["tool_m"]) - vector(hands[1]["tool_m"])).norm();
  };
  EXPECT_GT(apart_m("opened"), apart_m("both") + 0.003);
  EXPECT_GT(sum_n(seen["both"], "added_up_n"), 1.05 * sum_n(seen["both"], "coupled_n"));
  EXPECT_EQ(force_n("first_alone", 1), 0.0);
  EXPECT_GT(force_n("first_alone", 0), 1.005 * force_n("opened", 0));
  // The first holds on while the mouse moves the second, and when it lets go.
  EXPECT_TRUE(seen["by_mouse"]["state"]["hands"][1]["holding"]);
  EXPECT_GT(force_n("by_mouse", 1), 0.01);
  EXPECT_GT(force_n("released", 0), 0.01);
  EXPECT_FALSE(seen["released"]["state"]["hands"][1]["holding"]);
}

}  // namespace
}  // namespace palpate
