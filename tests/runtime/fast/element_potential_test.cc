#include "runtime/fast/element_potential.h"

#include <memory>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/element_walk.h"

namespace palpate {
namespace {

constexpr double kPressRadiusM = 0.003;

BenchBodyOptions uneven_body() {
  BenchBodyOptions options;
  options.cells = 1;
  options.cell_m = 0.01;
  options.wave_m = 0.002;
  options.contrast = 20.0;
  options.tilt_rad = 0.3;
  options.touch_offset_m = 1e-4;
  options.friction_min = 0.2;
  options.friction_max = 0.6;
  return options;
}

// One element, with the contact point where its area coordinates are.
struct FrozenModel {
  explicit FrozenModel(const BenchBodyOptions& options)
      : cache(std::make_unique<ElementCache>()) {
    (void)store(*cache, make_bench_body(options).element[0]);
    place(model, *cache, 0, {0.3, 0.5, 0.2}, kPressRadiusM);
  }

  // The tool so deep under where it touches, and so far to a side.
  [[nodiscard]] Vector3 tool(double depth_m, double side_m = 0.0) const {
    return model.rest_m - depth_m * model.direction +
           side_m * model.direction.unitOrthogonal();
  }
  [[nodiscard]] double energy_j(const Vector3& x_m) const {
    return respond(model, *cache, x_m).potential_j();
  }

