#include "runtime/memory/sites_at_hand.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Three corners that share five sites between them; two terms.
Element element_of_five_sites() {
  Element element;
  element.triangle = 0;
  element.memory.terms = 2;
  element.memory.relaxation_s = {0.4, 4.0};
  element.memory.node[0] = {
      .site = {10, 11, -1, -1}, .weight = {0.6, 0.4}, .relaxing = {0.2, 0.3}};
  element.memory.node[1] = {
      .site = {11, 12, 13, -1}, .weight = {0.5, 0.25, 0.25}, .relaxing = {0.1, 0.5}};
  element.memory.node[2] = {
      .site = {13, 10, 14, 12}, .weight = {0.4, 0.3, 0.2, 0.1}, .relaxing = {0.3, 0.1}};
  return element;
}

class SitesAtHandTest : public testing::Test {
 protected:
  SitesAtHandTest() {
    take_terms(*memory_, element_.memory);
    sites_ = sites_of(element_, {}, *memory_);
    weigh(sites_, weight_, turn_);
  }

  // Every site another force.
  void fill(std::uint32_t seed, double largest_n) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> force(0.0, largest_n);
    for (std::size_t i = 0; i < sites_.count; ++i) {
      sites_.relaxed_n[0][i] = {force(random), force(random), 0.0, 0.0};
    }
  }

  [[nodiscard]] TermValues blend() const { return blended(sites_, 0).relaxed_n.value; }

  std::unique_ptr<SurfaceMemory> memory_ = std::make_unique<SurfaceMemory>();
  Element element_ = element_of_five_sites();
  SitesAtHand sites_;
  NodeValues weight_{0.2, 0.5, 0.3, 0.0};
  Turn turn_ = (Turn() << -1.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0).finished();
};

TEST_F(SitesAtHandTest, WeightsOfSitesAreAPartitionOfUnity) {
  ASSERT_EQ(sites_.count, 5U);
  double all = 0.0;
  double turned = 0.0;
  for (std::size_t i = 0; i < sites_.count; ++i) {
    all += sites_.weight[i].value;
    turned += std::abs(sites_.weight[i].by_1);
  }
  EXPECT_NEAR(all, 1.0, 1e-15);
  EXPECT_GT(turned, 0.5);
  EXPECT_NEAR(sites_.weight[0].value, 0.2 * 0.6 + 0.3 * 0.3, 1e-15);
}

TEST_F(SitesAtHandTest, CarriedForceAndItsSlopesAreThoseOfTheBlend) {
  fill(1, 2.0);
  const BlendedMemory at = blended(sites_, 0);
  const Vector3 slope = carried_slope_n(sites_, at);
  const double step = 1e-6;
  for (const int axis : {1, 2}) {
    NodeValues moved = weight_;
    moved(0) -= step;
    moved(axis) += step;
    SitesAtHand beside = sites_;
    weigh(beside, moved, turn_);
    const double difference = blended(beside, 0).carried_n - at.carried_n;
    EXPECT_NEAR(difference / step, slope(axis - 1), 1e-5) << axis;
  }
}

TEST_F(SitesAtHandTest, TheBlendMovesExactlyWhateverTheSitesAre) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    for (const double share : {1e-6, 0.03, 0.5, 0.99, 1.0}) {
      fill(seed, 3.0);
      const SitesAtHand before = sites_;
      const TermValues from = blend();
      const double target = 0.015 * seed;
      Turned<TermValues> moved = blended(sites_, 0).relaxed_n;
      move_towards(sites_, 0, from, target, TermValues::Constant(share), moved);
      const TermValues wanted = from + share * (target - from);
      ASSERT_NEAR((blend() - wanted).head<2>().abs().maxCoeff(), 0.0, 1e-13)
          << seed << " " << share;
      const Turned<TermValues> now = blended(sites_, 0).relaxed_n;
      ASSERT_NEAR((now.by_1 - moved.by_1).abs().maxCoeff(), 0.0, 1e-13);
      ASSERT_NEAR((now.by_2 - moved.by_2).abs().maxCoeff(), 0.0, 1e-13);
      for (std::size_t i = 0; i < sites_.count; ++i) {
        for (Eigen::Index k = 0; k < 2; ++k) {
          const double was = before.relaxed_n[0][i](k);
          const double is = sites_.relaxed_n[0][i](k);
          // Towards the target and not past it, or not at all.
          ASSERT_GE((target - was) * (target - is), -1e-15) << seed << " " << share;
          ASSERT_LE(std::abs(target - is), std::abs(target - was) + 1e-15);
        }
      }
    }
  }
}

TEST_F(SitesAtHandTest, SitesOnTheOtherSideStay) {
  for (std::size_t i = 0; i < sites_.count; ++i) {
    sites_.relaxed_n[0][i] = {i == 2 ? 3.0 : 0.5, 0.0, 0.0, 0.0};
  }
  const TermValues from = blend();
  ASSERT_LT(from(0), 1.0);
  Turned<TermValues> moved = blended(sites_, 0).relaxed_n;
  move_towards(sites_, 0, from, 1.0, TermValues::Constant(0.4), moved);
  EXPECT_EQ(sites_.relaxed_n[0][2](0), 3.0);
  EXPECT_NEAR(blend()(0), from(0) + 0.4 * (1.0 - from(0)), 1e-14);
}

