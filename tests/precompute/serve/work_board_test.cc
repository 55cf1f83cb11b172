#include "precompute/serve/work_board.h"

#include <set>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr auto kMay = [](std::size_t) {
  return true;
};

HandPlace hand_at(double x_m, double speed_m_per_s = 0.0) {
  return {.position_m = {x_m, 0.0, 0.0}, .velocity_m_per_s = {speed_m_per_s, 0.0, 0.0}};
}

TEST(Remoteness, IsTheDistanceOfAHandAtRest) {
  EXPECT_DOUBLE_EQ(remoteness_m(hand_at(0.0), {0.03, 0.04, 0.0}), 0.05);
}

TEST(Remoteness, OfWhatLiesAheadCountsLess) {
  const HandPlace hand = hand_at(0.0, 0.1);
  const double end_m = 0.1 * kLookAheadS;
  EXPECT_DOUBLE_EQ(remoteness_m(hand, {0.5 * end_m, 0.0, 0.0}),
                   kAheadCounts * 0.5 * end_m);
  EXPECT_DOUBLE_EQ(remoteness_m(hand, {-0.01, 0.0, 0.0}), 0.01);
  EXPECT_NEAR(remoteness_m(hand, {end_m + 0.01, 0.0, 0.0}), kAheadCounts * end_m + 0.01,
              1e-15);
}

TEST(Remoteness, IsTheLeastOverTheWay) {
  const HandPlace hand = hand_at(0.0, 0.1);
  const Eigen::Vector3d point(0.06, 0.03, -0.01);
  double least = 1.0;
  for (int i = 0; i <= 100000; ++i) {
    const double s = 1e-5 * i * 0.1 * kLookAheadS;
    least = std::min(least,
                     (point - Eigen::Vector3d(s, 0.0, 0.0)).norm() + kAheadCounts * s);
  }
  EXPECT_NEAR(remoteness_m(hand, point), least, 1e-9);
}

// Ten vertices, 0.1 m apart in a row; a group for each, units of five and a check.
class WorkBoardTest : public testing::Test {
 protected:
  WorkBoardTest() : place_m_(10, 3) {
    place_m_.setZero();
    for (std::int32_t v = 0; v < 10; ++v) {
      place_m_(v, 0) = 0.1 * v;
      groups_.push_back({v});
    }
  }

  WorkBoard board() const { return {place_m_, groups_, units_}; }

  Points place_m_;
  std::vector<PreliminaryGroup> groups_;
  std::vector<WorkUnit> units_{{.index = 0, .vertex = {0, 1, 2, 3, 4}},
                               {.index = 1, .vertex = {5, 6, 7, 8, 9}},
                               {.index = 2, .is_check = true, .vertex = {9}}};
};

TEST_F(WorkBoardTest, TheNearestGroupComesFirst) {
  WorkBoard board = this->board();
  const std::vector<HandPlace> hands{hand_at(0.71)};
  EXPECT_EQ(board.next(hands, kMay).group, 7U);
}

TEST_F(WorkBoardTest, WhereAHandRestsOthersTakeTheUnitsNearIt) {
  WorkBoard board = this->board();
  const std::vector<HandPlace> hands{hand_at(0.75)};
  EXPECT_TRUE(board.next(hands, kMay).group);
  EXPECT_EQ(board.next(hands, kMay).unit, 1U);
  EXPECT_EQ(board.next(hands, kMay).unit, 0U);
  EXPECT_EQ(board.next(hands, kMay).unit, 2U);  // checks last
}

TEST_F(WorkBoardTest, WhileAHandMovesAllTakeGroupsOnItsWay) {
  WorkBoard board = this->board();
  const std::vector<HandPlace> hands{hand_at(0.41, 0.2)};
  EXPECT_EQ(board.next(hands, kMay).group, 4U);
  EXPECT_EQ(board.next(hands, kMay).group, 5U);
  EXPECT_EQ(board.next(hands, kMay).group, 6U);
  EXPECT_EQ(board.next(hands, kMay).group, 3U);  // behind, as 0.55 ahead
}

TEST_F(WorkBoardTest, GroupsAtAHandThatRestsComeBeforeUnits) {
  WorkBoard board = this->board();
  EXPECT_TRUE(board.next(std::vector{hand_at(0.0)}, kMay).group);
  EXPECT_EQ(board.next(std::vector{hand_at(0.9)}, kMay).group, 9U);
}

TEST_F(WorkBoardTest, WithoutHandsThereAreUnitsAlone) {
  WorkBoard board = this->board();
  EXPECT_EQ(board.next({}, kMay).unit, 0U);
  EXPECT_TRUE(board.next({}, kMay, true).group);  // one is about to come
}

TEST_F(WorkBoardTest, AUnitThatAnotherHasIsNotTaken) {
  WorkBoard board = this->board();
  EXPECT_EQ(board
                .next({},
                      [](std::size_t unit) {
                        return unit != 0;
                      })
                .unit,
            1U);
  EXPECT_EQ(board.open_units(), (std::vector<std::size_t>{0, 2}));
}

TEST_F(WorkBoardTest, AGroupThatAUnitHasAnsweredIsNotComputed) {
  WorkBoard board = this->board();
  board.finish_unit(0);
  EXPECT_EQ(board.next(std::vector{hand_at(0.0)}, kMay).group, 5U);
}

TEST_F(WorkBoardTest, EverythingIsHandedOutOnce) {
  WorkBoard board = this->board();
  std::set<std::size_t> groups;
  std::set<std::size_t> units;
  const std::vector<HandPlace> hands{hand_at(0.3, 0.1)};
  for (int i = 0; i < 13; ++i) {
    const NextWork work = board.next(hands, kMay);
    if (work.group) {
      EXPECT_TRUE(groups.insert(*work.group).second);
    } else {
      ASSERT_TRUE(work.unit);
      EXPECT_TRUE(units.insert(*work.unit).second);
    }
  }
  const NextWork none = board.next(hands, kMay);
  EXPECT_FALSE(none.group || none.unit);
  EXPECT_EQ(board.unfinished(), 3U);
  for (const std::size_t unit : units) {
    board.finish_unit(unit);
  }
  EXPECT_EQ(board.unfinished(), 0U);
}

}  // namespace
}  // namespace palpate
