// How the force of a node leans off its normal, by depth.
#include "formats/response/tilt_line.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "formats/response/response_table.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const Eigen::Vector3d kOutward = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
const Eigen::Vector3d kAlong = Eigen::Vector3d(2.0, 1.0, -2.0) / 3.0;
const Eigen::Vector3d kAcross = kOutward.cross(kAlong);

// Normal forces of Hertz's law, with tilts that are a function of depth.
template <typename Tilt>
TiltLine line_of_press(const Tilt& tilt, std::vector<double>& depth_m,
                       Points& force_n) {
  constexpr int kSamples = 12;
  force_n.resize(kSamples, 3);
  for (int k = 0; k < kSamples; ++k) {
    const double share = static_cast<double>(k) / (kSamples - 1);
    depth_m.push_back(0.005 * share * share);
    force_n.row(k) =
        std::pow(depth_m.back(), 1.5) * (kOutward + tilt(depth_m.back())).transpose();
  }
  return tilt_line(depth_m, force_n, kOutward);
}

ResponseTable table_of(const NodeResponse& response) {
  return make_table({"tip", "sphere", 0.002, 0.0, 0.0}, {response, NodeResponse{}});
}

// Pressed along a direction, over 4 mm of it.
NodeResponse pressed_along(const Eigen::Vector3d& direction) {
  NodeResponse response;
  response.direction = direction.normalized();
  response.origin = ResponseOrigin::kSimulated;
  for (int k = 0; k < 5; ++k) {
    response.depth_m.push_back(0.001 * k);
    response.force_n.push_back(0.5 * k * k);
  }
  return response;
}

TEST(TiltLine, OfOneDirectionIsTheTangentOfItsAngle) {
  const Eigen::Vector3d u =
      std::cos(20.0 * kDegree) * kOutward + std::sin(20.0 * kDegree) * kAlong;
  const TiltLine line = tilt_line(u, kOutward);
  EXPECT_LT((line.tilt - std::tan(20.0 * kDegree) * kAlong).norm(), 1e-15);
  EXPECT_EQ(line.by_depth_per_m, Eigen::Vector3d::Zero());
}

TEST(TiltLine, OfAPressWhoseTiltGrowsWithDepthIsExact) {
  std::vector<double> depth_m;
  Points force_n;
  const TiltLine line = line_of_press(
      [](double d) {
        return (0.1 + 30.0 * d) * kAlong - 8.0 * d * kAcross;
      },
      depth_m, force_n);
  EXPECT_LT((line.tilt - 0.1 * kAlong).norm(), 1e-14);
  EXPECT_LT((line.by_depth_per_m - 30.0 * kAlong + 8.0 * kAcross).norm(), 1e-11);
}

// A tilt with a bend: the line passes through the mean force's, and no other line has a
// smaller sum of squares.
TEST(TiltLine, IsLeastSquaresWithTheNormalForcesWork) {
  std::vector<double> depth_m;
  Points force_n;
  const TiltLine line = line_of_press(
      [](double d) {
        return 2e4 * d * d * kAlong;
      },
      depth_m, force_n);
  const auto squares = [&](const TiltLine& of) {
    double sum = 0.0;
    for (std::size_t k = 0; k < depth_m.size(); ++k) {
      const double h = 0.5 * (depth_m[std::min(k + 1, depth_m.size() - 1)] -
                              depth_m[k > 0 ? k - 1 : k]);
      const Eigen::Vector3d f = force_n.row(static_cast<Eigen::Index>(k)).transpose();
      const double normal_n = f.dot(kOutward);
      sum += normal_n > 0.0
                 ? h * normal_n *
                       (f / normal_n - kOutward - of.at(depth_m[k])).squaredNorm()
                 : 0.0;
    }
    return sum;
  };
  const double least = squares(line);
  EXPECT_GT(least, 0.0);
  for (const double step : {-1e-3, 1e-3}) {
    TiltLine other = line;
    other.tilt += step * kAlong;
    EXPECT_GT(squares(other), least);
    other = line;
    other.by_depth_per_m += step / 0.005 * kAlong;
    EXPECT_GT(squares(other), least);
  }
}

