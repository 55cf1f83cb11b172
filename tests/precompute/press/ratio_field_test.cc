// Ratios of presses over a body: between which vertices they are alike, and how well
// those that are known say those that are not.
#include "precompute/press/ratio_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kAnyForce = std::numeric_limits<double>::infinity();

Indentation straight_path(double k_n_per_m) {
  Indentation path;
  for (int i = 0; i <= 10; ++i) {
    const double d = 0.001 * i;
    path.sample.push_back({.penetration_m = 0.001 + d,
                           .force_n = Eigen::Vector3d(0.0, 0.0, k_n_per_m * d)});
  }
  return path;
}

RatioField::Place place(std::int32_t vertex, const Indentation& linear) {
  return RatioField::place_of(vertex, linear);
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
  const Indentation soft = straight_path(100.0);
  const Indentation stiff = straight_path(1000.0);
  EXPECT_NEAR(field.distance_m(place(0, soft), place(1, soft)), 0.001, 1e-12);
  EXPECT_GT(field.distance_m(place(0, soft), place(2, soft)), 0.005);
  EXPECT_DOUBLE_EQ(field.unlikeness(place(0, soft), place(1, soft)), 0.0);
  EXPECT_NEAR(field.unlikeness(place(0, soft), place(2, soft)), std::sqrt(2.0), 1e-12);
  EXPECT_GT(field.distance_m(place(0, soft), place(3, stiff)), 0.01);
  Indentation bent = soft;  // of the same stiffness, but not for long
  bent.nonlinearity = 0.5;
  EXPECT_GT(field.distance_m(place(0, soft), place(1, bent)), 0.01);
  EXPECT_DOUBLE_EQ(field.distance_m(place(0, soft), place(3, stiff)),
                   field.distance_m(place(3, stiff), place(0, soft)));
}

TEST_F(RatioFields, TakeTheRatioOfTheAlikeNeighbour) {
  RatioField field(body_, normal_, 0.002);
  const Indentation soft = straight_path(100.0);
  const Indentation stiff = straight_path(1000.0);
  field.add(1, soft, path_ratio(straight_path(110.0), soft));
  field.add(3, stiff, path_ratio(straight_path(5000.0), stiff));
  const RatioModel ratios(field);
  // Nearer in space to the stiff one.
  EXPECT_NEAR(ratios.at(0, soft).force[9], 1.1, 0.02);
  EXPECT_NEAR(ratios.from_others(3, stiff).force[9], 1.1, 1e-9);
  EXPECT_NEAR(ratios.from_others(1, soft).force[9], 5.0, 1e-9);
  // Left out, each predicts the other wrongly by their ratio.
  const auto left_out = ratios.left_out_errors();
  EXPECT_NEAR(left_out[0], 5.0 / 1.1 - 1.0, 1e-6);
  EXPECT_NEAR(left_out[1], 1.0 - 1.1 / 5.0, 1e-6);
}

TEST_F(RatioFields, SayThatPathsAreHardWhereMostOfTheRatioIsOfSuch) {
  const Indentation soft = straight_path(100.0);
  Indentation hard = straight_path(110.0);
  hard.near_singular = true;
  RatioField field(body_, normal_, 0.002);
  field.add(0, soft, path_ratio(hard, soft));
  field.add(2, soft, path_ratio(straight_path(110.0), soft));
  const RatioModel ratios(field);
  EXPECT_TRUE(scaled(soft, ratios.at(1, soft), kAnyForce).near_singular);
  EXPECT_FALSE(scaled(soft, ratios.from_others(0, soft), kAnyForce).near_singular);
}

TEST_F(RatioFields, KeepAConstantRatioExactly) {
  RatioField field(body_, normal_, 0.002);
  const Indentation soft = straight_path(100.0);
  for (const std::int32_t v : {1, 2, 3}) {
    field.add(v, soft, path_ratio(straight_path(110.0), soft));
  }
  const RatioModel ratios(field);
  const PathRatio ratio = ratios.at(0, soft);
  for (Eigen::Index k = 0; k < ratio.force.size(); ++k) {
    EXPECT_NEAR(ratio.force[k], 1.1, 1e-12);
  }
  EXPECT_LT(ratio.turn.norm(), 1e-12);
  EXPECT_NEAR(ratios.error_at(0, soft), 0.0, 1e-12);
}

