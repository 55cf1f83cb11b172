#include "formats/mesh/space_curve.h"

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Cell = Eigen::Matrix<std::uint32_t, 3, 1>;

TEST(SpaceCurve, SuccessiveCellsShareAFace) {
  // The curve fills the corner block of side 16 before it leaves it.
  std::vector<std::pair<std::uint64_t, Cell>> cells;
  for (std::uint32_t x = 0; x < 16; ++x) {
    for (std::uint32_t y = 0; y < 16; ++y) {
      for (std::uint32_t z = 0; z < 16; ++z) {
        cells.emplace_back(hilbert_place({x, y, z}), Cell(x, y, z));
      }
    }
  }
  std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
    return a.first < b.first;
  });
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ASSERT_EQ(cells[i].first, i);
    if (i > 0) {
      const Eigen::Vector3i step =
          cells[i].second.cast<int>() - cells[i - 1].second.cast<int>();
      ASSERT_EQ(step.cwiseAbs().sum(), 1) << i;
    }
  }
}

TEST(SpaceCurve, OrderHoldsEveryPointOnceAndTwinsInTurn) {
  Points points = Points::Random(500, 3);
  points.row(321) = points.row(17);
  const std::vector<std::int32_t> order = curve_order(points);
  EXPECT_EQ(std::set<std::int32_t>(order.begin(), order.end()).size(), 500u);
  const auto first = std::find(order.begin(), order.end(), 17);
  EXPECT_EQ(*(first + 1), 321);
}

TEST(SpaceCurve, ChunksOfTheOrderAreCompact) {
  // Points on a square, 4096 of them: 64 chunks of 64 would be squares of an eighth of
  // the side at best; the curve's are at most a few times as large on average.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  Points points = Points::Zero(4096, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    points.row(i) << place(random), place(random), 0.0;
  }
  const std::vector<std::int32_t> order = curve_order(points);
  double area = 0.0;
  for (std::size_t begin = 0; begin < order.size(); begin += 64) {
    Eigen::AlignedBox3d box;
    for (std::size_t i = begin; i < begin + 64; ++i) {
      box.extend(points.row(order[i]).transpose());
    }
    area += box.sizes().x() * box.sizes().y();
  }
  EXPECT_LT(area, 3.0);  // of 1 for perfect squares, 64 for no order at all
}

TEST(SpaceCurve, NoPointsAndOnePlaceAreFine) {
  EXPECT_TRUE(curve_order(Points(0, 3)).empty());
  EXPECT_EQ(curve_order(Points::Ones(3, 3)), (std::vector<std::int32_t>{0, 1, 2}));
}

TEST(SpaceCurve, PointsThatAreNotFiniteLieInTheOrderToo) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double odd : {std::nan(""), -std::nan(""), infinite, -infinite}) {
    for (Eigen::Index row = 0; row < 4; ++row) {
      Points points = Points::Random(4, 3);
      points(row, 1) = odd;
      const std::vector<std::int32_t> order = curve_order(points);
      EXPECT_EQ(std::set<std::int32_t>(order.begin(), order.end()).size(), 4u) << odd;
    }
  }
}

}  // namespace
}  // namespace palpate
