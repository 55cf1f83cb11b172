// The live view's page with a needle (tests/support/view_page.h).
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/layered_plate.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/view_page.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

void expect_near(const Json& at, const Json& from, const Json& axis, double depth_m) {
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(at.at(k).get<double>(),
                from.at(k).get<double>() - depth_m * axis.at(k).get<double>(), kDrawnM);
  }
}

// The channel's tubes end where layers do, the last one where the channel does; marks
// stand where membranes broke.
void expect_channel(const Json& seen) {
  const Json& channel = seen["state"]["needle"]["channels"].at(0);
  const Json& begins = channel["layers_m"];
  ASSERT_EQ(seen["tubes"].size(), 1U);
  const Json& ends = seen["tubes"][0];
  ASSERT_GE(ends.size(), 1U);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    expect_near(ends[k], channel["entry_m"], channel["axis"],
                k + 1 < ends.size() ? begins.at(k + 1).get<double>()
                                    : channel["depth_m"].get<double>());
  }
  const Json& marks = seen["marks"];
  ASSERT_EQ(marks.size(), channel["broke_n"].size());
  for (std::size_t k = 0; k < marks.size(); ++k) {
    EXPECT_EQ(marks[k]["force_n"], channel["broke_n"][k]);
    EXPECT_NEAR(marks[k]["depth_mm"].get<double>(),
                1e3 * channel["broke_m"][k].get<double>(), 1e-9);
  }
  EXPECT_NEAR(marks[0]["force_n"].get<double>(), kLayerSkinN, 0.05 * kLayerSkinN);
  EXPECT_EQ(seen["rupture"],
            fmt::format("{:.3f}", channel["broke_n"].back().get<double>()));
  EXPECT_EQ(seen["membranes"], std::to_string(marks.size()));
}

TEST(ViewNeedlePage, ANeedleIsPushedInPulledOutAndFindsItsChannel) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const Json seen = seen_on_page(layered_plate(), "--needle");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], Json::array());
  EXPECT_EQ(seen["exit_code"], 0);
  EXPECT_EQ(seen["before"]["tubes"], Json::array());
  EXPECT_EQ(seen["before"]["membranes"], "0");
  EXPECT_TRUE(seen["before"]["plotted"]);
  EXPECT_FALSE(seen["before"]["rubs"]);  // the tool has no friction

  const Json& in = seen["inserted"];
  expect_channel(in);
  const Json& channel = in["state"]["needle"]["channels"][0];
  const double depth_m = in["state"]["depth_m"];
  EXPECT_GT(depth_m, 0.005);  // beyond the skin
  EXPECT_EQ(in["depth"], fmt::format("{:.2f}", 1e3 * depth_m));
  expect_near(in["tip"], channel["entry_m"], channel["axis"], depth_m);
  EXPECT_GE(in["deepest_mm"].get<double>(), 1e3 * depth_m - 0.1);

  const Json& out = seen["withdrawn"];
  expect_channel(out);
  EXPECT_EQ(out["state"]["fault"], "none");
  EXPECT_TRUE(out["tip"].is_null());
  EXPECT_EQ(out["state"]["needle"]["channels"], in["state"]["needle"]["channels"]);
  EXPECT_EQ(out["layer"], "· 1 channel");

  // By the mouse, near the entry: no membrane breaks a second time.
  expect_channel(seen["again"]);
  EXPECT_GT(seen["again"]["state"]["depth_m"].get<double>(), 0.003);
  EXPECT_GT(seen["again"]["points"].size(), 1U);
  EXPECT_EQ(seen["reset"]["tubes"], Json::array());
  EXPECT_EQ(seen["reset"]["marks"], Json::array());
  EXPECT_EQ(seen["reset"]["points"], Json::array());
}

}  // namespace
}  // namespace palpate
