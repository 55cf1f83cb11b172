#include "runtime/fast/friction_spring.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kPreslidingM = 5e-4;
constexpr double kCoulomb = 0.4;

// One element at hand, whose nodes have this friction.
std::unique_ptr<ElementCache> rough_cache(const std::array<double, 3>& friction,
                                          const std::array<double, 3>& presliding_m) {
  auto cache = std::make_unique<ElementCache>();
  for (std::size_t j = 0; j < 3; ++j) {
    cache->element[0].node[j].friction = friction[j];
    cache->element[0].node[j].presliding_m = presliding_m[j];
  }
  return cache;
}

std::unique_ptr<ElementCache> alike_cache(double friction = kCoulomb,
                                          double presliding_m = kPreslidingM) {
  return rough_cache({friction, friction, friction},
                     {presliding_m, presliding_m, presliding_m});
}

FieldPlace place_with(const Vector3& weight, const Vector3& normal = Vector3::UnitZ()) {
  FieldPlace place;
  place.slot = 0;
  place.weight = weight;
  place.normal = normal;
  return place;
}

const Vector3 kMiddle(0.25, 0.25, 0.5);
constexpr double kPressDepthM = 0.002;

// Pressed with this force, then moved along the surface.
FrictionSpring stretched(const ElementCache& cache, double normal_n,
                         const Vector3& moved_m) {
  FrictionSpring spring;
  set_spring(spring, place_with(kMiddle), cache, kPressDepthM, normal_n);
  spring.follow(moved_m, Vector3::UnitZ());
  return spring;
}

TEST(CoulombSpring, HoldsCoulombsForceWhereItIsStretchedByThePresliding) {
  const auto cache = alike_cache();
  const FrictionSpring spring = stretched(*cache, 3.0, {kPreslidingM, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(spring.n_per_m, kCoulomb * 3.0 / kPreslidingM);
  EXPECT_TRUE(spring.force_n().isApprox(Vector3(-kCoulomb * 3.0, 0.0, 0.0), 1e-14));
  EXPECT_DOUBLE_EQ(spring.energy_j(), 0.5 * kCoulomb * 3.0 * kPreslidingM);
}

TEST(CoulombSpring, FrictionAndPreslidingAreThoseOfThePlace) {
  const auto cache = rough_cache({0.1, 0.3, 0.8}, {2e-4, 4e-4, 1e-4});
  const double friction = 0.25 * 0.1 + 0.25 * 0.3 + 0.5 * 0.8;
  const double presliding_m = 0.25 * 2e-4 + 0.25 * 4e-4 + 0.5 * 1e-4;
  FrictionSpring spring;
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 2.0);
  EXPECT_DOUBLE_EQ(spring.n_per_m, friction * 2.0 / presliding_m);
  EXPECT_DOUBLE_EQ(spring.limit_n, friction * 2.0);
  // Weights below zero, beyond an edge, count as none.
  set_spring(spring, place_with({1.0, 0.0, -0.5}), *cache, kPressDepthM, 2.0);
  EXPECT_DOUBLE_EQ(spring.n_per_m, 0.1 * 2.0 / 2e-4);
}

TEST(CoulombSpring, SlidesOnceItsForceIsCoulombs) {
  const auto cache = alike_cache();
  FrictionSpring spring = stretched(*cache, 3.0, {3e-3, 4e-3, 0.0});
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 3.0);
  EXPECT_TRUE(
      spring.force_n().isApprox(-kCoulomb * 3.0 * Vector3(0.6, 0.8, 0.0), 1e-14));
}

TEST(CoulombSpring, SticksShortOfThePresliding) {
  const auto cache = alike_cache();
  const Vector3 moved(0.3 * kPreslidingM, -0.2 * kPreslidingM, 0.0);
  FrictionSpring spring = stretched(*cache, 3.0, moved);
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 3.0);
  EXPECT_TRUE(spring.stretch_m.isApprox(moved, 1e-14));
}