TEST_F(SitesAtHandTest, HeavierSitesGoFaster) {
  Turned<TermValues> moved = blended(sites_, 0).relaxed_n;
  move_towards(sites_, 0, TermValues::Zero(), 1.0, TermValues::Constant(0.01), moved);
  for (std::size_t i = 1; i < sites_.count; ++i) {
    EXPECT_NEAR(sites_.relaxed_n[0][i](0) / sites_.relaxed_n[0][0](0),
                sites_.weight[i].value / sites_.weight[0].value, 1e-12)
        << i;
  }
}

TEST_F(SitesAtHandTest, WhatIsPutBackComesBack) {
  fill(3, 2.0);
  memory_->time_s = 5.0;
  sites_.time_s = 5.0;
  put_back(sites_, *memory_);
  const SitesAtHand again = sites_of(element_, {}, *memory_);
  for (std::size_t i = 0; i < sites_.count; ++i) {
    EXPECT_TRUE((again.relaxed_n[0][i] == sites_.relaxed_n[0][i]).all()) << i;
  }
  // Two seconds later it has gone back by itself.
  memory_->time_s = 7.0;
  const SitesAtHand later = sites_of(element_, {}, *memory_);
  const TermValues wanted =
      recovered(*memory_, sites_.relaxed_n[0][1], sites_.relaxing[1], 2.0);
  EXPECT_TRUE((later.relaxed_n[0][1] == wanted).all());
  EXPECT_LT(wanted.maxCoeff(), sites_.relaxed_n[0][1].maxCoeff());
}

TEST_F(SitesAtHandTest, WhatIsAtHandIsNewerThanTheTable) {
  fill(4, 2.0);
  put_back(sites_, *memory_);
  const TermValues newer{0.1, 0.2, 0.0, 0.0};
  sites_.relaxed_n[0][3] = newer;
  EXPECT_TRUE((sites_of(element_, sites_, *memory_).relaxed_n[0][3] == newer).all());
}

TEST_F(SitesAtHandTest, UntouchedSitesTakeNoRow) {
  put_back(sites_, *memory_);
  for (std::size_t i = 0; i < sites_.count; ++i) {
    EXPECT_EQ(find_site(*memory_, sites_.site[i]), -1);
  }
}

TEST(SurfaceMemoryTest, ABodyWithNoMoreSitesThanRowsLosesNone) {
  const auto memory = std::make_unique<SurfaceMemory>();
  take_terms(*memory, {.terms = 1, .relaxation_s = {1.0}});
  for (int site = 0; site < kMemorySites; ++site) {
    const int row = claim_site(*memory, site);
    relaxed_forces(*memory, row, 0)(0) = 1.0 + site;
  }
  EXPECT_EQ(memory->forgotten, 0U);
  for (int site = 0; site < kMemorySites; ++site) {
    ASSERT_EQ(relaxed_forces(*memory, find_site(*memory, site), 0)(0), 1.0 + site);
  }
}

TEST(SurfaceMemoryTest, ThenTheDentThatRemembersLeastGivesWay) {
  const auto memory = std::make_unique<SurfaceMemory>();
  take_terms(*memory, {.terms = 1, .relaxation_s = {1.0}});
  for (int site = 0; site < kMemorySites; ++site) {
    relaxed_forces(*memory, claim_site(*memory, site), 0)(0) =
        site == 3 * kMemorySites / kMemoryWays ? 0.01 : 1.0;
  }
  const int row = claim_site(*memory, kMemorySites);
  EXPECT_EQ(memory->forgotten, 1U);
  EXPECT_EQ(relaxed_forces(*memory, row, 0)(0), 0.0);
  EXPECT_EQ(find_site(*memory, 3 * kMemorySites / kMemoryWays), -1);
  EXPECT_GE(find_site(*memory, 0), 0);
}

TEST(SurfaceMemoryTest, ManyBundlesLeaveFewerRowsThatDoNotOverlap) {
  const auto memory = std::make_unique<SurfaceMemory>();
  take_terms(*memory, {.terms = 4, .bundles = 8, .relaxation_s = {1, 2, 3, 4}});
  const int rows = kMemoryBundleRows / 8;
  for (int site = 0; site < rows; ++site) {
    const int row = claim_site(*memory, site);
    for (int b = 0; b < 8; ++b) {
      relaxed_forces(*memory, row, b).setConstant(site * 8 + b + 1);
    }
  }
  EXPECT_EQ(memory->forgotten, 0U);
  for (int site = 0; site < rows; ++site) {
    for (int b = 0; b < 8; ++b) {
      ASSERT_EQ(relaxed_forces(*memory, find_site(*memory, site), b)(3),
                site * 8 + b + 1);
    }
  }
}

TEST(SurfaceMemoryTest, TermsAreThoseOfTheFirstElementThatHasSome) {
  const auto memory = std::make_unique<SurfaceMemory>();
  EXPECT_FALSE(remembers(*memory));
  const ElementMemory first{.terms = 2, .relaxation_s = {0.4, 4.0}};
  take_terms(*memory, first);
  ElementMemory other = first;
  EXPECT_TRUE(agrees(*memory, other));
  other.relaxation_s[1] = 5.0;
  take_terms(*memory, other);
  EXPECT_FALSE(agrees(*memory, other));
  other = first;
  other.bundles = 8;
  EXPECT_FALSE(agrees(*memory, other));
}

}  // namespace
}  // namespace palpate
