#include "fitting/curve/press_cycles.h"

#include <cmath>

#include <gtest/gtest.h>

#include "fitting/curve/split_presses.h"
#include "formats/base/error.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

// Presses of 5 mm, each met 0.1 mm deeper than the one before and giving `back` of its
// force while released.
Measurement cycles(int count, double back) {
  Measurement m;
  for (int k = 0; k < count; ++k) {
    const double free_m = 2e-3 + 1e-4 * k;
    const auto press = synthetic({.noise_n = 1e-3, .free_m = free_m, .offset_n = 0.3},
                                 static_cast<unsigned>(k) + 1);
    for (std::size_t i = 0; i < press.depth_m.size(); ++i) {
      m.depth_m.push_back(press.depth_m[i]);
      m.force_n.push_back(press.force_n[i]);
    }
    for (std::size_t i = press.depth_m.size(); i-- > 0;) {
      m.depth_m.push_back(press.depth_m[i]);
      m.force_n.push_back(0.3 + back * (press.force_n[i] - 0.3));
    }
  }
  return m;
}

TEST(PressCycles, AreToldByForceWorkLossAndShift) {
  const auto presses = split_presses(cycles(3, 0.8));
  const auto told = summarise_cycles(presses, nullptr);
  ASSERT_EQ(told.size(), 3U);
  const double work = 5e-3 / 2.5;  // of 1 N (d / D)^1.5
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(told[k].bad, "");
    EXPECT_NEAR(told[k].peak_force_n, 1.0, 0.01);
    EXPECT_NEAR(told[k].press_work_j, work, 0.02 * work);
    EXPECT_NEAR(told[k].loss_j, 0.2 * work, 0.01 * work);
    EXPECT_NEAR(told[k].loss_factor, 0.2 / (3.141593 * 1.8), 1e-3);
    EXPECT_NEAR(told[k].contact_shift_m, 1e-4 * (static_cast<double>(k) - 2.0), 3e-5);
  }
  EXPECT_TRUE(summarise_cycles({presses[0]}, nullptr).empty());
}

TEST(PressCycles, AFrameTakesNothingOfTheLoss) {
  Measurement m = cycles(2, 0.8);
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    m.depth_m[i] += (m.force_n[i] - 0.3) / 500.0;
  }
  const FrameCompliance frame = linear_frame(500.0);
  const auto presses = split_presses(m);
  const auto with = summarise_cycles(presses, &frame);
  const auto without = summarise_cycles(presses, nullptr);
  ASSERT_EQ(with.size(), 2U);
  EXPECT_NEAR(with[0].press_work_j, 2e-3, 0.05e-3);
  EXPECT_NEAR(with[0].loss_j, without[0].loss_j, 0.02 * with[0].loss_j);
  EXPECT_GT(without[0].press_work_j, 2.5e-3);  // with the frame's 1 mJ
}

TEST(PressCycles, ABadPressDoesNotStopTheOthers) {
  auto presses = split_presses(cycles(3, 0.8));
  presses[1].depth_m.resize(4);
  presses[1].force_n.resize(4);
  const auto told = summarise_cycles(presses, nullptr);
  EXPECT_NE(told[1].bad, "");
  EXPECT_EQ(told[0].bad, "");
}

TEST(PressCycles, AreChosenByWordOrNumber) {
  using Numbers = std::vector<std::size_t>;
  EXPECT_EQ(chosen_cycles(parse_cycle("first"), 3), Numbers{1});
  EXPECT_EQ(chosen_cycles(parse_cycle("last"), 3), Numbers{3});
  EXPECT_EQ(chosen_cycles(parse_cycle("2"), 3), Numbers{2});
  EXPECT_EQ(chosen_cycles(parse_cycle("all"), 3), (Numbers{1, 2, 3}));
  EXPECT_THROW((void)chosen_cycles(parse_cycle("4"), 3), InputError);
  for (const char* wrong :
       {"", "0", "-1", "2nd", "1.5", "Last", "99999999999999999999"}) {
    EXPECT_THROW((void)parse_cycle(wrong), InputError) << wrong;
  }
  for (const char* text : {"first", "last", "all", "7"}) {
    EXPECT_EQ(cycle_text(parse_cycle(text)), text);
  }
}

}  // namespace
}  // namespace palpate