// (23): |delta_t| sqrt(k_t) is constant.
TEST(CoulombSpring, StoresNoMoreWhenItIsPressedHarder) {
  const auto cache = alike_cache();
  for (const double factor : {1.0 + 1e-9, 1.5, 4.0, 1e6}) {
    FrictionSpring spring = stretched(*cache, 2.0, {0.8 * kPreslidingM, 0.0, 0.0});
    const double before_j = spring.energy_j();
    set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 2.0 * factor);
    EXPECT_NEAR(spring.energy_j() / before_j, 1.0, 1e-12) << factor;
    EXPECT_NEAR(spring.stretch_m.x() * std::sqrt(factor), 0.8 * kPreslidingM, 1e-15);
  }
}

TEST(CoulombSpring, LosesEnergyAndNoStretchWhenItIsPressedLess) {
  const auto cache = alike_cache();
  const Vector3 moved(0.8 * kPreslidingM, 0.0, 0.0);
  FrictionSpring spring = stretched(*cache, 2.0, moved);
  const double before_j = spring.energy_j();
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 0.5);
  EXPECT_NEAR(spring.energy_j() / before_j, 0.25, 1e-14);
  EXPECT_TRUE(spring.stretch_m.isApprox(moved, 1e-14));
}

TEST(CoulombSpring, BeginsAnewAfterASurfaceThatPulls) {
  const auto cache = alike_cache();
  FrictionSpring spring = stretched(*cache, 2.0, {0.8 * kPreslidingM, 0.0, 0.0});
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, -1.0);
  EXPECT_EQ(spring.n_per_m, 0.0);
  EXPECT_EQ(spring.force_n(), Vector3::Zero());
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 2.0);
  EXPECT_EQ(spring.energy_j(), 0.0);
}

TEST(CoulombSpring, TurnsWithThePlaneAndKeepsItsLength) {
  const auto cache = alike_cache();
  const Vector3 moved(0.4 * kPreslidingM, 0.3 * kPreslidingM, 0.0);
  FrictionSpring spring = stretched(*cache, 2.0, moved);
  const Vector3 normal = Vector3(0.6, 0.0, 0.8);
  set_spring(spring, place_with(kMiddle, normal), *cache, kPressDepthM, 2.0);
  EXPECT_NEAR(spring.stretch_m.dot(normal), 0.0, 1e-19);
  EXPECT_NEAR(spring.stretch_m.norm(), moved.norm(), 1e-18);
  EXPECT_GT(spring.stretch_m.dot(moved), 0.0);
}

TEST(CoulombSpring, IsNotStretchedAlongTheNormalNorInFreeAir) {
  const auto cache = alike_cache();
  const Vector3 normal(0.0, 0.6, 0.8);
  FrictionSpring spring;
  spring.follow({1e-4, 0.0, 0.0}, normal);
  EXPECT_EQ(spring.stretch_m, Vector3::Zero());
  set_spring(spring, place_with(kMiddle, normal), *cache, kPressDepthM, 2.0);
  spring.follow(1e-3 * normal, normal);
  EXPECT_NEAR(spring.stretch_m.norm(), 0.0, 1e-18);
  spring.follow(1e-3 * normal + Vector3(1e-4, 0.0, 0.0), normal);
  EXPECT_NEAR((spring.stretch_m - Vector3(1e-4, 0.0, 0.0)).norm(), 0.0, 1e-18);
}

TEST(CoulombSpring, IsNoneWithoutFrictionOrPresliding) {
  const auto rough = alike_cache();
  for (const auto& cache :
       {alike_cache(0.0, kPreslidingM), alike_cache(kCoulomb, 0.0)}) {
    FrictionSpring spring = stretched(*rough, 2.0, {1e-4, 0.0, 0.0});
    set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 2.0);
    EXPECT_EQ(spring.n_per_m, 0.0);
    EXPECT_EQ(spring.stretch_m, Vector3::Zero());
  }
}

// The nodes also know how stiff the body is sideways: S of (xx, xy, yy), at all depths.
std::unique_ptr<ElementCache> stiff_cache(
    const std::array<std::array<double, 3>, 3>& lateral) {
  auto cache = alike_cache();
  for (std::size_t j = 0; j < 3; ++j) {
    ElementNode& node = cache->element[0].node[j];
    node.samples = 2;
    node.normal = {0.0, 0.0, 1.0};
    node.depth_m[1] = 2.0 * kPressDepthM;
    for (std::size_t k = 0; k < node.lateral.size(); ++k) {
      node.lateral[k] = lateral[j][k % 3];
    }
  }
  return cache;
}

