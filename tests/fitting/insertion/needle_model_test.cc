#include "fitting/insertion/needle_model.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Two layers, two passes in two files.
NeedleModel two_layers() {
  return NeedleModel({.ruptures = 2,
                      .files = 2,
                      .reference_m = 2e-3,
                      .turn_m = {15e-3, 20e-3},
                      .turn_ruptures = {2, 2}});
}

Eigen::VectorXd parameters_of(const NeedleModel& model) {
  Eigen::VectorXd q(model.parameters());
  q[NeedleModel::kLogForce] = std::log(2.0);
  q[NeedleModel::kExponent] = 1.5;
  q[NeedleModel::kContact] = 1e-3;
  q[NeedleModel::kPresliding] = 3e3;
  q[model.cutting(1)] = 0.5;
  q[model.cutting(2)] = 0.3;
  q[model.friction(1)] = 20.0;
  q[model.friction(2)] = 35.0;
  q[model.boundary(1)] = 6e-3;
  q[model.offset(0)] = 0.1;
  q[model.drift(0)] = 0.02;
  q[model.offset(1)] = -0.2;
  q[model.drift(1)] = 0.03;
  q[model.turn(0)] = 1e-5;
  q[model.turn(1)] = 0.0;
  return q;
}

TEST(NeedleModel, ForceBeforeRuptureIsThePowerLaw) {
  const NeedleModel model = two_layers();
  const Eigen::VectorXd q = parameters_of(model);
  const double e = 1.3e-3;
  const double force =
      model.force(q, {.depth_m = 1e-3 + e, .clock = 0.5}, model.channels(q)).value;
  EXPECT_NEAR(force, 2.0 * std::pow(e / 2e-3, 1.5) + 0.1 + 0.01, 1e-12);
  EXPECT_NEAR(model.coefficient(q) * std::pow(2e-3, 1.5), 2.0, 1e-12);
}

TEST(NeedleModel, ForceInALayerIsCuttingForceAndFrictionOfTheChannel) {
  const NeedleModel model = two_layers();
  const Eigen::VectorXd q = parameters_of(model);
  const auto at = [&](double depth, int ruptures) {
    return model
        .force(q, {.depth_m = depth, .clock = 0.0, .ruptures = ruptures},
               model.channels(q))
        .value;
  };
  const double e1 = 2e-3 * std::pow(0.5 / 2.0, 1.0 / 1.5);
  EXPECT_NEAR(at(5e-3, 1), 0.1 + 0.5 + 20.0 * (4e-3 - e1), 1e-12);
  // At the boundary the channel waits, and the force rises along the curve.
  EXPECT_NEAR(at(8.5e-3, 1), 0.1 + 2.0 * std::pow(1.5e-3 / 2e-3, 1.5) + 20.0 * 6e-3,
              1e-12);
  const double e2 = 2e-3 * std::pow(0.3 / 2.0, 1.0 / 1.5);
  EXPECT_NEAR(at(14e-3, 2), 0.1 + 0.3 + 20.0 * 6e-3 + 35.0 * (13e-3 - e2 - 6e-3),
              1e-12);
}

TEST(NeedleModel, ExtractionAndOpenChannelMeetFrictionAlone) {
  const NeedleModel model = two_layers();
  const Eigen::VectorXd q = parameters_of(model);
  const double friction = 20.0 * 6e-3 + 35.0 * 2e-3;  // 8 mm deep
  const auto ends = model.channels(q);
  const NeedleSample out{
      .depth_m = 9e-3, .ruptures = 2, .shaft = ShaftState::kOutwards};
  EXPECT_NEAR(model.force(q, out, ends).value, 0.1 - friction, 1e-12);
  const NeedleSample in{.depth_m = 9e-3, .file = 1, .pass = 1, .ruptures = 2};
  EXPECT_NEAR(model.force(q, in, ends).value, -0.2 + friction, 1e-12);
}

TEST(NeedleModel, DerivativesAreThoseOfDifferences) {
  const NeedleModel model = two_layers();
  const Eigen::VectorXd q = parameters_of(model);
  const std::vector<NeedleSample> samples{
      {.depth_m = 2.3e-3, .clock = 0.1},
      {.depth_m = 5.1e-3, .clock = 0.2, .ruptures = 1},
      {.depth_m = 8.4e-3, .clock = 0.3, .ruptures = 1},
      {.depth_m = 14.2e-3, .clock = 0.4, .ruptures = 2},
      {.depth_m = 14.9e-3, .clock = 0.5, .ruptures = 2, .shaft = ShaftState::kSticks},
      {.depth_m = 14.7e-3, .clock = 0.5, .ruptures = 2, .shaft = ShaftState::kOutwards},
      {.depth_m = 4.2e-3, .clock = 0.6, .ruptures = 2, .shaft = ShaftState::kOutwards},
      {.depth_m = 8.9e-3, .clock = 0.7, .file = 1, .pass = 1, .ruptures = 2},
      {.depth_m = 14.9e-3, .clock = 0.8, .file = 1, .pass = 1, .ruptures = 2},
      {.depth_m = 19.3e-3, .clock = 0.9, .file = 1, .pass = 1, .ruptures = 2}};
  const auto n = static_cast<Eigen::Index>(samples.size());
  const std::vector<double> nothing(samples.size(), 0.0);
  Eigen::VectorXd r(n), above(n), below(n);
  RowMajorMatrix jacobian(n, q.size());
  model.evaluate(samples, nothing, q, r, &jacobian);
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const double step = 1e-6 * std::max(std::abs(q[j]), 1e-2);
    Eigen::VectorXd moved = q;
    moved[j] += step;
    model.evaluate(samples, nothing, moved, above, nullptr);
    moved[j] -= 2.0 * step;
    model.evaluate(samples, nothing, moved, below, nullptr);
    const Eigen::VectorXd slope = (above - below) / (2.0 * step);
    for (Eigen::Index i = 0; i < n; ++i) {
      EXPECT_NEAR(jacobian(i, j), slope[i], 1e-5 * std::max(1.0, std::abs(slope[i])))
          << "sample " << i << ", parameter " << j;
    }
  }
}

}  // namespace
}  // namespace palpate
