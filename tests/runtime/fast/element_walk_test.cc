#include "runtime/fast/element_walk.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"

namespace palpate {
namespace {

constexpr double kWalkRadiusM = 0.004;

// A body whose elements are all at hand: 2 x 2 squares of 10 mm.
struct WalkedBody {
  explicit WalkedBody(const BenchBodyOptions& options)
      : body(make_bench_body(options)), cache(std::make_unique<ElementCache>()) {
    for (const Element& element : body.element) {
      EXPECT_TRUE(store(*cache, element));
    }
  }

  [[nodiscard]] std::int32_t triangle(const ElementModel& model) const {
    return triangle_in(*cache, model.slot);
  }
  [[nodiscard]] int slot_at(const Vector3& x_m) const {
    return find(*cache, body.triangle_at(x_m));
  }

  BenchBody body;
  std::unique_ptr<ElementCache> cache;
};

BenchBodyOptions flat_squares() {
  BenchBodyOptions options;
  options.cells = 2;
  options.cell_m = 0.01;
  options.friction_min = 0.1;
  options.friction_max = 0.9;
  return options;
}

BenchBodyOptions wavy_squares() {
  BenchBodyOptions options = flat_squares();
  options.wave_m = 0.003;
  options.tilt_rad = 0.1;
  return options;
}

// What of the tool's place is off, tangentially: delta_t of (29) without slip.
Vector3 tangential_m(const ElementModel& model, const Vector3& x_m) {
  const Vector3 off = x_m - model.rest_m;
  return off - off.dot(model.direction) * model.direction;
}

TEST(ElementWalk, PlacingInterpolatesWhatTheNodesHave) {
  const WalkedBody walked(wavy_squares());
  const Vector3 area(0.2, 0.3, 0.5);
  ElementModel model;
  model.friction_n_per_m = 7.0;
  model.shift_m = 1e-3;
  place(model, *walked.cache, 3, area, kWalkRadiusM);
  const Element& element = element_of(*walked.cache, 3);
  Vector3 anchor = Vector3::Zero(), normal = Vector3::Zero(), toward = Vector3::Zero();
  double friction = 0.0;
  for (std::size_t j = 0; j < 3; ++j) {
    const double w = area(static_cast<Eigen::Index>(j));
    anchor += w * Vector3(element.node[j].position_m.data());
    normal += w * Vector3(element.node[j].normal.data());
    toward += w * Vector3(element.node[j].direction.data());
    friction += w * element.node[j].friction;
  }
  EXPECT_EQ(model.slot, 3);
  EXPECT_FALSE(model.outside);
  EXPECT_TRUE(model.area.isApprox(area, 1e-12));
  EXPECT_NEAR((model.anchor_m - anchor).norm(), 0.0, 1e-17);
  EXPECT_TRUE(model.normal.isApprox(normal.normalized(), 1e-12));
  EXPECT_TRUE(model.direction.isApprox(toward.normalized(), 1e-12));
  EXPECT_NEAR((model.rest_m - anchor - kWalkRadiusM * normal.normalized()).norm(), 0.0,
              1e-16);
  EXPECT_NEAR(model.friction, friction, 1e-15);
  EXPECT_DOUBLE_EQ(model.presliding_m, walked.body.options.presliding_m);
  // Left alone.
  EXPECT_EQ(model.friction_n_per_m, 7.0);
  EXPECT_EQ(model.shift_m, 1e-3);
}

TEST(ElementWalk, TouchesAreOfDepthsAlongTheDirection) {
  BenchBodyOptions options = flat_squares();
  options.touch_offset_m = 2e-4;
  options.tilt_rad = 1.0;
  const WalkedBody walked(options);
  ElementModel model;
  place(model, *walked.cache, 2, {0.4, 0.3, 0.3}, 0.0);
  const Element& element = element_of(*walked.cache, 2);
  for (std::size_t j = 0; j < 3; ++j) {
    const ElementNode& node = element.node[j];
    const double along =
        Vector3(node.normal.data()).dot(Vector3(node.direction.data()));
    EXPECT_DOUBLE_EQ(model.touch_m[j], node.touch_offset_m * std::abs(along));
  }
}

TEST(ElementWalk, BeyondAnEdgeTheAnchorIsInThePlaneAndTheRestAtTheNearestPoint) {
  const WalkedBody walked(flat_squares());
  ElementModel model;
  const Vector3 area(-0.5, 0.75, 0.75);
  place(model, *walked.cache, 0, area, kWalkRadiusM);
  EXPECT_TRUE(model.outside);
  EXPECT_GE(model.area.minCoeff(), 0.0);
  EXPECT_NEAR(model.area.sum(), 1.0, 1e-15);
  EXPECT_TRUE(model.anchor_area.isApprox(area, 1e-15));
  const Vector3 nearest = model.prism.corner_m * model.area;
  const Vector3 off = model.anchor_m - nearest;
  EXPECT_NEAR((model.anchor_m - model.prism.corner_m * area).norm(), 0.0, 1e-17);
  // Nearest: no corner lies farther along the way out.
  for (Eigen::Index j = 0; j < 3; ++j) {
    EXPECT_LE(off.dot(Vector3(model.prism.corner_m.col(j)) - nearest), 1e-15) << j;
  }
  EXPECT_GT(off.norm(), 1e-3);
}

TEST(ElementWalk, OnAFlatBodyTheAnchorIsUnderTheTool) {
  const WalkedBody walked(flat_squares());
  ElementModel model;
  for (const Vector3& x : {Vector3(0.004, 0.003, 0.003), Vector3(0.013, 0.016, -0.002),
                           Vector3(0.0051, 0.0149, 0.02)}) {
    adopt(model, *walked.cache, walked.slot_at(x), x, kWalkRadiusM);
    EXPECT_EQ(walked.triangle(model), walked.body.triangle_at(x));
    EXPECT_FALSE(model.outside);
    EXPECT_NEAR((model.anchor_m - Vector3(x.x(), x.y(), 0.0)).norm(), 0.0, 1e-15);
    EXPECT_NEAR(model.rest_m.z(), kWalkRadiusM, 1e-15);
  }
}

TEST(ElementWalk, TheToolKeepsTheDeflectionThatIsWanted) {
  const WalkedBody walked(flat_squares());
  ElementModel model;
  const Vector3 x(0.004, 0.003, 0.003);
  adopt(model, *walked.cache, walked.slot_at(x), x, kWalkRadiusM);
  const Vector3 tau(3e-4, -2e-4, 0.0);
  const Vector3 moved = x + Vector3(5e-4, 1e-4, -1e-4);
  follow(model, *walked.cache, moved, tau, kWalkRadiusM);
  EXPECT_NEAR((tangential_m(model, moved) - tau).norm(), 0.0, 1e-15);
}

// Derivatives leave out that n and u are made unit vectors: a twentieth, not a square.
TEST(ElementWalk, OnACurvedBodyAStepLeavesATwentieth) {
  const WalkedBody walked(wavy_squares());
  ElementModel model;
  const Vector3 x(0.004, 0.003, kWalkRadiusM - 0.001);
  adopt(model, *walked.cache, walked.slot_at(x), x, kWalkRadiusM);
  const int slot = model.slot;
  const Vector3 moved = x + Vector3(4e-4, 2e-4, 0.0);
  double left_m = (moved - x).norm();
  for (int n = 0; n < 8; ++n) {
    follow(model, *walked.cache, moved, Vector3::Zero(), kWalkRadiusM);
    ASSERT_EQ(model.slot, slot);
    const double off_m = tangential_m(model, moved).norm();
    EXPECT_LE(off_m, std::max(0.05 * left_m, 1e-15)) << n;
    left_m = off_m;
  }
}

TEST(ElementWalk, WhereResponsesLeanAStepLeavesAFiftieth) {
  BenchBodyOptions options = flat_squares();
  options.tilt_rad = 0.4;
  const WalkedBody walked(options);
  ElementModel model;
  // Deep, where leaning counts most.
  const Vector3 x(0.004, 0.003, kWalkRadiusM - 0.005);
  adopt(model, *walked.cache, walked.slot_at(x), x, kWalkRadiusM);
  follow(model, *walked.cache, x, Vector3::Zero(), kWalkRadiusM);
  const int slot = model.slot;
  const Vector3 moved = x + Vector3(-2e-4, 3e-4, 0.0);
  const double before_m = tangential_m(model, moved).norm();
  follow(model, *walked.cache, moved, Vector3::Zero(), kWalkRadiusM);
  ASSERT_EQ(model.slot, slot);
  EXPECT_GT(before_m, 2e-4);
  EXPECT_LT(tangential_m(model, moved).norm(), 0.02 * before_m);
}

TEST(ElementWalk, OnAnEdgeItIsInside) {
  const WalkedBody walked(flat_squares());
  ElementModel model;
  for (const double beyond : {0.0, 1e-12}) {
    place(model, *walked.cache, 0, {-beyond, 0.5, 0.5 + beyond}, kWalkRadiusM);
    EXPECT_FALSE(model.outside) << beyond;
    EXPECT_GE(model.anchor_area.minCoeff(), 0.0) << beyond;
  }
}

TEST(ElementWalk, CrossesIntoTheNeighbourAndBack) {
  const WalkedBody walked(flat_squares());
  ElementModel model;
  const Vector3 here(0.004, 0.003, kWalkRadiusM);
  const Vector3 there(0.0163, 0.0182, kWalkRadiusM);
  adopt(model, *walked.cache, walked.slot_at(here), here, kWalkRadiusM);
  for (const Vector3& x : {there, here}) {
    follow(model, *walked.cache, x, Vector3::Zero(), kWalkRadiusM);
    follow(model, *walked.cache, x, Vector3::Zero(), kWalkRadiusM);
    EXPECT_EQ(walked.triangle(model), walked.body.triangle_at(x));
    EXPECT_FALSE(model.outside || model.starved);
    EXPECT_NEAR((model.anchor_m - Vector3(x.x(), x.y(), 0.0)).norm(), 0.0, 1e-15);
  }
}

TEST(ElementWalk, BeyondTheBorderItIsOutsideAndNotStarved) {
  const WalkedBody walked(flat_squares());
  ElementModel model;
  const Vector3 inside(0.004, 0.003, kWalkRadiusM);
  adopt(model, *walked.cache, walked.slot_at(inside), inside, kWalkRadiusM);
  const Vector3 beyond(0.004, -0.002, kWalkRadiusM);
  follow(model, *walked.cache, beyond, Vector3::Zero(), kWalkRadiusM);
  EXPECT_TRUE(model.outside);
  EXPECT_FALSE(model.starved);
  EXPECT_NEAR((model.anchor_m - Vector3(0.004, -0.002, 0.0)).norm(), 0.0, 1e-15);
}

TEST(ElementWalk, WithoutTheNeighbourItIsStarvedUntilThatComes) {
  const WalkedBody walked(flat_squares());
  const Vector3 one(0.004, 0.003, kWalkRadiusM);
  const Vector3 other(0.004, 0.0047, kWalkRadiusM);
  for (const auto& [inside, beyond] : {std::pair(one, other), std::pair(other, one)}) {
    auto cache = std::make_unique<ElementCache>();
    const std::int32_t first = walked.body.triangle_at(inside);
    const std::int32_t second = walked.body.triangle_at(beyond);
    ASSERT_NE(first, second);
    (void)store(*cache, walked.body.element[static_cast<std::size_t>(first)]);
    ElementModel model;
    adopt(model, *cache, 0, inside, kWalkRadiusM);
    follow(model, *cache, beyond, Vector3::Zero(), kWalkRadiusM);
    EXPECT_TRUE(model.outside && model.starved) << second;
    EXPECT_EQ(triangle_in(*cache, model.slot), first);
    (void)store(*cache, walked.body.element[static_cast<std::size_t>(second)]);
    follow(model, *cache, beyond, Vector3::Zero(), kWalkRadiusM);
    EXPECT_FALSE(model.outside || model.starved) << second;
    EXPECT_EQ(triangle_in(*cache, model.slot), second);
  }
}

TEST(ElementWalk, ATriangleWithoutAreaHoldsTheAnchorAtItsFirstCorner) {
  const BenchBody body = make_bench_body(flat_squares());
  Element sliver = body.element[0];
  sliver.node[2].position_m = sliver.node[1].position_m;
  sliver.neighbour = {-1, -1, -1};
  auto cache = std::make_unique<ElementCache>();
  (void)store(*cache, sliver);
  ElementModel model;
  adopt(model, *cache, 0, {0.02, 0.03, 0.01}, kWalkRadiusM);
  EXPECT_EQ(model.anchor_m, Vector3(sliver.node[0].position_m.data()));
  EXPECT_TRUE(model.rest_m.allFinite());
}

}  // namespace
}  // namespace palpate