constexpr std::array<double, 3> kAnisotropic{1.5, 0.3, 0.8};

// K = S N / d, whatever the presliding length says.
TEST(LateralSpring, IsTheBodysStiffness) {
  const auto cache = stiff_cache({kAnisotropic, kAnisotropic, kAnisotropic});
  const Vector3 moved(2e-5, -1e-5, 0.0);
  const FrictionSpring spring = stretched(*cache, 3.0, moved);
  const double per_m = 3.0 / kPressDepthM;
  const Vector3 wanted(-per_m * (1.5 * 2e-5 - 0.3 * 1e-5),
                       -per_m * (0.3 * 2e-5 - 0.8 * 1e-5), 0.0);
  EXPECT_TRUE(spring.force_n().isApprox(wanted, 1e-13));
  EXPECT_NEAR(spring.energy_j(), -0.5 * wanted.dot(moved), 1e-18);
}

// Nodes blend by their weights, at the depth of each.
TEST(LateralSpring, IsThatOfThePlaceAndDepth) {
  const auto cache = stiff_cache({{{1.0, 0.0, 1.0}, {2.0, 0.0, 1.0}, {4.0, 0.0, 1.0}}});
  cache->element[0].node[2].touch_offset_m = 0.5 * kPressDepthM;
  FrictionSpring spring;
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 2.0);
  const double depth_m = (0.25 + 0.25 + 0.5 * 0.5) * kPressDepthM;
  const double share = 0.25 * 1.0 + 0.25 * 2.0 + 0.5 * 4.0;
  EXPECT_NEAR(spring.tensor_n_per_m(0, 0), 2.0 / depth_m * share, 1e-9);
  // Half as deep as the curve goes is between the stored depths 1/4 and 9/16.
  ElementNode& first = cache->element[0].node[0];
  first.lateral[6] = 3.0;
  set_spring(spring, place_with({1.0, 0.0, 0.0}), *cache, kPressDepthM, 2.0);
  const double part = (0.5 - 0.25) / (9.0 / 16.0 - 0.25);
  EXPECT_NEAR(spring.tensor_n_per_m(0, 0), 2.0 / kPressDepthM * (1.0 + 2.0 * part),
              1e-9);
}

// One node that does not know makes the place one of presliding.
TEST(LateralSpring, NeedsAllNodesOfThePlace) {
  auto cache = stiff_cache({kAnisotropic, kAnisotropic, {0.0, 0.0, 0.0}});
  FrictionSpring spring;
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 2.0);
  EXPECT_FALSE(spring.by_body);
  EXPECT_DOUBLE_EQ(spring.n_per_m, kCoulomb * 2.0 / kPreslidingM);
  set_spring(spring, place_with({0.5, 0.5, 0.0}), *cache, kPressDepthM, 2.0);
  EXPECT_TRUE(spring.by_body);
}

// In steady slip the force is mu N, against the movement, however anisotropic.
TEST(LateralSpring, SlidesAgainstTheMovement) {
  const auto cache = stiff_cache({kAnisotropic, kAnisotropic, kAnisotropic});
  FrictionSpring spring;
  const Vector3 step(3e-6, 7e-6, 0.0);
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 3.0);
  for (int n = 0; n < 4000; ++n) {
    spring.follow(step, Vector3::UnitZ());
    set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 3.0);
  }
  EXPECT_TRUE(spring.force_n().isApprox(-kCoulomb * 3.0 * step.normalized(), 1e-9));
}