TEST(TiltLine, LeavesOutSamplesThatDoNotPushOutward) {
  const std::vector<double> depth_m{0.0, 0.001, 0.002, 0.003};
  Points force_n(4, 3);
  force_n.row(0).setZero();
  force_n.row(1) = (-0.2 * kOutward + 5.0 * kAcross).transpose();
  force_n.row(2) = (kOutward + 0.3 * kAlong).transpose();
  force_n.row(3) = (2.0 * kOutward + 0.6 * kAlong).transpose();
  const TiltLine line = tilt_line(depth_m, force_n, kOutward);
  EXPECT_LT((line.at(0.002) - 0.3 * kAlong).norm(), 1e-14);
  EXPECT_LT((line.at(0.003) - 0.3 * kAlong).norm(), 1e-14);
}

TEST(TiltLine, OfANodeIsTheStoredOneElseThatOfDirections) {
  NodeResponse response = pressed_along(kOutward + 0.2 * kAlong);
  const TiltLine by_direction = tilt_line(table_of(response), 0, kOutward);
  EXPECT_LT((by_direction.tilt - 0.2 * kAlong).norm(), 1e-15);
  const double along = response.direction.dot(kOutward);
  for (const double depth_m : response.depth_m) {
    response.sample_direction.push_back(
        (kOutward + (0.1 + 50.0 * depth_m / along) * kAlong).normalized());
  }
  const TiltLine by_sample = tilt_line(table_of(response), 0, kOutward);
  EXPECT_LT((by_sample.tilt - 0.1 * kAlong).norm(), 1e-13);
  EXPECT_LT((by_sample.by_depth_per_m - 50.0 * kAlong).norm(), 1e-10);
  response.tilt = TiltLine{.tilt = 0.4 * kAcross, .by_depth_per_m = 3.0 * kAlong};
  const TiltLine stored = tilt_line(table_of(response), 0, kOutward);
  EXPECT_EQ(stored.tilt, response.tilt->tilt);
  EXPECT_EQ(stored.by_depth_per_m, response.tilt->by_depth_per_m);
  const TiltLine none = tilt_line(table_of(response), 1, kOutward);
  EXPECT_EQ(none.tilt, Eigen::Vector3d::Zero());
}

TEST(TiltLine, WithinItsLimitsStaysAsItIs) {
  const TiltLine line{.tilt = 0.3 * kAlong, .by_depth_per_m = 60.0 * kAlong};
  const TiltLine kept = limited(line, 0.003, 0.005, 0.008);
  EXPECT_EQ(kept.tilt, line.tilt);
  EXPECT_EQ(kept.by_depth_per_m, line.by_depth_per_m);
}

TEST(TiltLine, PastItsLimitsTurnsAboutTheMiddle) {
  // It would change by 0.8 over an edge of 8 mm.
  const TiltLine steep{.tilt = -0.2 * kAlong, .by_depth_per_m = 100.0 * kAlong};
  const TiltLine flatter = limited(steep, 0.003, 0.005, 0.008);
  EXPECT_LT((flatter.at(0.003) - steep.at(0.003)).norm(), 1e-15);
  EXPECT_NEAR(flatter.by_depth_per_m.norm() * 0.008, kTiltChangeMost, 1e-12);
  // It would reach 1.6 at the end, aside at the touch.
  const TiltLine far{.tilt = -0.4 * kAlong + 0.5 * kAcross,
                     .by_depth_per_m = 400.0 * kAlong};
  const TiltLine nearer = limited(far, 0.003, 0.005, 0.0);
  EXPECT_LT((nearer.at(0.003) - far.at(0.003)).norm(), 0.4);  // 0.94 of it remains
  EXPECT_NEAR(std::max(nearer.tilt.norm(), nearer.at(0.005).norm()), kTiltMost, 1e-12);
  EXPECT_TRUE(is_within_limits(nearer, 0.005, 0.0));
  const TiltLine again = limited(nearer, 0.003, 0.005, 0.0);
  EXPECT_EQ(again.tilt, nearer.tilt);
  // All of it past the limit, the middle, too.
  const TiltLine lying{.tilt = 3.0 * kAlong, .by_depth_per_m = 50.0 * kAcross};
  EXPECT_TRUE(is_within_limits(limited(lying, 0.003, 0.005, 0.0), 0.005, 0.0));
  EXPECT_NEAR(limited(lying, 0.003, 0.005, 0.0).at(0.003).norm(), kTiltMost, 1e-12);
}

