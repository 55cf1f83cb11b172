// Where a measurement of several presses is cut.
#include "fitting/curve/split_presses.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Straight moves between these places, 50 samples each, 10 ms apart.
Measurement path(const std::vector<double>& places) {
  Measurement m;
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    for (int i = 0; i < 50; ++i) {
      m.depth_m.push_back(places[k] + (places[k + 1] - places[k]) * i / 50.0);
      m.force_n.push_back(0.1 * static_cast<double>(m.force_n.size()));
      m.time_s.push_back(0.01 * static_cast<double>(m.time_s.size()));
    }
  }
  return m;
}

std::vector<double> first_depths(const std::vector<double>& places) {
  std::vector<double> depths;
  for (const Measurement& press : split_presses(path(places))) {
    depths.push_back(press.depth_m.front());
  }
  return depths;
}

TEST(SplitPresses, BeginsWhereTheToolWasLowestBeforeItCameAgain) {
  EXPECT_EQ(first_depths({0.0, 5.0, 1.0, 6.0, 2.0, 5.0}),
            (std::vector<double>{0.0, 1.0, 2.0}));
}

TEST(SplitPresses, TheRestBeforeAPressBelongsToIt) {
  const auto presses = split_presses(path({0.0, 5.0, 1.0, 1.0, 1.0, 6.0}));
  ASSERT_EQ(presses.size(), 2U);
  EXPECT_EQ(presses[1].depth_m.size(), 150U);  // rest, rest, press
}

TEST(SplitPresses, DoesNotKnowTheSign) {
  EXPECT_EQ(first_depths({0.0, -5.0, -1.0, -6.0}), (std::vector<double>{0.0, -1.0}));
}

TEST(SplitPresses, NeitherBacklashNorAStaircaseNorARetreatAtFirstIsAPress) {
  EXPECT_EQ(first_depths({0.0, 5.0, 4.1, 6.0}).size(), 1U);  // back by 15 %
  EXPECT_EQ(first_depths({0.0, 2.0, 2.0, 4.0, 4.0, 6.0, 0.0}).size(), 1U);
  EXPECT_EQ(first_depths({2.0, 0.0, 6.0, 0.0}).size(), 1U);
  EXPECT_EQ(first_depths({0.0, 6.0, 0.0, 0.9}).size(), 1U);  // too little to be one
}

TEST(SplitPresses, PiecesAreTheMeasurement) {
  const Measurement whole = path({0.0, 5.0, 0.0, 5.0, 2.0, 6.0, 0.0});
  Measurement joined;
  for (const Measurement& press : split_presses(whole)) {
    const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(joined.depth_m, press.depth_m);
    append(joined.force_n, press.force_n);
    append(joined.time_s, press.time_s);
  }
  EXPECT_EQ(joined.depth_m, whole.depth_m);
  EXPECT_EQ(joined.force_n, whole.force_n);
  EXPECT_EQ(joined.time_s, whole.time_s);
}

}  // namespace
}  // namespace palpate
