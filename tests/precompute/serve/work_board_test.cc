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

TEST(DistanceToWay, IsToTheLineThatTheHandWillGo) {
  const HandPlace hand = hand_at(0.0, 0.1);
  const double end_m = 0.1 * kLookAheadS;
  EXPECT_DOUBLE_EQ(distance_to_way_m(hand, {0.5 * end_m, 0.02, 0.0}), 0.02);
  EXPECT_DOUBLE_EQ(distance_to_way_m(hand, {-0.01, 0.0, 0.0}), 0.01);
  EXPECT_NEAR(distance_to_way_m(hand, {end_m + 0.01, 0.0, 0.0}), 0.01, 1e-15);
  EXPECT_DOUBLE_EQ(distance_to_way_m(hand_at(0.0), {0.03, 0.04, 0.0}), 0.05);
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
  std::vector<CheapGroup> groups_;
  std::vector<WorkUnit> units_{{.index = 0, .vertex = {0, 1, 2, 3, 4}},
                               {.index = 1, .vertex = {5, 6, 7, 8, 9}},
                               {.index = 2, .is_check = true, .vertex = {9}}};
};

TEST_F(WorkBoardTest, TheNearestGroupComesFirst) {
  WorkBoard board = this->board();
  const std::vector<HandPlace> hands{hand_at(0.71)};
  EXPECT_EQ(board.next(hands, kMay).group, 7U);
}

TEST_F(WorkBoardTest, OneTakesGroupsAndOthersTheUnitsNearTheHand) {
  WorkBoard board = this->board();
  const std::vector<HandPlace> hands{hand_at(0.75)};
  EXPECT_TRUE(board.next(hands, kMay).group);
  EXPECT_EQ(board.next(hands, kMay).unit, 1U);
  EXPECT_EQ(board.next(hands, kMay).unit, 0U);
  EXPECT_EQ(board.next(hands, kMay).unit, 2U);  // checks last
  EXPECT_TRUE(board.next(hands, kMay).group);   // what is left
}

TEST_F(WorkBoardTest, GroupsAtTheHandComeBeforeUnits) {
  WorkBoard board = this->board();
  EXPECT_TRUE(board.next({}, kMay).group);
  EXPECT_EQ(board.next(std::vector{hand_at(0.9)}, kMay).group, 9U);
}

TEST_F(WorkBoardTest, AUnitThatAnotherHasIsNotTaken) {
  WorkBoard board = this->board();
  (void)board.next({}, kMay);
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
  EXPECT_EQ(board.next({}, kMay).group, 5U);
}

TEST_F(WorkBoardTest, EverythingIsHandedOutOnce) {
  WorkBoard board = this->board();
  std::set<std::size_t> groups;
  std::set<std::size_t> units;
  for (int i = 0; i < 13; ++i) {
    const NextWork work = board.next({}, kMay);
    if (work.group) {
      EXPECT_TRUE(groups.insert(*work.group).second);
    } else {
      ASSERT_TRUE(work.unit);
      EXPECT_TRUE(units.insert(*work.unit).second);
    }
  }
  const NextWork none = board.next({}, kMay);
  EXPECT_FALSE(none.group || none.unit);
  EXPECT_EQ(board.unfinished(), 3U);
  for (const std::size_t unit : units) {
    board.finish_unit(unit);
  }
  EXPECT_EQ(board.unfinished(), 0U);
}

}  // namespace
}  // namespace palpate
