#include "formats/response/response_table.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

TEST(HertzCurve, SampledQuadraticallyIsMetWithinTheBound) {
  // The error of a limited cubic falls with the square of the sample distance. Measured
  // at 12 intervals: 0.013 % of the largest force; the bound leaves a factor of four.
  const double k = 2000.0;
  const int n = 12;
  NodeResponse response;
  for (int i = 0; i <= n; ++i) {
    const double d = 0.005 * i * i / (n * n);
    response.depth_m.push_back(d);
    response.force_n.push_back(k * std::pow(d, 1.5));
  }
  response.direction = Eigen::Vector3d::UnitZ();
  response.origin = ResponseOrigin::kSimulated;
  const ResponseTable table =
      make_table({"ball", "sphere", 0.005, 0.0, 0.0}, {response});
  const double largest = k * std::pow(0.005, 1.5);
  double worst = 0.0;
  for (double d = 0.0; d <= 0.005; d += 1e-6) {
    worst =
        std::max(worst, std::abs(table.curve(0).at(d).force_n - k * std::pow(d, 1.5)));
  }
  RecordProperty("worst_relative_to_largest_force", fmt::format("{}", worst / largest));
  EXPECT_LT(worst, 5e-4 * largest);
}

TEST(ResponseTable, NodesWithoutResponseHaveEmptyCurves) {
  const ResponseTable table = small_database().tools[0];
  EXPECT_TRUE(table.curve(5).depth_m.empty());
  EXPECT_EQ(table.curve(5).at(0.001).force_n, 0.0);
  EXPECT_EQ(table.nodes(), 6);
  EXPECT_EQ(table.depth_max_m(), 0.005);
}

TEST(ResponseTable, FlagsFallingCurves) {
  const ResponseTable table = small_database().tools[0];
  EXPECT_EQ(table.flags[4], kFallingCurve);
  EXPECT_EQ(table.flags[3], 0);
}

TEST(ResponseTable, NamesTheNodeThatIsWrong) {
  std::vector<NodeResponse> responses(3);
  responses[2].origin = ResponseOrigin::kSimulated;
  responses[2].direction = Eigen::Vector3d(0.0, 0.0, 2.0);
  responses[2].depth_m = {0.0, 0.001};
  responses[2].force_n = {0.0, 1.0};
  const ToolShape ball{"ball", "sphere", 0.005, 0.0, 0.0};
  try {
    (void)make_table(ball, responses);
    FAIL() << "accepted a direction of length 2";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "node 2: its direction has length 2, must be 1");
  }
  responses[2].direction /= 2.0;
  responses[2].force_n[1] = std::nan("");
  EXPECT_THROW((void)make_table(ball, responses), InputError);
}

}  // namespace
}  // namespace palpate
