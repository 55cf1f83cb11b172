// The live view's page with a contact that sticks and slips
// (tests/support/view_page.h).
#include <algorithm>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/quiet_exit.h"
#include "tests/support/rubbing_plate.h"
#include "tests/support/view_page.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

// Where the spring is drawn, and its numbers.
void expect_spring(const Json& seen) {
  const Json& friction = seen["state"]["friction"];
  for (std::size_t k = 0; k < 3; ++k) {
    const double foot_m = seen["state"]["contact_m"][k].get<double>() -
                          seen["state"]["penetration_m"].get<double>() *
                              seen["state"]["normal"][k].get<double>();
    EXPECT_NEAR(seen["foot"][k].get<double>(), foot_m, kDrawnM);
    EXPECT_NEAR(seen["anchor"][k].get<double>(),
                foot_m - friction["stretch_m"][k].get<double>(), kDrawnM);
  }
  EXPECT_EQ(seen["mm"], fmt::format("{:.2f}", 1e3 * norm(friction["stretch_m"])));
  EXPECT_EQ(seen["newton"], fmt::format("{:.3f}", norm(friction["force_n"])));
}

// The surface under the tool goes with it: the vertex nearest to the anchor by nearly
// all of the stretch, the body's edge by little.
void expect_shear(const Json& seen, const ResponseDatabase& database) {
  const Json& friction = seen["state"]["friction"];
  const Json& anchor = friction["anchor"];
  const auto best = static_cast<std::size_t>(
      std::max_element(anchor["shares"].begin(), anchor["shares"].end()) -
      anchor["shares"].begin());
  const auto node = anchor["nodes"][best].get<std::size_t>();
  double along = 0.0;
  double least = 1.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(database.body.position_m.rows());
       ++i) {
    double part = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      part += seen["moved_m"][3 * i + k].get<double>() *
              friction["stretch_m"][k].get<double>();
    }
    part /= std::pow(norm(friction["stretch_m"]), 2);
    along = i == node ? part : along;
    least = std::min(least, part);
  }
  EXPECT_NEAR(along, 1.0, 0.02);
  EXPECT_NEAR(least, 0.0, 0.02);
}

// Of points that follow each other: on the slope of the spring, or at the limit. At the
// end the hand has swung back a little from the limit of the side.
void expect_loop(const Json& loop, double limit_n, double side) {
  const double n_per_mm = 1e-3 * kRubShare * kRubNPerM;
  int sticks = 0, slips = 0;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const double from_n = loop[i - 1][1], to_n = loop[i][1];
    EXPECT_LE(std::abs(to_n), 1.02 * limit_n);
    slips += side * to_n > 0.98 * limit_n ? 1 : 0;
    if (std::max(std::abs(from_n), std::abs(to_n)) < 0.9 * limit_n) {
      ++sticks;
      const double way_mm = loop[i][0].get<double>() - loop[i - 1][0].get<double>();
      EXPECT_NEAR(to_n - from_n, n_per_mm * way_mm, 0.001 * limit_n);
    }
  }
  EXPECT_GT(sticks, 20);
  EXPECT_GT(slips, 20);
  EXPECT_GT(side * loop.back()[1].get<double>(), 0.5 * limit_n);
}

TEST(ViewFrictionPage, AContactSticksBeforeItSlipsAndTheLoopIsPlotted) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const ResponseDatabase database = rubbing_plate();
  const Json seen = seen_on_page(database, "--friction");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], Json::array());
  EXPECT_EQ(seen["exit_code"], 0);
  EXPECT_TRUE(seen["above"]["plotted"]);
  EXPECT_EQ(seen["above"]["rubs"], "–");
  EXPECT_TRUE(seen["above"]["anchor"].is_null());

  const Json& sticks = seen["sticks"];
  const Json& friction = sticks["state"]["friction"];
  const double share = norm(friction["force_n"]) / friction["limit_n"].get<double>();
  EXPECT_EQ(friction["state"], "sticks");
  EXPECT_LT(share, 0.9);
  EXPECT_EQ(sticks["rubs"], fmt::format("sticks, {:.2f} of the limit", share));
  expect_spring(sticks);
  expect_shear(sticks, database);
  // The anchor stays where the tool came down.
  EXPECT_LT(std::abs(friction["anchor"]["point_m"][0].get<double>() -
                     seen["pressed"]["state"]["contact_m"][0].get<double>()),
            1e-4);

  const Json& slips = seen["slips"];
  expect_spring(slips);
  const double limit_n = slips["state"]["friction"]["limit_n"];
  ASSERT_EQ(seen["loops"].size(), 3U);
  const double right = slips["axis"][0].get<double>() > 0.0 ? 1.0 : -1.0;
  expect_loop(seen["loops"][0], limit_n, right);
  expect_loop(seen["loops"][1], limit_n, -right);
  expect_loop(seen["loops"][2], limit_n, right);
  EXPECT_TRUE(seen["lifted"]["anchor"].is_null());
  EXPECT_EQ(seen["lifted"]["rubs"], "–");
}

}  // namespace
}  // namespace palpate
