#include "precompute/build/accuracy_trade.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/organ_scene.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// Gel that is linear, on a table.
constexpr const char* kScene = R"([[tool]]
name = "fingertip"
shape = "sphere"
radius_m = 0.02
[reach]
box_m = [[-1.0, -1.0, 0.010], [1.0, 1.0, 1.0]]
depth_max_m = 0.006
[accuracy]
force_relative = 0.05
refine = "local"
)";

class Trade : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const ScratchFolder folder;
    write_obj(organ(2), folder / "organ.obj", "");
    std::ofstream(folder / "scene.toml") << organ_on_table("linear") << kScene;
    Progress progress(nullptr);
    report_ =
        trade(read_scene(folder / "scene.toml"),
              {.samples = 4, .resolution = {2.0, 4.0}, .depths = {5, 10}}, progress);
  }

  static TradeReport report_;
};
TradeReport Trade::report_;

TEST_F(Trade, FinerMeshesAreMoreExact) {
  ASSERT_EQ(report_.row.size(), 4U);
  const AccuracyTradeRow& coarse = report_.row[1];
  const AccuracyTradeRow& fine = report_.row[3];
  ASSERT_EQ(coarse.depths, fine.depths);
  EXPECT_EQ(fine.compared, 4);
  EXPECT_LT(fine.error_rms, coarse.error_rms);
  EXPECT_GT(fine.error_rms, 0.0) << "the reference is another mesh";
}

TEST_F(Trade, TheWorstVertexIsNoBetterThanTheirMean) {
  for (const AccuracyTradeRow& row : report_.row) {
    EXPECT_GE(row.error_largest, row.error_rms);
    EXPECT_LE(row.error_largest, row.error_rms * std::sqrt(4.0) * (1.0 + 1e-12))
        << "of four vertices";
  }
}

TEST_F(Trade, ASampleOfACurveTakesTwoNumbersOfSixteenBits) {
  EXPECT_EQ(report_.row[1].response_bytes - report_.row[0].response_bytes,
            report_.reachable * 5 * 2 * 2)
      << "FORMAT.md, \"Precision\": what a budget of 5 % is written with";
}

TEST_F(Trade, TheCheapestAndTheMostExactAreOnTheFront) {
  const auto cheapest =
      std::min_element(report_.row.begin(), report_.row.end(),
                       [](const AccuracyTradeRow& a, const AccuracyTradeRow& b) {
                         return a.cpu_seconds < b.cpu_seconds;
                       });
  const auto best =
      std::min_element(report_.row.begin(), report_.row.end(),
                       [](const AccuracyTradeRow& a, const AccuracyTradeRow& b) {
                         return a.error_rms < b.error_rms;
                       });
  EXPECT_TRUE(cheapest->pareto);
  EXPECT_TRUE(best->pareto);
}

TEST_F(Trade, TheTableHasALineForEveryWay) {
  const std::string csv = trade_csv(report_);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  const auto commas = std::count(csv.begin(), csv.begin() + csv.find('\n'), ',');
  EXPECT_EQ(std::count(csv.begin(), csv.end(), ','), 5 * commas);
  EXPECT_NE(trade_picture(report_).find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace palpate
