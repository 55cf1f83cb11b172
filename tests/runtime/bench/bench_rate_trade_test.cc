#include "runtime/bench/bench_rate_trade.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

RateTradeOptions one_device(std::size_t device, LocalModel model, WallShape wall) {
  RateTradeOptions options;
  options.devices = {trade_devices()[device]};
  options.models = {model};
  options.walls = {wall};
  options.fast_hz = {2000};
  options.slow_hz = {10, 100};
  return options;
}

TEST(Trade, SurfaceModelsDoNotCareAboutTheSlowRate) {
  for (const LocalModel model : {LocalModel::kElement, LocalModel::kPotential}) {
    for (const WallShape wall : kWallShapes) {
      const std::vector<RateTradeRow> rows = run_trade(one_device(0, model, wall));
      ASSERT_EQ(rows.size(), 2U);
      // The bisection ends within 1 %.
      EXPECT_NEAR(rows[0].stable_stiffness_n_per_m / rows[1].stable_stiffness_n_per_m,
                  1.0, 0.02)
          << name(model) << ' ' << name(wall);
      EXPECT_LT(rows[0].rms_relative_error, 0.01) << name(model) << ' ' << name(wall);
      EXPECT_LT(rows[0].created_j, 1e-15) << name(model) << ' ' << name(wall);
    }
  }
}

TEST(Trade, AHeldForceLosesStiffnessAndCreatesEnergyAtLowRates) {
  const std::vector<RateTradeRow> rows =
      run_trade(one_device(0, LocalModel::kSingle, WallShape::kLinear));
  EXPECT_LT(rows[0].stable_stiffness_n_per_m, 0.5 * rows[1].stable_stiffness_n_per_m);
  EXPECT_GT(rows[0].created_j, rows[1].created_j);
  EXPECT_GT(rows[1].created_j, 0.0);
}

TEST(Trade, ADelayedQuantisedDeviceIsBoundedByItsDamping) {
  const std::vector<RateTradeRow> rows =
      run_trade(one_device(1, LocalModel::kElement, WallShape::kLinear));
  const TradeDevice falcon = trade_devices()[1];
  // b / (T/2 + delay) is sufficient for passivity (Diolaiti et al. 2006); a device
  // leaning alone is stable up to a few times as much, and not without end.
  const double passive = falcon.mass.damping_n_s_per_m / (0.5 / 2000 + falcon.delay_s);
  EXPECT_GT(rows[0].stable_stiffness_n_per_m, 0.5 * passive);
  EXPECT_LT(rows[0].stable_stiffness_n_per_m, 4.0 * passive);
}

TEST(Trade, TakesRatesThatDivideAndRefusesNone) {
  RateTradeOptions options = one_device(0, LocalModel::kElement, WallShape::kLinear);
  options.slow_hz = {3000, 300};
  EXPECT_THROW((void)run_trade(options), InputError);
}

TEST(Trade, ReportHasItsKeysAndAPicture) {
  RateTradeRow row;
  row.device = "one";
  row.wall = WallShape::kNonlinear;
  row.model = LocalModel::kElement;
  row.fast_hz = 2000;
  row.slow_hz = 100;
  row.stable_stiffness_n_per_m = 170.0;
  const auto json = parse_json(to_json({row}));
  for (const char* key :
       {"device", "wall", "model", "fast_hz", "slow_hz", "stable_stiffness_n_per_m",
        "rms_relative_error", "net_energy_j", "cpu_s_per_s"}) {
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  }
  EXPECT_NE(table_csv({row}).find("one,nonlinear,element,2000,100,170"),
            std::string::npos);
  EXPECT_NE(trade_picture({row}, WallShape::kNonlinear).find("element"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