TEST(TiltLine, RangeIsThatOfNormalDepth) {
  const NodeResponse response = pressed_along(kOutward + kAlong);  // 45 degrees
  const TiltRange range = tilt_range(table_of(response), 0, kOutward);
  EXPECT_NEAR(range.end_m, 0.004 * std::sqrt(2.0), 1e-15);
  // f = k^2 / 2 at k mm: sum k^3 / sum k^2, the last one half.
  EXPECT_NEAR(range.middle_m, 0.001 * std::sqrt(2.0) * (36.0 + 32.0) / (14.0 + 8.0),
              1e-15);
}

// 0.5 over 70.7 mm are 7.07 1/m: what turns faster is limited, and what that cost is in
// the error.
TEST(TiltLine, OfAResponseIsLimitedByTheLongestEdgeOfItsNode) {
  const std::vector<double> edge_m = longest_edges_m(octahedron(0.05));
  EXPECT_NEAR(edge_m[3], 0.05 * std::sqrt(2.0), 1e-15);
  NodeResponse response = pressed_along(kOutward);
  response.error_relative = 0.01;
  EXPECT_FALSE(limit_tilt(response, kOutward, edge_m[3]));  // there is none
  response.tilt = TiltLine{.by_depth_per_m = 6.0 * kAlong};
  EXPECT_FALSE(limit_tilt(response, kOutward, edge_m[3]));
  EXPECT_EQ(response.error_relative, 0.01);
  response.tilt = TiltLine{.by_depth_per_m = 12.0 * kAlong};
  EXPECT_TRUE(limit_tilt(response, kOutward, edge_m[3]));
  EXPECT_NEAR(response.tilt->by_depth_per_m.norm(), 0.5 / edge_m[3], 1e-12);
  // Turned about the middle, 3.09 mm past the touch: that much is off at the touch.
  const double off = (12.0 - 0.5 / edge_m[3]) * 0.001 * 68.0 / 22.0;
  EXPECT_NEAR(response.error_relative, std::hypot(0.01, off), 1e-5);
  EXPECT_FALSE(limit_tilt(response, kOutward, edge_m[3]));
}

TEST(TiltLine, OfATableIsThereWhereAllResponsesHaveOne) {
  std::vector<NodeResponse> responses(2, pressed_along(kOutward));
  responses[0].tilt = TiltLine{};
  const ToolShape tip{"tip", "sphere", 0.002, 0.0, 0.0};
  EXPECT_EQ(make_table(tip, responses).tilt.rows(), 0);
  responses[1].tilt = TiltLine{};
  EXPECT_EQ(make_table(tip, responses).tilt.rows(), 2);
  responses[1] = {};  // nothing is missing where there is no response
  EXPECT_EQ(make_table(tip, responses).tilt.rows(), 2);
}

// A curve's end moves by 6e-8 of itself when it is stored as binary32.
TEST(TiltLine, AtItsLimitIsWithinItWhereDepthsWereRounded) {
  const TiltLine line{.by_depth_per_m = Eigen::Vector3d(1.0 / 0.004, 0.0, 0.0)};
  EXPECT_TRUE(is_within_limits(line, 0.004 * (1.0 + 6e-8), 0.0));
  EXPECT_FALSE(is_within_limits(line, 0.004 * (1.0 + 1e-5), 0.0));
}

}  // namespace
}  // namespace palpate
