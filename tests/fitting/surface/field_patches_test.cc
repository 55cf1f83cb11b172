#include "fitting/surface/field_patches.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

class OnBall : public testing::Test {
 protected:
  static std::vector<AttachedPoint> points(const SurfaceMesh& mesh) {
    std::mt19937 generator(2);
    std::normal_distribution<double> normal;
    std::vector<AttachedPoint> found;
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d p(normal(generator), normal(generator), normal(generator));
      found.push_back(closest_surface_point(mesh, 0.05 * p.normalized()));
    }
    return found;
  }

  void SetUp() override {
    std::mt19937 generator(4);
    std::normal_distribution<double> normal;
    data_ = {Eigen::VectorXd(40), Eigen::VectorXd::Constant(40, 0.03),
             std::vector<char>(40, 1)};
    for (Eigen::Index i = 0; i < 40; ++i) {
      const Eigen::Vector3d p =
          position_m(mesh_, model_.point()[static_cast<std::size_t>(i)]);
      data_.value[i] = std::sin(30.0 * p.x()) + 0.03 * normal(generator);
    }
  }

  SurfaceMesh mesh_ = sphere_surface(0.05, 2);
  FieldModel model_{mesh_, points(mesh_)};
  FieldData data_;
  FieldParameters near_{.length_m = 0.05, .sd = 0.5, .nugget_sd = 0.02};
};

TEST_F(OnBall, PatchesAreNeighboursAndHoldEveryPointOnce) {
  const auto patches = patches_of(model_, 6);
  ASSERT_EQ(patches.size(), 6U);
  std::vector<int> times(40, 0);
  double within = 0.0, count = 0.0;
  for (const auto& patch : patches) {
    for (const std::size_t i : patch) {
      ++times[i];
      within += (position_m(mesh_, model_.point()[i]) -
                 position_m(mesh_, model_.point()[patch.front()]))
                    .norm();
      count += 1.0;
    }
  }
  EXPECT_EQ(times, std::vector<int>(40, 1));
  EXPECT_LT(within / count, 0.04);  // points at random are 0.067 apart
}

TEST_F(OnBall, PatchesArePredictedFromTheOthersAlone) {
  const PatchScore score = left_out_patches(model_, {&data_, 1}, near_);
  EXPECT_EQ(score.patches, 10U);
  EXPECT_EQ(score.points, 40U);
  EXPECT_GT(score.coverage, 0.8);
  const FieldPosterior all = model_.posterior(near_, data_);
  EXPECT_GT(score.rms, std::sqrt(all.left_out_residual.squaredNorm() / 40.0));
}

TEST_F(OnBall, WhatScreeningWouldTakeCountsAsMissed) {
  for (const Eigen::Index i : {3, 17, 29, 36}) {
    data_.value[i] += 6.0;
  }
  EXPECT_LE(left_out_patches(model_, {&data_, 1}, near_).coverage, 0.9);
}

TEST_F(OnBall, FewPointsTellLittleOfTheParameters) {
  for (std::size_t i = 9; i < 40; ++i) {
    data_.used[i] = 0;
  }
  const FieldParametersReport fit = fit_field_parameters(model_, {&data_, 1});
  const auto probable = probable_parameters(model_, {&data_, 1}, fit);
  EXPECT_GT(probable.size(), 6U);
  EXPECT_NEAR(std::accumulate(probable.begin(), probable.end(), 0.0,
                              [](double sum, const ProbableParameters& p) {
                                return sum + p.weight;
                              }),
              1.0, 1e-12);
  const FieldPosterior mixed = mixed_posterior(model_, probable, data_);
  const FieldPosterior plug_in = model_.posterior(fit.parameters, data_);
  EXPECT_GT(mixed.sd.mean(), plug_in.sd.mean());
  // Variance of the mixture: mean of variances and spread of means.
  double variance = 0.0, mean = 0.0;
  for (const auto& [parameters, weight] : probable) {
    const FieldPosterior one = model_.posterior(parameters, data_);
    mean += weight * one.at_nodes()[5];
    variance += weight * (std::pow(one.sd[5], 2) + std::pow(one.at_nodes()[5], 2));
  }
  EXPECT_NEAR(mixed.at_nodes()[5], mean, 1e-12);
  EXPECT_NEAR(mixed.sd[5], std::sqrt(variance - mean * mean), 1e-9);
}

}  // namespace
}  // namespace palpate