// A slip is the closest point: the force and what the slip loses are in proportion.
TEST(LateralSpring, SlipsToTheClosestPoint) {
  const auto cache = stiff_cache({kAnisotropic, kAnisotropic, kAnisotropic});
  FrictionSpring spring = stretched(*cache, 3.0, {3e-3, -1e-3, 0.0});
  const Vector3 tried = spring.stretch_m;
  set_spring(spring, place_with(kMiddle), *cache, kPressDepthM, 3.0);
  const Vector3 force = spring.force_n();
  EXPECT_NEAR(force.norm(), kCoulomb * 3.0, 1e-11);
  const Vector3 slip = tried - spring.stretch_m;
  EXPECT_NEAR(slip.normalized().dot(force.normalized()), -1.0, 1e-10);
}

TEST(LateralSpring, ChangesNeverGiveItEnergy) {
  auto cache = stiff_cache({{{1.5, 0.3, 0.8}, {0.4, -0.1, 2.5}, {9.0, 2.0, 0.6}}});
  for (std::size_t j = 0; j < 3; ++j) {
    ElementNode& node = cache->element[0].node[j];
    node.touch_offset_m = 0.3 * static_cast<double>(j) * kPressDepthM;
    const Vector3 normal = Vector3(0.2 * static_cast<double>(j), 0.1, 1.0).normalized();
    node.normal = {normal.x(), normal.y(), normal.z()};
    for (std::size_t k = 0; k < 4; ++k) {  // stiffer with the depth
      node.lateral[3 * k] *= 1.0 + static_cast<double>(k);
    }
  }
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  FrictionSpring spring;
  int by_body = 0;
  for (int n = 0; n < 20000; ++n) {
    Vector3 weight(unit(random), unit(random), unit(random) - 0.3);
    weight /= weight.cwiseMax(0.0).sum();
    const Vector3 normal =
        Vector3(unit(random) - 0.5, unit(random) - 0.5, 0.3 + unit(random))
            .normalized();
    const double before_j = spring.energy_j();
    const double normal_n = 5.0 * unit(random) - 1.0;
    const double depth_m = 3.0 * kPressDepthM * unit(random) - 0.2 * kPressDepthM;
    set_spring(spring, place_with(weight, normal), *cache, depth_m, normal_n);
    by_body += spring.by_body ? 1 : 0;
    ASSERT_LE(spring.energy_j(), before_j * (1.0 + 1e-14) + 1e-17) << n;
    ASSERT_NEAR(spring.stretch_m.dot(normal), 0.0, 1e-15) << n;
    ASSERT_LE(
        spring.force_n().norm(),
        kCoulomb * std::max(0.0, normal_n) * weight.cwiseMax(0.0).sum() * (1.0 + 1e-9) +
            1e-15)
        << n;
    spring.follow(1e-3 * Vector3(unit(random) - 0.5, unit(random) - 0.5, 0.0), normal);
  }
  EXPECT_GT(by_body, 10000);
}

// Whatever changes at a place that stands still, the spring gets no energy from it.
TEST(CoulombSpring, ChangesNeverGiveItEnergy) {
  const auto cache = rough_cache({0.1, 0.9, 0.5}, {1e-4, 8e-4, 3e-4});
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  FrictionSpring spring;
  for (int n = 0; n < 5000; ++n) {
    Vector3 weight(unit(random), unit(random), unit(random));
    weight /= weight.sum();
    const Vector3 normal =
        Vector3(unit(random) - 0.5, unit(random) - 0.5, 0.3 + unit(random))
            .normalized();
    const double before_j = spring.energy_j();
    const double normal_n = 5.0 * unit(random) - 1.0;
    set_spring(spring, place_with(weight, normal), *cache, kPressDepthM, normal_n);
    // Energies are below 5e-3 J: rounding of a few products.
    ASSERT_LE(spring.energy_j(), before_j + 1e-17) << n;
    ASSERT_NEAR(spring.stretch_m.dot(normal), 0.0, 1e-17) << n;
    const double friction = 0.1 * weight(0) + 0.9 * weight(1) + 0.5 * weight(2);
    ASSERT_LE(spring.force_n().norm(),
              friction * std::max(0.0, normal_n) * (1.0 + 1e-12))
        << n;
    spring.follow(1e-3 * Vector3(unit(random) - 0.5, unit(random) - 0.5, 0.0), normal);
  }
}

}  // namespace
}  // namespace palpate
