#include "precompute/press/recipe.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr PressPolicy kPolicy{
    .nonlinear = true, .far_excess_max = 0.005, .depth_error_max = 0.015};
constexpr Outcome kGood{.samples = 21, .near_gradient = 0.05};

// Judges attempts as presses do, and goes on until nothing is left to try.
std::vector<Attempt> follow(const PressPolicy& policy, Outcome first,
                            const std::vector<Outcome>& others) {
  std::vector<Attempt> tried{{.recipe = policy.first, .outcome = first}};
  std::size_t k = 0;
  for (auto more = next(tried, policy); more && k < others.size();
       more = next(tried, policy)) {
    more->outcome = others[k++];
    more->taken =
        is_better(tried[last_taken(tried)].outcome, more->reason, more->outcome);
    tried.push_back(*more);
  }
  EXPECT_EQ(k, others.size()) << "fewer were tried";
  EXPECT_FALSE(next(tried, policy)) << "more would be tried";
  return tried;
}

Outcome failed(std::size_t samples) {
  return {.samples = samples, .failed = true};
}

TEST(Recipe, APressThatDoesIsNotRepeated) {
  EXPECT_EQ(follow(kPolicy, kGood, {}).size(), 1U);
  EXPECT_EQ(history_text(follow(kPolicy, kGood, {})), "");
}

TEST(Recipe, ALateTouchIsPressedOnFinerMeshesAsLongAsTheyAnswer) {
  Outcome late = kGood;
  late.late = true;
  const auto tried = follow(kPolicy, late, {late, kGood});
  EXPECT_EQ(tried[1].recipe.times_finer, 2.0);
  EXPECT_EQ(tried[2].recipe.times_finer, 4.0);
  EXPECT_EQ(last_taken(tried), 2U);
  EXPECT_TRUE(is_alone(tried));
  EXPECT_EQ(follow(kPolicy, late, {late, late, late}).back().recipe.times_finer, 8.0);
  Outcome nothing = late;
  nothing.samples = 1;
  const auto in_vain = follow(kPolicy, late, {nothing});
  EXPECT_EQ(last_taken(in_vain), 0U);
  EXPECT_FALSE(is_alone(in_vain));
  EXPECT_EQ(history_text(in_vain), "touches late: mesh 2 times finer, not taken");
}

TEST(Recipe, AFinerMeshThatFailsNoFartherIsNotTaken) {
  Outcome late = kGood;
  late.late = true;
  late.samples = 10;
  EXPECT_EQ(last_taken(follow(kPolicy, late, {failed(10)})), 0U);
}

TEST(Recipe, AfterCoarserMeshesNoFinerOnesAreTried) {
  Outcome late = kGood;
  late.late = true;
  late.samples = 12;
  EXPECT_EQ(last_taken(follow(kPolicy, failed(8), {late})), 1U);
}

TEST(Recipe, AFailedPressGoesToCoarserMeshesAndTheFarthestIsTaken) {
  const auto tried = follow(kPolicy, failed(8), {failed(7), failed(12)});
  EXPECT_EQ(tried[1].recipe.times_finer, 0.5);
  EXPECT_EQ(tried[1].recipe.depths, SolvedDepths::kEvery);
  EXPECT_TRUE(tried[1].recipe.stiff);
  EXPECT_FALSE(tried[1].taken);
  EXPECT_EQ(tried[2].recipe.times_finer, 0.25);
  EXPECT_EQ(last_taken(tried), 2U);
  EXPECT_EQ(history_text(tried),
            "failed: mesh 2 times coarser, every depth, stiff contact, not taken; "
            "failed: mesh 4 times coarser, every depth, stiff contact");
  // Done on the first coarser one.
  EXPECT_EQ(follow(kPolicy, failed(8), {kGood}).size(), 2U);
  // On a coarser mesh that meets late, only a longer path is taken.
  Outcome late = kGood;
  late.late = true;
  late.samples = 8;
  EXPECT_EQ(last_taken(follow(kPolicy, failed(8), {late, kGood})), 2U);
}

TEST(Recipe, AFailedLinearPressIsTheEnd) {
  PressPolicy linear = kPolicy;
  linear.nonlinear = false;
  EXPECT_EQ(follow(linear, failed(0), {}).size(), 1U);
}

TEST(Recipe, AFinerMeshThatFailsFartherOnIsTakenAndThenCoarserOnesAreTried) {
  Outcome late = kGood;
  late.late = true;
  late.samples = 10;
  const auto tried = follow(kPolicy, late, {failed(12), failed(1), kGood});
  EXPECT_EQ(tried[1].reason, Reason::kTouchesLate);
  EXPECT_TRUE(tried[1].taken);
  EXPECT_EQ(tried[2].recipe.times_finer, 0.5);
  EXPECT_FALSE(tried[2].taken);
  EXPECT_EQ(tried[3].recipe.times_finer, 0.25);
}

