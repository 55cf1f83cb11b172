#include "runtime/memory/surface_memory.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

namespace palpate {
namespace {

ElementMemory two_terms(std::int32_t bundles = 1) {
  ElementMemory memory;
  memory.terms = 2;
  memory.bundles = bundles;
  memory.relaxation_s = {0.5, 4.0, 0.0, 0.0};
  return memory;
}

std::unique_ptr<SurfaceMemory> memory_of(const ElementMemory& element) {
  auto memory = std::make_unique<SurfaceMemory>();
  take_terms(*memory, element);
  return memory;
}

// Sites of one set: their rows collide.
std::int32_t in_one_set(int i, std::int32_t bundles = 1) {
  const int rows = std::min<int>(kMemorySites, kMemoryBundleRows / bundles);
  return 3 + i * (rows / kMemoryWays);
}

TEST(SurfaceMemory, TakesTimesOfTheFirstElementThatHasSome) {
  auto memory = std::make_unique<SurfaceMemory>();
  take_terms(*memory, ElementMemory{});
  EXPECT_FALSE(remembers(*memory));
  take_terms(*memory, two_terms(3));
  EXPECT_TRUE(remembers(*memory));
  EXPECT_EQ(memory->times.terms, 2);
  EXPECT_EQ(memory->bundles, 3);
  EXPECT_EQ(memory->times.tau_s(1), 4.0);
  EXPECT_EQ(memory->times.rate_hz(0), 2.0);
  ElementMemory other = two_terms();
  other.relaxation_s[0] = 0.6;
  take_terms(*memory, other);
  EXPECT_EQ(memory->times.tau_s(0), 0.5);
  EXPECT_EQ(memory->bundles, 3);
}

TEST(SurfaceMemory, ElementsThatYieldAreKnownFromAnyOfThem) {
  auto memory = memory_of(two_terms());
  EXPECT_FALSE(memory->yields);
  ElementMemory yielding = two_terms();
  yielding.yields = true;
  take_terms(*memory, yielding);
  EXPECT_TRUE(memory->yields);
  take_terms(*memory, two_terms());
  EXPECT_TRUE(memory->yields);
}

TEST(SurfaceMemory, OtherTermsTimesOrBundlesAreNotRead) {
  const auto memory = memory_of(two_terms(3));
  EXPECT_TRUE(agrees(*memory, two_terms(3)));
  EXPECT_FALSE(agrees(*memory, two_terms(2)));
  ElementMemory other = two_terms(3);
  other.relaxation_s[1] = std::nextafter(4.0, 5.0);
  EXPECT_FALSE(agrees(*memory, other));
  other = two_terms(3);
  other.terms = 1;
  EXPECT_FALSE(agrees(*memory, other));
  // What stands behind the terms is nothing.
  other = two_terms(3);
  other.relaxation_s[3] = 7.0;
  EXPECT_TRUE(agrees(*memory, other));
}

TEST(SurfaceMemory, AClaimedRowBeginsEmptyAtThePresentTime) {
  auto memory = memory_of(two_terms(2));
  memory->time_s = 3.5;
  memory->relaxed_n.fill(TermValues::Constant(9.0));
  const int row = claim_site(*memory, 11);
  EXPECT_EQ(find_site(*memory, 11), row);
  EXPECT_EQ(memory->row[static_cast<std::size_t>(row)].time_s, 3.5);
  for (int bundle = 0; bundle < 2; ++bundle) {
    EXPECT_EQ(relaxed_forces(*memory, row, bundle).maxCoeff(), 0.0);
  }
  EXPECT_EQ(claim_site(*memory, 11), row);
  EXPECT_EQ(find_site(*memory, 12), -1);
}

TEST(SurfaceMemory, AFullSetForgetsTheSiteThatRemembersLeast) {
  for (const std::int32_t bundles : {1, 2, 8}) {
    auto memory = memory_of(two_terms(bundles));
    for (int i = 0; i < kMemoryWays; ++i) {
      const int row = claim_site(*memory, in_one_set(i, bundles));
      relaxed_forces(*memory, row, bundles - 1)(1) = i == 5 ? 0.25 : 1.0 + i;
    }
    EXPECT_EQ(memory->forgotten, 0U);
    const int row = claim_site(*memory, in_one_set(kMemoryWays, bundles));
    EXPECT_EQ(memory->forgotten, 1U);
    EXPECT_EQ(relaxed_forces(*memory, row, bundles - 1)(1), 0.0);
    for (int i = 0; i < kMemoryWays; ++i) {
      EXPECT_EQ(find_site(*memory, in_one_set(i, bundles)) < 0, i == 5) << bundles;
    }
  }
}

TEST(SurfaceMemory, ASiteWithoutADentGivesWayAndIsNotCounted) {
  auto memory = memory_of(two_terms());
  for (int i = 0; i < kMemoryWays; ++i) {
    const int row = claim_site(*memory, in_one_set(i));
    relaxed_forces(*memory, row, 0)(0) = i == 2 ? 0.0 : 1.0;
  }
  (void)claim_site(*memory, in_one_set(kMemoryWays));
  EXPECT_EQ(find_site(*memory, in_one_set(2)), -1);
  EXPECT_EQ(memory->forgotten, 0U);
}

// Rows of different sites and bundles do not lie on one another.
TEST(SurfaceMemory, ABodyWithAsManySitesAsRowsLosesNone) {
  for (const std::int32_t bundles : {1, 2, 8}) {
    auto memory = memory_of(two_terms(bundles));
    const int sites = std::min<int>(kMemorySites, kMemoryBundleRows / bundles);
    for (std::int32_t site = 0; site < sites; ++site) {
      const int row = claim_site(*memory, site);
      for (int bundle = 0; bundle < bundles; ++bundle) {
        relaxed_forces(*memory, row, bundle).setConstant(1.0 + site + 0.01 * bundle);
      }
    }
    EXPECT_EQ(memory->forgotten, 0U);
    for (std::int32_t site = 0; site < sites; ++site) {
      const int row = find_site(*memory, site);
      ASSERT_GE(row, 0);
      for (int bundle = 0; bundle < bundles; ++bundle) {
        ASSERT_EQ(relaxed_forces(*memory, row, bundle)(0), 1.0 + site + 0.01 * bundle);
      }
    }
  }
}

// One term alone: s = g q, q' = (g q - q) / tau, so q falls as exp(-(1 - g) t / tau).
TEST(SurfaceMemory, OneTermRecoversAtTheRateOfWhatDoesNotRelax) {
  ElementMemory element;
  element.terms = 1;
  element.relaxation_s = {0.5, 0.0, 0.0, 0.0};
  const auto memory = memory_of(element);
  TermValues relaxed = TermValues::Zero(), relaxing = TermValues::Zero();
  relaxed(0) = 2.0;
  relaxing(0) = 0.4;
  for (const double time_s : {0.0, 0.1, 1.0, 3.0}) {
    EXPECT_NEAR(recovered(*memory, relaxed, relaxing, time_s)(0),
                2.0 * std::exp(-0.6 * time_s / 0.5), 1e-14)
        << time_s;
  }
  // Below a micronewton it is forgotten whole.
  EXPECT_EQ(recovered(*memory, relaxed, relaxing, 100.0)(0), 0.0);
}

TEST(SurfaceMemory, CarriedIsWhatRelaxedOfAllBundlesAtThePresentTime) {
  ElementMemory element;
  element.terms = 1;
  element.bundles = 2;
  element.relaxation_s = {0.5, 0.0, 0.0, 0.0};
  auto memory = memory_of(element);
  memory->time_s = 1.0;
  const int row = claim_site(*memory, 4);
  memory->row[static_cast<std::size_t>(row)].relaxing(0) = 0.4;
  relaxed_forces(*memory, row, 0)(0) = 2.0;
  relaxed_forces(*memory, row, 1)(0) = 3.0;
  EXPECT_NEAR(carried_n(*memory, row), 0.4 * 5.0, 1e-15);
  memory->time_s = 1.5;
  EXPECT_NEAR(carried_n(*memory, row), 0.4 * 5.0 * std::exp(-0.6), 1e-14);
  const int free = (row + 1) % kMemorySites;
  relaxed_forces(*memory, free, 0)(0) = 7.0;
  memory->row[static_cast<std::size_t>(free)].relaxing(0) = 0.4;
  EXPECT_EQ(carried_n(*memory, free), 0.0);
}

TEST(SurfaceMemory, ForgettingLeavesWhatHasYieldedAndTheCounts) {
  auto memory = memory_of(two_terms());
  const int row = claim_site(*memory, 4);
  relaxed_forces(*memory, row, 0)(0) = 2.0;
  (void)claim_yielded(yielded_of(*memory), 4);
  memory->forgotten = 3;
  memory->time_s = 2.0;
  forget_all(*memory);
  EXPECT_EQ(find_site(*memory, 4), -1);
  EXPECT_EQ(relaxed_forces(*memory, row, 0)(0), 0.0);
  EXPECT_GE(find_yielded(yielded_of(*memory), 4), 0);
  EXPECT_EQ(memory->forgotten, 3U);
  EXPECT_EQ(memory->time_s, 2.0);
}

TEST(SurfaceMemory, SharedYieldingIsRead) {
  auto memory = memory_of(two_terms());
  auto shared = std::make_unique<YieldedSites>();
  memory->shared = shared.get();
  (void)claim_yielded(yielded_of(*memory), 9);
  EXPECT_GE(find_yielded(*shared, 9), 0);
  EXPECT_EQ(find_yielded(memory->yielded, 9), -1);
}

}  // namespace
}  // namespace palpate