TEST_F(RatioFields, GoOnWithTheLastRatioWherePathsEnd) {
  RatioField field(body_, normal_, 0.002);
  Indentation shallow = straight_path(100.0);
  shallow.sample.resize(6);
  field.add(0, shallow, path_ratio(straight_path(120.0), shallow));
  field.add(1, straight_path(100.0),
            path_ratio(straight_path(120.0), straight_path(100.0)));
  const PathRatio ratio = RatioModel(field).at(2, straight_path(100.0));
  ASSERT_EQ(ratio.force.size(), 10);
  EXPECT_NEAR(ratio.force[9], 1.2, 1e-12);
}

TEST_F(RatioFields, ExpectErrorsNearPressesThatAreNotAlike) {
  RatioField field(body_, normal_, 0.002);
  const Indentation soft = straight_path(100.0);
  field.add(1, soft, path_ratio(straight_path(110.0), soft));
  EXPECT_DOUBLE_EQ(RatioModel(field).left_out_errors()[0], 1.0);  // nobody predicts it
  EXPECT_DOUBLE_EQ(RatioModel(field).error_at(0, soft), 1.0);
  field.add(3, soft, path_ratio(straight_path(110.0), soft));
  EXPECT_NEAR(RatioModel(field).error_at(0, soft), 0.0, 1e-9);
  field.add(2, soft, std::nullopt);
  EXPECT_EQ(field.size(), 2U);
  const RatioModel ratios(field);
  EXPECT_NEAR(ratios.at(0, soft).force[9], 1.1, 1e-12);
  EXPECT_GT(ratios.error_at(0, soft), 0.01);
  EXPECT_DOUBLE_EQ(ratios.left_out_errors()[2], 1.0);
}

// A rim of 36 vertices that face aside and up. Linear forces lean outward by little,
// full ones by much more, the more the deeper.
class Rim : public testing::Test {
 protected:
  static constexpr std::int32_t kVertices = 36;
  static constexpr double kLinearLean = 0.05;

  Rim() {
    body_.position_m.resize(kVertices, 3);
    normal_.resize(kVertices, 3);
    for (std::int32_t v = 0; v < kVertices; ++v) {
      body_.position_m.row(v) = 0.02 * radial(v).transpose();
      normal_.row(v) = (radial(v) + Eigen::Vector3d::UnitZ()).normalized().transpose();
    }
  }

  static Eigen::Vector3d radial(std::int32_t v) {
    const double angle = 2.0 * std::numbers::pi * v / kVertices;
    return {std::cos(angle), std::sin(angle), 0.0};
  }

  // Leans from the normal towards the axis of the rim.
  [[nodiscard]] Indentation press(std::int32_t v, double k_n_per_m, double lean,
                                  double lean_by_sample = 0.0) const {
    const Eigen::Vector3d n = normal_.row(v).transpose();
    const Eigen::Vector3d inward = (Eigen::Vector3d::UnitZ() - radial(v)).normalized();
    Indentation path = straight_path(k_n_per_m);
    double at = lean;
    for (IndentationSample& sample : path.sample) {
      sample.force_n =
          sample.force_n.norm() * (std::cos(at) * n + std::sin(at) * inward);
      at += lean_by_sample;
    }
    return path;
  }

  // Of the vertices between every sixth, the largest angle that predictions are off.
  [[nodiscard]] double largest_angle(double linear_lean, double full_lean) const {
    RatioField field(body_, normal_, 0.002);
    for (std::int32_t v = 0; v < kVertices; v += 6) {
      const Indentation linear = press(v, 100.0, linear_lean);
      field.add(v, linear, path_ratio(press(v, 90.0, full_lean, 0.01), linear));
    }
    const RatioModel ratios(field);
    double largest = 0.0;
    for (std::int32_t v = 0; v < kVertices; ++v) {
      const Indentation linear = press(v, 100.0, linear_lean);
      const Indentation told = scaled(linear, ratios.at(v, linear), kAnyForce);
      const Indentation full = press(v, 90.0, full_lean, 0.01);
      for (std::size_t k = 1; k < full.sample.size(); ++k) {
        largest = std::max(largest, (told.sample[k].force_n.normalized() -
                                     full.sample[k].force_n.normalized())
                                        .norm());
      }
    }
    return largest;
  }

  SurfaceMesh body_;
  Points normal_;
};

// What all vertices share in their own frame is known everywhere.
TEST_F(Rim, TurnsOfForcesFollowTheFrameOfTheVertex) {
  EXPECT_LT(largest_angle(kLinearLean, 0.35), 0.002);
}