  std::unique_ptr<ElementCache> cache;
  ElementModel model;
};

TEST(ElementPotential, WithoutAnElementThereIsNothing) {
  ElementModel model;
  const auto cache = std::make_unique<ElementCache>();
  const ElementResponse response = respond(model, *cache, Vector3::Zero());
  EXPECT_EQ(response.potential_j(), 0.0);
  EXPECT_FALSE(response.touching || response.loaded);
  EXPECT_EQ(force_n(model, response), Vector3::Zero());
}

// (28), with depths (30) past each node's touch.
TEST(ElementPotential, SumsTheNodesCurvesByArea) {
  const FrozenModel frozen(uneven_body());
  const double depth_m = 0.002;
  const ElementResponse response =
      respond(frozen.model, *frozen.cache, frozen.tool(depth_m, 1e-4));
  double normal_n = 0.0, normal_j = 0.0, slope = 0.0;
  for (std::size_t j = 0; j < 3; ++j) {
    const double w = frozen.model.area(static_cast<Eigen::Index>(j));
    const auto at = element_of(*frozen.cache, 0)
                        .node[j]
                        .curve()
                        .at(depth_m - frozen.model.touch_m[j]);
    normal_n += w * at.force_n;
    normal_j += w * at.energy_j;
    slope += w * at.stiffness_n_per_m;
  }
  EXPECT_NEAR(response.depth_m, depth_m, 1e-16);
  EXPECT_NEAR(response.normal_n / normal_n, 1.0, 1e-12);
  EXPECT_NEAR(response.normal_j / normal_j, 1.0, 1e-12);
  EXPECT_NEAR(response.stiffness_n_per_m / slope, 1.0, 1e-12);
  EXPECT_TRUE(response.touching && response.loaded);
  EXPECT_FALSE(response.extrapolated);
}

// F = -dE/dx by differences of second order, with the friction spring and its slip.
TEST(ElementPotential, TheForceIsTheSlopeOfTheEnergy) {
  FrozenModel frozen(uneven_body());
  frozen.model.friction_n_per_m = 800.0;
  frozen.model.slip_m = {1e-4, -2e-4, 5e-5};
  for (const double depth_m : {5e-4, 0.002, 0.006}) {
    const Vector3 x = frozen.tool(depth_m, 3e-4);
    const Vector3 force =
        force_n(frozen.model, respond(frozen.model, *frozen.cache, x));
    Vector3 slope;
    constexpr double kStep = 1e-7;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Vector3 step = kStep * Vector3::Unit(axis);
      slope(axis) =
          -(frozen.energy_j(x + step) - frozen.energy_j(x - step)) / (2.0 * kStep);
    }
    // Energies of 1e-2 J, rounded to 2e-18, over 2e-7 m; and the third derivative.
    EXPECT_NEAR((force - slope).norm(), 0.0, 1e-7) << depth_m;
    EXPECT_GT(force.norm(), 0.01);
  }
}

TEST(ElementPotential, StiffnessIsTheSlopeOfTheNormalForce) {
  const FrozenModel frozen(uneven_body());
  constexpr double kStep = 1e-7;
  const auto at = [&](double depth_m) {
    return respond(frozen.model, *frozen.cache, frozen.tool(depth_m));
  };
  const double slope =
      (at(0.002 + kStep).normal_n - at(0.002 - kStep).normal_n) / (2.0 * kStep);
  EXPECT_NEAR(at(0.002).stiffness_n_per_m / slope, 1.0, 1e-6);
}

TEST(ElementPotential, FrictionIsAtRightAnglesToTheResponse) {
  FrozenModel frozen(uneven_body());
  frozen.model.friction_n_per_m = 500.0;
  const ElementResponse response =
      respond(frozen.model, *frozen.cache, frozen.tool(0.001, 4e-4));
  EXPECT_NEAR(response.presliding_m.dot(frozen.model.direction), 0.0, 1e-18);
  EXPECT_NEAR(response.presliding_m.norm(), 4e-4, 1e-17);
  EXPECT_NEAR(response.friction_j, 0.5 * 500.0 * 4e-4 * 4e-4, 1e-16);
  const Vector3 force = force_n(frozen.model, response);
  EXPECT_NEAR(force.dot(frozen.model.direction), response.normal_n, 1e-13);
  EXPECT_LT(force.dot(response.presliding_m), 0.0);
}

TEST(ElementPotential, SlipIsTakenOffTheStretch) {
  FrozenModel frozen(uneven_body());
  frozen.model.friction_n_per_m = 500.0;
  frozen.model.slip_m = 1e-4 * frozen.model.direction.unitOrthogonal();
  const ElementResponse response =
      respond(frozen.model, *frozen.cache, frozen.tool(0.001, 4e-4));
  EXPECT_NEAR(response.presliding_m.norm(), 3e-4, 1e-17);
  EXPECT_NEAR(response.friction_j, 0.5 * 500.0 * 3e-4 * 3e-4, 1e-16);
}

TEST(ElementPotential, AShiftIsDepthThatIsNotFelt) {
  FrozenModel frozen(uneven_body());
  const ElementResponse shallow =
      respond(frozen.model, *frozen.cache, frozen.tool(0.001));
  frozen.model.shift_m = 0.0015;
  const ElementResponse shifted =
      respond(frozen.model, *frozen.cache, frozen.tool(0.0025));
  EXPECT_NEAR(shifted.normal_n / shallow.normal_n, 1.0, 1e-10);
  EXPECT_NEAR(shifted.depth_m, 0.0025, 1e-16);
  // Above its rest position the surface is touched, and bears nothing.
  const ElementResponse above =
      respond(frozen.model, *frozen.cache, frozen.tool(0.001));
  EXPECT_TRUE(above.touching);
  EXPECT_FALSE(above.loaded);
  EXPECT_EQ(above.normal_n, 0.0);
}

TEST(ElementPotential, AboveTheSurfaceNothingIsTouched) {
  const FrozenModel frozen(uneven_body());
  const ElementResponse response =
      respond(frozen.model, *frozen.cache, frozen.tool(-2e-4));
  EXPECT_FALSE(response.touching || response.loaded);
  EXPECT_EQ(response.potential_j(), 0.0);
}

TEST(ElementPotential, BeyondACurvesEndItSaysSo) {
  const FrozenModel frozen(uneven_body());
  const double end_m = uneven_body().depth_m;
  EXPECT_FALSE(
      respond(frozen.model, *frozen.cache, frozen.tool(end_m - 2e-4)).extrapolated);
  EXPECT_TRUE(
      respond(frozen.model, *frozen.cache, frozen.tool(end_m + 2e-4)).extrapolated);
}

TEST(ElementPotential, NodesWithoutAResponseGiveNothing) {
  FrozenModel frozen(uneven_body());
  const Vector3 x = frozen.tool(0.002);
  const double whole_n = respond(frozen.model, *frozen.cache, x).normal_n;
  const double share_n = 0.5 * element_of(*frozen.cache, 0)
                                   .node[1]
                                   .curve()
                                   .at(0.002 - frozen.model.touch_m[1])
                                   .force_n;
  frozen.cache->element[0].node[1].samples = 0;
  EXPECT_NEAR(respond(frozen.model, *frozen.cache, x).normal_n, whole_n - share_n,
              1e-13);
}

TEST(ElementPotential, WhatIsKeptFromOneTickToTheNextChangesNothing) {
  FrozenModel frozen(uneven_body());
  for (const double depth_m : {0.006, 1e-4, 0.003, 0.009, 0.0031, -1e-3, 2e-3}) {
    const Vector3 x = frozen.tool(depth_m, 1e-4);
    const ElementResponse fresh = respond(frozen.model, *frozen.cache, x);
    const ElementResponse kept = respond_here(frozen.model, *frozen.cache, x);
    ElementModel anew = frozen.model;
    anew.pieces = {};
    EXPECT_EQ(kept.normal_n, fresh.normal_n);
    EXPECT_EQ(kept.normal_j, respond(anew, *frozen.cache, x).normal_j);
  }
}

// Another element in the same slot: no piece of the old one's curves is left.
TEST(ElementPotential, ANewerElementAnswersWithItsOwnCurves) {
  FrozenModel frozen(uneven_body());
  const Vector3 x = frozen.tool(0.002);
  const double before_n = respond_here(frozen.model, *frozen.cache, x).normal_n;
  Element stiffer = element_of(*frozen.cache, 0);
  for (ElementNode& node : stiffer.node) {
    for (double& force : node.force_n) {
      force *= 2.0;
    }
    for (double& slope : node.stiffness_n_per_m) {
      slope *= 2.0;
    }
  }
  (void)store(*frozen.cache, stiffer);
  ASSERT_EQ(find(*frozen.cache, stiffer.triangle), 0);
  EXPECT_NEAR(respond_here(frozen.model, *frozen.cache, x).normal_n / before_n, 2.0,
              1e-12);
}

}  // namespace
}  // namespace palpate
