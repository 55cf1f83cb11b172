// What a law's energy adds to the linear body's, where the answer has a closed form: a
// block that is stretched alike everywhere, or in one half alone.
#include "precompute/contact/near_field.h"

#include <array>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "precompute/fem/quadratic_mesh.h"
#include "tests/support/box_tets.h"

namespace palpate {
namespace {

constexpr double kEdge = 0.01;
constexpr double kYoungs = 5e3;
constexpr double kPoissonsRatio = 0.45;

class StretchedBlock : public testing::Test {
 protected:
  StretchedBlock() {
    const std::vector<double> at{-kEdge, 0.0, kEdge};
    const BoxTets box = box_tets(at, at, at);
    mesh_ = make_quadratic(box.tets, box.surface);
  }

  // x grows by so much where it is positive and where it is negative.
  [[nodiscard]] Eigen::VectorXd stretched(double right, double left) const {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(3 * mesh_.position_m.rows());
    for (Eigen::Index n = 0; n < mesh_.position_m.rows(); ++n) {
      const double x = mesh_.position_m(n, 0);
      u[3 * n] = (x > 0.0 ? right : left) * x;
    }
    return u;
  }
  [[nodiscard]] std::vector<Eigen::Index> tets(bool right) const {
    std::vector<Eigen::Index> some;
    for (Eigen::Index t = 0; t < mesh_.tet.rows(); ++t) {
      double x = 0.0;
      for (Eigen::Index j = 0; j < 4; ++j) {
        x += mesh_.position_m(mesh_.tet(t, j), 0);
      }
      if ((x > 0.0) == right) {
        some.push_back(t);
      }
    }
    return some;
  }

  // Of a unit volume at rest.
  static double law_j(double stretch) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    F(0, 0) += stretch;
    return response(kGel.front(), F).energy_density;
  }
  static double linear_j(double stretch) {
    const double lame = kYoungs * kPoissonsRatio /
                        ((1.0 + kPoissonsRatio) * (1.0 - 2.0 * kPoissonsRatio));
    return 0.5 * (lame + kYoungs / (1.0 + kPoissonsRatio)) * stretch * stretch;
  }

  static constexpr double kHalfVolume = 4.0 * kEdge * kEdge * kEdge;
  static const std::array<Material, 1> kGel;
  QuadraticMesh mesh_;
};
const std::array<Material, 1> StretchedBlock::kGel{
    neo_hookean(kYoungs, kPoissonsRatio)};

TEST_F(StretchedBlock, StrainedTetsAreThoseWhoseGradientReachesTheThreshold) {
  const Eigen::VectorXd u = stretched(0.08, 0.02);
  EXPECT_EQ(strained_tets(mesh_, kGel, u, 0.05), tets(true));
  EXPECT_EQ(strained_tets(mesh_, kGel, u, 0.0799), tets(true));
  EXPECT_TRUE(strained_tets(mesh_, kGel, u, 0.0801).empty());
  EXPECT_EQ(strained_tets(mesh_, kGel, u, 0.0199).size(),
            static_cast<std::size_t>(mesh_.tet.rows()));
}

TEST_F(StretchedBlock, TheFarExcessIsWhatTheLawAddsOutsideTheNearField) {
  const Eigen::VectorXd u = stretched(0.08, -0.1);
  const double right = kHalfVolume * std::abs(law_j(0.08) - linear_j(0.08));
  const double left = kHalfVolume * std::abs(law_j(-0.1) - linear_j(-0.1));
  ASSERT_GT(right, 0.005 * kHalfVolume * linear_j(0.08));
  EXPECT_NEAR(far_excess_j(mesh_, kGel, tets(true), u), left, 1e-9 * left);
  EXPECT_NEAR(far_excess_j(mesh_, kGel, tets(false), u), right, 1e-9 * right);
  EXPECT_NEAR(far_excess_j(mesh_, kGel, {}, u), left + right, 1e-9 * left)
      << "what one half adds and another lacks do not cancel";
  const std::array<Material, 1> rubber{linear(kYoungs, kPoissonsRatio)};
  EXPECT_EQ(far_excess_j(mesh_, rubber, {}, u), 0.0);
}

TEST_F(StretchedBlock, NonlinearityIsTheShareThatTheLawAdds) {
  const auto share = [](double stretch) {
    return law_j(stretch) / linear_j(stretch) - 1.0;
  };
  EXPECT_NEAR(nonlinearity(mesh_, kGel, stretched(0.1, 0.1)), share(0.1), 1e-9);
  EXPECT_NEAR(nonlinearity(mesh_, kGel, stretched(-0.2, -0.2)), share(-0.2), 1e-9);
  EXPECT_NEAR(nonlinearity(mesh_, kGel, stretched(0.1, -0.1)),
              (law_j(0.1) + law_j(-0.1)) / (linear_j(0.1) + linear_j(-0.1)) - 1.0,
              1e-9);
  EXPECT_NEAR(nonlinearity(mesh_, kGel, stretched(-0.2, 0.0099)), share(-0.2), 1e-9)
      << "less than a twentieth of the largest strain is left out";
  EXPECT_EQ(nonlinearity(mesh_, kGel, stretched(0.0, 0.0)), 0.0);
  EXPECT_NEAR(nonlinearity(mesh_, kGel, stretched(-0.999, -0.999)), 10.0, 1e-12);
}

}  // namespace
}  // namespace palpate
