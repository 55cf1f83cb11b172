// Ratios of good and cheap presses: what they reproduce, and between which vertices.
#include "precompute/press/response_ratio.h"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// F = k d along z, turned about y by `turn` [rad] per metre.
Indentation path(double k_n_per_m, double turn_per_m = 0.0, double depth_m = 0.01) {
  Indentation path;
  for (int i = 0; i <= 10; ++i) {
    const double d = depth_m * i / 10.0;
    path.sample.push_back({.penetration_m = 0.001 + d,
                           .force_n = k_n_per_m * d *
                                      Eigen::Vector3d(std::sin(turn_per_m * d), 0.0,
                                                      std::cos(turn_per_m * d))});
  }
  return path;
}

TEST(PathRatio, MakesTheGoodPathOutOfTheCheapOne) {
  const Indentation good = path(130.0, 20.0);
  const Indentation cheap = path(100.0);
  const auto ratio = path_ratio(good, cheap);
  ASSERT_TRUE(ratio);
  const Indentation made = scaled(cheap, *ratio, kInfinity);
  ASSERT_EQ(made.sample.size(), good.sample.size());
  for (std::size_t k = 0; k < good.sample.size(); ++k) {
    EXPECT_LT((made.sample[k].force_n - good.sample[k].force_n).norm(), 1e-12);
    EXPECT_DOUBLE_EQ(made.sample[k].penetration_m, good.sample[k].penetration_m);
  }
}

TEST(PathRatio, CarriesOverToAnotherMeshOfTheSameVertex) {
  // A coarse mesh makes both presses 7 % too stiff; the fine cheap one is right.
  const auto ratio = path_ratio(path(1.07 * 130.0, 20.0), path(1.07 * 100.0));
  ASSERT_TRUE(ratio);
  const Indentation made = scaled(path(100.0), *ratio, kInfinity);
  const Indentation good = path(130.0, 20.0);
  for (std::size_t k = 0; k < good.sample.size(); ++k) {
    EXPECT_LT((made.sample[k].force_n - good.sample[k].force_n).norm(), 1e-12);
  }
}

TEST(PathRatio, EndsWhereTheForcePassesTheLargest) {
  const auto ratio = path_ratio(path(200.0), path(100.0));
  ASSERT_TRUE(ratio);
  const Indentation made = scaled(path(100.0), *ratio, 1.1);
  EXPECT_TRUE(made.force_capped);
  EXPECT_NEAR(made.sample.back().force_n.norm(), 1.2, 1e-12);
}

// Four vertices: two on a flat top, 1 mm apart, one on the side around the edge, one on
// the top again but ten times as stiff.
class RatioFields : public testing::Test {
 protected:
  RatioFields() {
    body_.position_m.resize(4, 3);
    body_.position_m << 0, 0, 0, 0.001, 0, 0, 0.0005, 0, -0.0005, 0.0005, 0, 0;
    normal_.resize(4, 3);
    normal_ << 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1;
  }
  SurfaceMesh body_;
  Points normal_;
};

TEST_F(RatioFields, VerticesThatFaceElsewhereOrAreStifferAreFartherAway) {
  const RatioField field(body_, normal_, 0.002);
  const Indentation soft = path(100.0);
  const Indentation stiff = path(1000.0);
  EXPECT_NEAR(field.distance_m(0, soft, 1, soft), 0.001, 1e-12);
  EXPECT_GT(field.distance_m(0, soft, 2, soft), 0.005);
  EXPECT_DOUBLE_EQ(field.unlikeness(0, soft, 1, soft), 0.0);
  EXPECT_NEAR(field.unlikeness(0, soft, 2, soft), std::sqrt(2.0), 1e-12);
  EXPECT_GT(field.distance_m(0, soft, 3, stiff), 0.01);
  Indentation bent = soft;  // of the same stiffness, but not for long
  bent.nonlinearity = 0.5;
  EXPECT_GT(field.distance_m(0, soft, 1, bent), 0.01);
  EXPECT_DOUBLE_EQ(field.distance_m(0, soft, 3, stiff),
                   field.distance_m(3, stiff, 0, soft));
}

TEST_F(RatioFields, TakeTheRatioOfTheAlikeNeighbour) {
  RatioField field(body_, normal_, 0.002);
  const Indentation soft = path(100.0);
  const Indentation stiff = path(1000.0);
  field.add(1, soft, *path_ratio(path(110.0), soft));
  field.add(3, stiff, *path_ratio(path(5000.0), stiff));
  // Nearer in space to the stiff one; 1/d^2 weights of 1 mm and of 18 mm.
  EXPECT_NEAR(field.at(0, soft).force[9], 1.1, 0.02);
  EXPECT_NEAR(field.at(3, stiff, 1).force[9], 5.0, 1e-9);
  // Left out, each predicts the other wrongly by their ratio.
  const auto left_out = field.leave_one_out();
  EXPECT_NEAR(left_out[0], 5.0 / 1.1 - 1.0, 1e-6);
  EXPECT_NEAR(left_out[1], 1.0 - 1.1 / 5.0, 1e-6);
}

TEST_F(RatioFields, SayThatPathsAreHardWhereMostOfTheRatioIsOfSuch) {
  RatioField field(body_, normal_, 0.002);
  const Indentation soft = path(100.0);
  Indentation hard = path(110.0);
  hard.hard_path = true;
  field.add(0, soft, *path_ratio(hard, soft));
  field.add(2, soft, *path_ratio(path(110.0), soft));
  EXPECT_TRUE(scaled(soft, field.at(1, soft), kInfinity).hard_path);
  EXPECT_FALSE(scaled(soft, field.at(1, soft, 0), kInfinity).hard_path);
}

TEST_F(RatioFields, KeepAConstantRatioExactly) {
  RatioField field(body_, normal_, 0.002);
  const Indentation soft = path(100.0);
  for (const std::int32_t v : {1, 2, 3}) {
    field.add(v, soft, *path_ratio(path(110.0, 10.0), soft));
  }
  const PathRatio ratio = field.at(0, soft);
  for (Eigen::Index k = 0; k < ratio.force.size(); ++k) {
    EXPECT_NEAR(ratio.force[k], 1.1, 1e-12);
  }
  EXPECT_EQ(ratio.turn.rows(), 0);  // directions belong to their own vertex
  EXPECT_NEAR(field.error_at(0, soft, field.leave_one_out()), 0.0, 1e-12);
}

}  // namespace
}  // namespace palpate
