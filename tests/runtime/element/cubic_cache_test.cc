// A piece of a curve is the curve, wherever it holds.
#include "runtime/element/cubic_cache.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"

namespace palpate {
namespace {

void expect_same(const ResponseSample& piece, const ResponseSample& curve) {
  EXPECT_NEAR(piece.force_n, curve.force_n, 1e-13 * std::abs(curve.force_n));
  EXPECT_NEAR(piece.stiffness_n_per_m, curve.stiffness_n_per_m,
              1e-11 * std::abs(curve.stiffness_n_per_m));
  EXPECT_NEAR(piece.energy_j, curve.energy_j, 1e-13 * std::abs(curve.energy_j));
  EXPECT_EQ(piece.extrapolated, curve.extrapolated);
}

TEST(CurvePiece, IsTheCurveInsideAndBeyond) {
  std::mt19937_64 random(7);
  for (const double exponent : {1.0, 1.5, 4.0}) {
    for (const double depth : {1e-9, 0.008, 1.0}) {
      ElementNode node;
      set_power_law(node, exponent, 2.0, depth);
      std::uniform_real_distribution<double> anywhere(0.0, 1.5 * depth);
      for (int i = 0; i < 2000; ++i) {
        const double d = anywhere(random);
        const CurvePiece piece = piece_around(node.curve(), d);
        ASSERT_TRUE(piece.holds(d)) << d;
        expect_same(piece.at(d), node.curve().at(d));
      }
    }
  }
}

TEST(CurvePiece, HoldsUpToItsLastSample) {
  ElementNode node;
  set_power_law(node, 1.5, 2.0, 0.008);
  const CurvePiece piece = piece_around(node.curve(), node.depth_m[5]);
  EXPECT_EQ(piece.from_m, node.depth_m[4]);
  EXPECT_EQ(piece.to_m, node.depth_m[5]);
  EXPECT_FALSE(piece.holds(piece.from_m));
  EXPECT_TRUE(piece.holds(piece.to_m));
  EXPECT_FALSE(piece.holds(std::nan("")));
}

TEST(CurvePieces, ForgetAnElementThatWasReplaced) {
  const auto cache = std::make_unique<ElementCache>();
  Element element;
  element.triangle = 3;
  set_power_law(element.node[1], 1.5, 2.0, 0.008);
  store(*cache, element);
  CurvePieces pieces;
  turn_to(pieces, *cache, 0);
  const double before = evaluate(pieces, cache->element[0].node[1], 1, 0.004).force_n;
  set_power_law(element.node[1], 1.5, 6.0, 0.008);
  store(*cache, element);
  turn_to(pieces, *cache, 0);
  const double after = evaluate(pieces, cache->element[0].node[1], 1, 0.004).force_n;
  EXPECT_NEAR(after, 3.0 * before, 1e-12);
}

}  // namespace
}  // namespace palpate
