#include "runtime/hand/wandering_hand.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.05;

// The upper half of a sphere.
std::vector<bool> upper(const SurfaceMesh& body) {
  std::vector<bool> open;
  for (Eigen::Index i = 0; i < body.position_m.rows(); ++i) {
    open.push_back(body.position_m(i, 2) > 0.0);
  }
  return open;
}

TEST(WanderingHand, GoesOnAtItsSpeedWhereItMayAndStaysPressed) {
  const SurfaceMesh body = sphere_surface(kRadius, 3);
  const Points normal = vertex_normals(body);
  const WanderOptions options{
      .speed_m_per_s = 0.05, .touch_m = 0.006, .press_m = 0.002};
  WanderingHand hand(body, normal, upper(body), options);
  const double start_m = hand.target().position_m.norm();
  EXPECT_NEAR(start_m, kRadius + options.touch_m + options.clear_m, 1e-3);
  double path_m = 0.0;
  Eigen::Vector3d low = hand.target().position_m;
  Eigen::Vector3d high = low;
  Eigen::Vector3d before = low;
  constexpr double kStepS = 5e-4;
  for (int i = 0; i < 40000; ++i) {  // 20 s
    hand.advance(kStepS);
    const Eigen::Vector3d& now = hand.target().position_m;
    if (i >= 1000) {
      // Facets of a sphere of 640 triangles lie up to 0.7 mm inside it.
      EXPECT_NEAR(now.norm(), kRadius + options.touch_m - options.press_m, 1e-3);
      EXPECT_LT((now - before).norm(), 2.0 * options.speed_m_per_s * kStepS + 1e-5);
      path_m += (now - before).norm();
    }
    EXPECT_GT(now.z(), -0.01);
    before = now;
    low = low.cwiseMin(now);
    high = high.cwiseMax(now);
  }
  // The target runs over the surface: as much longer as it is farther out, 1.08; less
  // what was lost at the rim.
  EXPECT_GT(path_m, 0.7 * 0.05 * 19.5);
  EXPECT_LT(path_m, 1.2 * 0.05 * 19.5);
  EXPECT_GT((high - low).head<2>().minCoeff(), kRadius);  // it gets about
}

TEST(WanderingHand, RefusesABodyWithNowhereToGo) {
  const SurfaceMesh body = sphere_surface(kRadius, 1);
  const Points normal = vertex_normals(body);
  EXPECT_THROW(
      WanderingHand(body, normal,
                    std::vector<bool>(static_cast<std::size_t>(body.position_m.rows())),
                    {}),
      InputError);
}

}  // namespace
}  // namespace palpate
