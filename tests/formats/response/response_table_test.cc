#include "formats/response/response_table.h"

#include <cmath>
#include <random>

#include "formats/base/error.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

const Eigen::Matrix3d kCorners =
    (Eigen::Matrix3d() << 0.01, 0.02, 0.0, 0.03, 0.02, 0.01, 0.02, 0.05, -0.01)
        .finished();

Eigen::Vector3i nodes_of(const ResponseDatabase& database, Eigen::Index triangle) {
  return database.body.triangle.row(triangle).transpose();
}

TEST(AreaCoordinates, AreAPartitionOfUnityThatGivesThePointBack) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> weight(-1.0, 2.0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d n(1.0, weight(random), weight(random));
    const Eigen::Vector3d wanted(1.0 - n[1] - n[2], n[1], n[2]);
    const Eigen::Vector3d found =
        area_coordinates(kCorners, kCorners.transpose() * wanted);
    EXPECT_NEAR(found.sum(), 1.0, 1e-12);
    EXPECT_LT((found - wanted).norm(), 1e-12);
  }
}

TEST(AreaCoordinates, DoNotSeeTheDistanceToThePlane) {
  const Eigen::Vector3d a = kCorners.row(0).transpose();
  const Eigen::Vector3d normal = (kCorners.row(1).transpose() - a)
                                     .cross(kCorners.row(2).transpose() - a)
                                     .normalized();
  const Eigen::Vector3d wanted(0.2, 0.3, 0.5);
  const Eigen::Vector3d above = kCorners.transpose() * wanted + 0.01 * normal;
  EXPECT_LT((area_coordinates(kCorners, above) - wanted).norm(), 1e-12);
}

TEST(AreaCoordinates, OfATriangleWithoutAreaAreItsFirstCorner) {
  Eigen::Matrix3d flat = kCorners;
  flat.row(2) = flat.row(1);
  EXPECT_EQ(area_coordinates(flat, Eigen::Vector3d::Ones()), Eigen::Vector3d::UnitX());
}

TEST(Interpolation, ReproducesTheResponseOfEachNode) {
  const ResponseDatabase database = small_database();
  const ResponseTable& table = database.tools[0];
  const Eigen::Vector3i node = nodes_of(database, 0);
  for (int j = 0; j < 3; ++j) {
    const InterpolatedResponse response =
        interpolate(table, database.normal, node, Eigen::Vector3d::Unit(j), 0.002);
    const double offset = table.touch_offset_m[static_cast<std::size_t>(node[j])];
    const ResponseSample sample = table.curve(node[j]).at(0.002 - offset);
    EXPECT_EQ(response.direction, table.direction.row(node[j]).transpose());
    EXPECT_DOUBLE_EQ(response.force_n, sample.force_n);
    EXPECT_DOUBLE_EQ(response.energy_j, sample.energy_j);
  }
}

TEST(Interpolation, OfEqualNodesIsTheirResponseEverywhere) {
  ResponseDatabase database = small_database();
  NodeResponse one;
  one.direction = Eigen::Vector3d(0.0, 0.6, 0.8);
  one.depth_m = {0.0, 0.001, 0.003};
  one.force_n = {0.0, 0.4, 1.5};
  one.origin = ResponseOrigin::kSimulated;
  const ResponseTable table =
      make_table(database.tools[0].tool, std::vector<NodeResponse>(6, one));
  const InterpolatedResponse response = interpolate(
      table, database.normal, {0, 2, 4}, Eigen::Vector3d(0.2, 0.3, 0.5), 0.002);
  EXPECT_LT((response.direction - one.direction).norm(), 1e-15);
  EXPECT_NEAR(response.force_n, table.curve(0).at(0.002).force_n, 1e-15);
}

TEST(Interpolation, IsContinuousAcrossAnEdge) {
  const ResponseDatabase database = small_database();
  const ResponseTable& table = database.tools[0];
  // Triangles 0 = (0, 2, 4) and 1 = (2, 1, 4) share the edge of nodes 2 and 4.
  for (double s = 0.0; s <= 1.0; s += 0.125) {
    for (const double depth : {0.0005, 0.002, 0.007}) {
      const InterpolatedResponse left =
          interpolate(table, database.normal, nodes_of(database, 0),
                      Eigen::Vector3d(0.0, 1.0 - s, s), depth);
      const InterpolatedResponse right =
          interpolate(table, database.normal, nodes_of(database, 1),
                      Eigen::Vector3d(1.0 - s, 0.0, s), depth);
      EXPECT_DOUBLE_EQ(left.force_n, right.force_n);
      EXPECT_DOUBLE_EQ(left.energy_j, right.energy_j);
      EXPECT_LT((left.direction - right.direction).norm(), 1e-15);
    }
  }
}

TEST(Interpolation, ForceIsTheDerivativeOfEnergyAndStiffnessOfForce) {
  const ResponseDatabase database = small_database();
  const ResponseTable& table = database.tools[0];
  const Eigen::Vector3d inside(0.5, 0.3, 0.2);
  const auto at = [&](double depth) {
    return interpolate(table, database.normal, nodes_of(database, 0), inside, depth);
  };
  const double step = 1e-7;  // central differences: error ~ step^2 f'', rounding ~ 1e-9
  for (double depth = 1e-4; depth < 0.008; depth += 1.3e-4) {
    const double slope = (at(depth + step).energy_j - at(depth - step).energy_j) / 2e-7;
    EXPECT_NEAR(at(depth).force_n, slope, 1e-6);
    const double stiffness =
        (at(depth + step).force_n - at(depth - step).force_n) / 2e-7;
    EXPECT_NEAR(at(depth).stiffness_n_per_m, stiffness, 1e-3 * (1.0 + stiffness));
  }
}

TEST(Interpolation, DirectionHasUnitLength) {
  const ResponseDatabase database = small_database();
  const InterpolatedResponse response =
      interpolate(database.tools[0], database.normal, nodes_of(database, 0),
                  Eigen::Vector3d(0.4, 0.35, 0.25), 0.001);
  EXPECT_NEAR(response.direction.norm(), 1.0, 1e-15);
}

TEST(Interpolation, SaysWhereItExtrapolates) {
  const ResponseDatabase database = small_database();
  const auto at = [&](double depth) {
    return interpolate(database.tools[0], database.normal, nodes_of(database, 0),
                       Eigen::Vector3d(0.4, 0.35, 0.25), depth);
  };
  EXPECT_FALSE(at(0.004).extrapolated);
  EXPECT_TRUE(at(0.0055).extrapolated);
}

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