TEST(Recipe, MoreOfTheBodyIsNearUntilTheRestMissesLittle) {
  Outcome much = kGood;
  much.far_excess_relative = 0.02;
  Outcome less = much;
  less.near_gradient = 0.015;
  const auto tried = follow(kPolicy, much, {less, kGood});
  EXPECT_DOUBLE_EQ(tried[1].recipe.near_gradient, 0.015);
  EXPECT_DOUBLE_EQ(tried[2].recipe.near_gradient, 0.0045);
  EXPECT_EQ(tried[2].recipe.times_finer, 1.0);
  EXPECT_FALSE(is_alone(tried));
  EXPECT_EQ(follow(kPolicy, much, {less, less}).size(), 3U) << "twice at most";
  // What fails with more of it near is not taken, and is no reason for coarser meshes.
  EXPECT_EQ(last_taken(follow(kPolicy, much, {failed(3)})), 0U);
}

TEST(Recipe, EveryDepthIsSolvedWhereAFewDoNotTellTheRest) {
  Outcome unsure = kGood;
  unsure.between_error = 0.02;
  const auto tried = follow(kPolicy, unsure, {kGood});
  EXPECT_EQ(tried[1].recipe.depths, SolvedDepths::kEvery);
  EXPECT_FALSE(tried[1].recipe.stiff);
  EXPECT_EQ(history_text(tried),
            "solved depths do not tell those between them: every depth");
  // Where that fails the few are kept.
  EXPECT_EQ(last_taken(follow(kPolicy, unsure, {failed(5)})), 0U);
  // A near-singular path only where it would err twice as much, and then in stiff
  // contact.
  unsure.near_singular = true;
  EXPECT_EQ(follow(kPolicy, unsure, {}).size(), 1U);
  unsure.between_error = 0.04;
  EXPECT_TRUE(follow(kPolicy, unsure, {kGood})[1].recipe.stiff);
}

TEST(Recipe, EveryDepthKeepsTheNearFieldThatWasFound) {
  Outcome much = kGood;
  much.far_excess_relative = 0.02;
  Outcome unsure = kGood;
  unsure.between_error = 0.1;
  const auto tried = follow(kPolicy, much, {unsure, kGood});
  EXPECT_EQ(tried[2].recipe.depths, SolvedDepths::kEvery);
  EXPECT_DOUBLE_EQ(tried[2].recipe.near_gradient, 0.015);
}

TEST(Recipe, ACoarserMeshHasItsOwnNearField) {
  Outcome much = kGood;
  much.far_excess_relative = 0.02;
  const auto tried = follow(kPolicy, failed(4), {much, kGood});
  EXPECT_EQ(tried[1].reason, Reason::kFailed);
  EXPECT_EQ(tried[2].reason, Reason::kFarExcess);
  EXPECT_EQ(tried[2].recipe.times_finer, 0.5);
  EXPECT_TRUE(is_alone(tried));
}

TEST(Recipe, AMeshThatWasNotTakenIsLeft) {
  Outcome late = kGood;
  late.late = true;
  Outcome unsure = kGood;
  unsure.between_error = 0.1;
  unsure.samples = 1;
  const std::vector<Attempt> tried{{.outcome = late},
                                   {.recipe = {.times_finer = 2.0},
                                    .reason = Reason::kTouchesLate,
                                    .outcome = unsure,
                                    .taken = false}};
  EXPECT_FALSE(next(tried, kPolicy));
}

TEST(Recipe, AMeshThatWasMadeCoarserDoesNotMoveTheOthers) {
  PressPolicy policy = kPolicy;
  policy.first.times_finer = 2.0;
  Outcome late = kGood;
  late.late = true;
  std::vector<Attempt> tried{
      {.recipe = {.times_finer = 1.0}, .reason = Reason::kNoMesh, .outcome = late}};
  EXPECT_EQ(next(tried, policy)->recipe.times_finer, 4.0);
  EXPECT_EQ(history_text(tried), "the mesh cannot be made: mesh as fine as usual");
}

TEST(Recipe, AFinerLinearPressIsTakenIfItErrsLessOrTheFirstTouchedLate) {
  Outcome before = kGood;
  before.error_relative = 0.08;
  Outcome again = kGood;
  again.error_relative = 0.09;
  EXPECT_FALSE(is_better(before, Reason::kOutsideBudget, again));
  before.late = true;
  EXPECT_TRUE(is_better(before, Reason::kOutsideBudget, again));
  before.late = false;
  again.error_relative = 0.03;
  EXPECT_TRUE(is_better(before, Reason::kOutsideBudget, again));
  again.failed = true;
  EXPECT_FALSE(is_better(before, Reason::kOutsideBudget, again));
}

}  // namespace
}  // namespace palpate
