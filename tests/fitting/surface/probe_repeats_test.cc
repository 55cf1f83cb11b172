#include "fitting/surface/probe_repeats.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Places, AreThoseOfEqualPositions) {
  const std::vector<Eigen::Vector3d> position = {
      {0, 0, 0}, {1, 0, 0}, {1e-9, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  const auto places = places_of(position, 1e-6);
  ASSERT_EQ(places.size(), 3U);
  EXPECT_EQ(places[0], (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(places[1], (std::vector<std::size_t>{1, 4}));
}

FieldData repeats(std::size_t places, std::size_t each, double repeatability,
                  double stated) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  const auto m = static_cast<Eigen::Index>(places * each);
  FieldData set{Eigen::VectorXd(m), Eigen::VectorXd::Constant(m, stated),
                std::vector<char>(places * each, 1)};
  for (Eigen::Index i = 0; i < m; ++i) {
    set.value[i] = static_cast<double>(i / static_cast<Eigen::Index>(each)) +
                   std::hypot(repeatability, stated) * normal(generator);
  }
  return set;
}

std::vector<std::vector<std::size_t>> in_rows(std::size_t places, std::size_t each) {
  std::vector<std::vector<std::size_t>> rows(places);
  for (std::size_t i = 0; i < places * each; ++i) {
    rows[i / each].push_back(i);
  }
  return rows;
}

TEST(JoinedPresses, TellRepeatabilityBeyondTheStatedErrors) {
  const FieldData set = repeats(200, 3, 0.1, 0.05);
  const JoinedPresses joined = join_presses({&set, 1}, in_rows(200, 3));
  EXPECT_NEAR(joined.repeatability[0], 0.1, 0.015);
  EXPECT_NEAR(joined.data[0].sd[7], std::hypot(0.1, 0.05) / std::sqrt(3.0), 0.01);
  EXPECT_NEAR(joined.data[0].value[7], set.value.segment(21, 3).mean(), 1e-12);
}

TEST(JoinedPresses, PairsTellItToo) {
  const FieldData set = repeats(300, 2, 0.1, 0.0);
  EXPECT_NEAR(join_presses({&set, 1}, in_rows(300, 2)).repeatability[0], 0.1, 0.015);
}

TEST(JoinedPresses, LeaveOutWhatStandsAloneAtItsPlace) {
  FieldData set = repeats(20, 3, 0.1, 0.05);
  set.value[31] += 2.0;
  const JoinedPresses joined = join_presses({&set, 1}, in_rows(20, 3));
  EXPECT_EQ(joined.left_out, std::vector<std::size_t>{31});
  EXPECT_NEAR(joined.data[0].value[10], 10.0, 0.3);
}

TEST(JoinedPresses, WithoutRepeatsAreThePressesThemselves) {
  const FieldData set = repeats(12, 1, 0.1, 0.05);
  const JoinedPresses joined = join_presses({&set, 1}, in_rows(12, 1));
  EXPECT_TRUE(std::isnan(joined.repeatability[0]));
  EXPECT_LT((joined.data[0].value - set.value).norm(), 1e-12);
  EXPECT_LT((joined.data[0].sd - set.sd).norm(), 1e-15);
}

}  // namespace
}  // namespace palpate