TEST_F(Rim, LeftOutErrorsCountTheTurn) {
  RatioField field(body_, normal_, 0.002);
  for (const std::int32_t v : {0, 6, 12, 18}) {
    const Indentation linear = press(v, 100.0, kLinearLean);
    field.add(v, linear,
              path_ratio(press(v, 100.0, v == 6 ? 0.35 : kLinearLean), linear));
  }
  const RatioModel ratios(field);
  // All of the error is the turn of 0.3 rad that nobody else has.
  EXPECT_NEAR(ratios.left_out_errors()[1], 2.0 * std::sin(0.15), 0.01);
  EXPECT_GT(ratios.left_out_errors()[0], 0.01);
  EXPECT_GT(ratios.error_at(7, press(7, 100.0, kLinearLean)), 0.05);
}

// Where a linear force does not lean, its frame has no way along the surface, and no
// turn either; around such a place it is continuous.
TEST_F(Rim, FramesAreContinuousWhereNothingLeans) {
  const RatioField field(body_, normal_, 0.002);
  const auto frame = [&](double lean) {
    return field.frame(RatioField::place_of(0, press(0, 100.0, lean)));
  };
  EXPECT_LT(frame(0.0).rightCols<2>().norm(), 1e-12);
  EXPECT_LT((frame(1e-5) - frame(-1e-5)).norm(), 0.01);
  EXPECT_GT(frame(0.1).col(1).norm(), 0.99);
  EXPECT_NEAR(frame(0.1).col(1).dot(frame(0.1).col(2)), 0.0, 1e-12);
}

// A bent sheet, 20 x 20 vertices whose ratios vary smoothly: with how steeply they face
// and, if that is asked for, in waves that are four contact radii long.
class Sheet : public testing::Test {
 protected:
  static constexpr std::int32_t kSide = 20;
  static constexpr double kContact = 0.002;

  Sheet() {
    body_.position_m.resize(kSide * kSide, 3);
    normal_.resize(kSide * kSide, 3);
    for (std::int32_t v = 0; v < kSide * kSide; ++v) {
      const double x = 0.001 * (v % kSide);
      const double y = 0.001 * (v / kSide);
      body_.position_m.row(v) << x, y, 0.0;
      normal_.row(v) << std::sin(50.0 * x), 0.0, std::cos(50.0 * x);
    }
  }

  [[nodiscard]] double ratio_at(std::int32_t v, double wave) const {
    return 1.0 + 0.2 * normal_(v, 0) +
           wave * std::sin(2.0 * std::numbers::pi * body_.position_m(v, 1) /
                           (4.0 * kContact));
  }

  // Share of the unknown vertices within what is expected, and the rms of errors.
  struct Found {
    double covered = 0.0;
    double rms = 0.0;
  };
  [[nodiscard]] Found every_fifth(double wave) const {
    RatioField field(body_, normal_, kContact);
    const Indentation linear = straight_path(100.0);
    for (std::int32_t v = 0; v < kSide * kSide; v += 5) {
      field.add(v + (v / kSide) % 5, linear,
                path_ratio(straight_path(100.0 * ratio_at(v + (v / kSide) % 5, wave)),
                           linear));
    }
    const RatioModel ratios(field);
    Found found;
    int unknown = 0;
    for (std::int32_t v = 0; v < kSide * kSide; ++v) {
      const bool is_known = std::any_of(field.known().begin(), field.known().end(),
                                        [&](const auto& known) {
                                          return known.place.vertex == v;
                                        });
      if (!is_known) {
        const double error =
            std::abs(ratios.at(v, linear).force[9] / ratio_at(v, wave) - 1.0);
        found.rms += error * error;
        found.covered += error <= ratios.error_at(v, linear) ? 1.0 : 0.0;
        ++unknown;
      }
    }
    found.covered /= unknown;
    found.rms = std::sqrt(found.rms / unknown);
    return found;
  }

  SurfaceMesh body_;
  Points normal_;
};

TEST_F(Sheet, RatiosThatFollowTheNormalAreKnownFromAFifth) {
  const Found found = every_fifth(0.0);
  EXPECT_LT(found.rms, 0.0005);  // of ratios from 0.84 to 1.2
  EXPECT_GT(found.covered, 0.9);
}

TEST_F(Sheet, RatiosThatVaryOverAContactAreFoundToDoSo) {
  const Found found = every_fifth(0.1);
  EXPECT_LT(found.rms, 0.02);  // the waves themselves are 0.07
  EXPECT_GT(found.covered, 0.8);
}

}  // namespace
}  // namespace palpate
