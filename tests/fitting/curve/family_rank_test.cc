#include "fitting/curve/family_rank.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

FamilyFit ranked_fit(const std::string& family, double deviance, int parameters) {
  FamilyFit one;
  one.family = family;
  one.deviance = deviance;
  one.free_parameters = parameters;
  one.converged = true;
  return one;
}

std::vector<std::string> ranked(FamilyChoice choice) {
  choice.force_n.assign(100, 0.0);
  rank_fits(choice);
  std::vector<std::string> order;
  for (const FamilyFit& one : choice.fits) {
    order.push_back(one.family);
  }
  return order;
}

TEST(FamilyRank, IsByTheCriterion) {
  FamilyChoice choice;
  choice.fits = {ranked_fit("many", 40.0, 20), ranked_fit("few", 58.0, 5)};
  choice.fits[0].cross_rms_n = 1.0;
  choice.fits[1].cross_rms_n = 2.0;
  // AICc 40 + 2 20 100 / 79 = 90.6 and 68.6; BIC 132.1 and 81.0.
  EXPECT_EQ(ranked(choice).front(), "few");
  choice.criterion = "cross-validation";
  EXPECT_EQ(ranked(choice).front(), "many");
  choice.criterion = "bic";
  choice.fits = {ranked_fit("bic", 44.0, 2),
                 ranked_fit("aic", 40.0, 3)};  // 53.2 and 53.8
  EXPECT_EQ(ranked(choice).front(), "bic");
  choice.criterion = "aicc";  // 48.1 and 46.3
  EXPECT_EQ(ranked(choice).front(), "aic");
}

TEST(FamilyRank, WhatMissesOrDidNotConvergeComesLast) {
  FamilyChoice choice;
  choice.fits = {ranked_fit("lost", 1.0, 3), ranked_fit("misses", 2.0, 3),
                 ranked_fit("misses more", 1.0, 3), ranked_fit("right", 50.0, 3)};
  choice.fits[0].converged = false;
  choice.fits[1].misses = choice.fits[2].misses = true;
  choice.fits[1].rms_n = 1.0;
  choice.fits[2].rms_n = 2.0;
  EXPECT_EQ(ranked(choice),
            (std::vector<std::string>{"right", "misses", "misses more", "lost"}));
}

TEST(FamilyRank, AFallIsOnlyTakenWhereItIsDecisivelyBetter) {
  FamilyChoice choice;
  choice.fits = {ranked_fit("interpolating", 21.0, 3), ranked_fit("rising", 50.0, 3)};
  EXPECT_EQ(ranked(choice).front(), "rising");
  choice.fits[0].deviance = 19.0;
  EXPECT_EQ(ranked(choice).front(), "interpolating");
}

TEST(FamilyRank, AFewSamplesForItsParametersAreNoAnswer) {
  FamilyChoice choice;
  choice.fits = {ranked_fit("all", 0.0, 99), ranked_fit("few", 1000.0, 3)};
  EXPECT_EQ(ranked(choice).front(), "few");
}

}  // namespace
}  // namespace palpate
