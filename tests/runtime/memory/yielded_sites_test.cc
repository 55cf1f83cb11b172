#include "runtime/memory/yielded_sites.h"

#include <memory>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// More sites of one row than it may reach.
constexpr int kColliding = 64;

TEST(YieldedSites, NothingHasStayedAtFirst) {
  const auto sites = std::make_unique<YieldedSites>();
  EXPECT_EQ(find_yielded(*sites, 0), -1);
  EXPECT_EQ(find_yielded(*sites, kYieldedSites + 5), -1);
  EXPECT_EQ(sites->count, 0);
}

TEST(YieldedSites, ASiteKeepsItsRow) {
  const auto sites = std::make_unique<YieldedSites>();
  const int row = claim_yielded(*sites, 17);
  ASSERT_GE(row, 0);
  sites->row[static_cast<std::size_t>(row)].dent_m = 1e-3;
  EXPECT_EQ(claim_yielded(*sites, 17), row);
  EXPECT_EQ(find_yielded(*sites, 17), row);
  EXPECT_EQ(sites->row[static_cast<std::size_t>(row)].dent_m, 1e-3);
  EXPECT_EQ(sites->count, 1);
}

TEST(YieldedSites, SitesOfOneRowLieInTheNextOnesAndAreAllFound) {
  const auto sites = std::make_unique<YieldedSites>();
  // The last rows of the table: those that follow begin anew at the first.
  for (int i = 0; i < kColliding; ++i) {
    const std::int32_t site = kYieldedSites - 3 + i * kYieldedSites;
    const int row = claim_yielded(*sites, site);
    EXPECT_EQ(row, (kYieldedSites - 3 + i) % kYieldedSites);
    EXPECT_EQ(sites->row[static_cast<std::size_t>(row)].site, site);
  }
  EXPECT_EQ(sites->count, kColliding);
  for (int i = 0; i < kColliding; ++i) {
    EXPECT_EQ(find_yielded(*sites, kYieldedSites - 3 + i * kYieldedSites),
              (kYieldedSites - 3 + i) % kYieldedSites);
  }
}

TEST(YieldedSites, WithoutARowASiteGetsNoneAndIsCounted) {
  const auto sites = std::make_unique<YieldedSites>();
  for (int i = 0; i < kColliding; ++i) {
    ASSERT_GE(claim_yielded(*sites, i * kYieldedSites), 0);
  }
  EXPECT_EQ(claim_yielded(*sites, kColliding * kYieldedSites), -1);
  EXPECT_EQ(find_yielded(*sites, kColliding * kYieldedSites), -1);
  EXPECT_EQ(sites->refused, 1U);
  EXPECT_EQ(sites->count, kColliding);
  // Those that have a row keep it, and other places still get one.
  EXPECT_GE(claim_yielded(*sites, 0), 0);
  EXPECT_GE(claim_yielded(*sites, kColliding), 0);
  EXPECT_EQ(sites->refused, 1U);
}

TEST(YieldedSites, ABodyWithAsManySitesAsRowsLosesNone) {
  const auto sites = std::make_unique<YieldedSites>();
  for (std::int32_t site = 0; site < kYieldedSites; ++site) {
    ASSERT_EQ(claim_yielded(*sites, site), site);
  }
  EXPECT_EQ(sites->count, kYieldedSites);
  EXPECT_EQ(claim_yielded(*sites, kYieldedSites), -1);
}

}  // namespace
}  // namespace palpate
