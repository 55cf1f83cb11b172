#include "runtime/element/prism_walk.h"

#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"

namespace palpate {
namespace {

// A needle of no width at z = 30 mm, alone: no coordinates, but a nearest point.
TEST(FieldPlace, WithoutCoordinatesItIsTheDistanceToTheNearestPoint) {
  constexpr double kHeight = 0.03;
  Element needle;
  needle.triangle = 0;
  for (std::size_t j = 0; j < 3; ++j) {
    needle.node[j].node = static_cast<std::int32_t>(j);
    needle.node[j].position_m = {0.004 * (static_cast<double>(j) - 1.0), 0.0, kHeight};
    needle.node[j].normal = {0.0, 0.0, 1.0};
  }
  needle.neighbour = {-1, -1, -1};
  auto cache = std::make_unique<ElementCache>();
  store(*cache, needle);
  for (const double up_m : {-0.02, -0.001, 0.003}) {
    for (const FieldKind kind : {FieldKind::kSmooth, FieldKind::kFacets}) {
      FieldPlace place;
      adopt(place, *cache, find(*cache, 0), {0.001, 0.0, kHeight + up_m}, kind);
      EXPECT_TRUE(place.folded);
      EXPECT_NEAR(place.height_m, up_m, 1e-12);
      follow(place, *cache, {0.002, 0.0, kHeight + 2.0 * up_m});
      EXPECT_NEAR(place.height_m, 2.0 * up_m, 1e-12);
    }
  }
}

TEST(FieldPlace, FollowsThroughTrianglesWithoutArea) {
  // Two triangles with a needle of no width between them.
  std::array<Element, 3> strip;
  const std::array<std::array<double, 3>, 5> position{
      {{-0.004, 0, 0}, {0, -0.003, 0}, {0, 0.003, 0}, {0, 0, 0}, {0.004, 0, 0}}};
  const std::array<std::array<int, 3>, 3> corner{{{0, 1, 2}, {1, 3, 2}, {1, 4, 2}}};
  for (std::size_t t = 0; t < 3; ++t) {
    strip[t].triangle = static_cast<std::int32_t>(t);
    for (std::size_t j = 0; j < 3; ++j) {
      const int node = corner[t][j];
      strip[t].node[j].node = node;
      strip[t].node[j].position_m = position[static_cast<std::size_t>(node)];
      strip[t].node[j].normal = {0.0, 0.0, 1.0};
      strip[t].node[j].direction = {0.0, 0.0, 1.0};
      set_power_law(strip[t].node[j], 1.5, 1.0, 0.008);
    }
  }
  strip[0].neighbour = {-1, 1, -1};
  strip[1].neighbour = {2, 2, 0};
  strip[2].neighbour = {-1, -1, 1};
  auto cache = std::make_unique<ElementCache>();
  for (const Element& element : strip) {
    store(*cache, element);
  }
  for (const FieldKind kind : {FieldKind::kSmooth, FieldKind::kFacets}) {
    FieldPlace place;
    adopt(place, *cache, find(*cache, 0), {-0.001, 0.0005, 0.002}, kind);
    ASSERT_FALSE(place.folded);
    follow(place, *cache, {0.001, 0.0005, 0.002});
    EXPECT_EQ(cache->triangle[static_cast<std::size_t>(place.slot)], 2);
    EXPECT_FALSE(place.folded || place.outside);
    EXPECT_LT((place.position_m - Eigen::Vector3d(0.001, 0.0005, 0.002)).norm(), 1e-12);
    EXPECT_NEAR(place.height_m, 0.002, 1e-15);
  }
}

}  // namespace
}  // namespace palpate
