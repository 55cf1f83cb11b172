#include "formats/database/viscoelasticity_rules.h"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/formats/database/violation.h"
#include "tests/support/said.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

constexpr std::int64_t kRuledNodes = 6;

Viscoelasticity yielding_too() {
  Viscoelasticity relaxation = viscous();
  relaxation.yielding = {.yield_depth_m = {0.001},
                         .share = {0.2},
                         .onset_m = {0.0},
                         .scale_m = {0.002},
                         .largest = {0.5}};
  return relaxation;
}

using RelaxationViolation = Violation<Viscoelasticity>;
class ViscoelasticityRule : public testing::TestWithParam<RelaxationViolation> {};

TEST_P(ViscoelasticityRule, IsNamedWithDatasetRowAndValue) {
  Viscoelasticity relaxation = yielding_too();
  ASSERT_NO_THROW(check("/tools/ball", relaxation, kRuledNodes));
  GetParam().make(relaxation);
  EXPECT_THROW(check("/tools/ball", relaxation, kRuledNodes), FormatError);
  expect_says(refusal([&] {
                check("/tools/ball", relaxation, kRuledNodes);
              }),
              std::string("/tools/ball") + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Terms, ViscoelasticityRule,
    testing::Values(
        RelaxationViolation{"TooManyTimes",
                            [](Viscoelasticity& r) {
                              r.tau_s = {1.0, 2.0, 3.0, 4.0, 5.0};
                            },
                            "/relaxation/tau_s has 5 rows, must have 1 to 4"},
        RelaxationViolation{"TimesThatDoNotRise",
                            [](Viscoelasticity& r) {
                              r.tau_s[1] = r.tau_s[0];
                            },
                            "/relaxation/tau_s: element 1 is 0.5 after 0.5"},
        RelaxationViolation{"NoTime",
                            [](Viscoelasticity& r) {
                              r.tau_s[0] = 0.0;
                            },
                            "/relaxation/tau_s: element 0 is 0 after 0"},
        RelaxationViolation{"EndlessTime",
                            [](Viscoelasticity& r) {
                              r.tau_s[1] = std::numeric_limits<double>::infinity();
                            },
                            "/relaxation/tau_s: element 1 is inf"},
        RelaxationViolation{"NaNTime",
                            [](Viscoelasticity& r) {
                              r.tau_s[1] = kNaN;
                            },
                            "/relaxation/tau_s: element 1 is nan"},
        RelaxationViolation{"NoSpeed",
                            [](Viscoelasticity& r) {
                              r.speed_m_per_s = 0.0;
                            },
                            "/relaxation@speed_m_per_s is 0, must be positive"},
        RelaxationViolation{"NaNSpeed",
                            [](Viscoelasticity& r) {
                              r.speed_m_per_s = kNaN;
                            },
                            "/relaxation@speed_m_per_s is nan"},
        RelaxationViolation{"FewerThanNoProbes",
                            [](Viscoelasticity& r) {
                              r.probes = -1;
                            },
                            "/relaxation@probes is -1"},
        RelaxationViolation{"ARuleOfTwoLines",
                            [](Viscoelasticity& r) {
                              r.rule = "a\nb";
                            },
                            "/relaxation@rule is \"a\\nb\", must be one line"},
        RelaxationViolation{"TooManyBundles",
                            [](Viscoelasticity& r) {
                              r.bundle_depth_m = {1, 2, 3, 4, 5, 6, 7, 8};
                            },
                            "/memory/bundle_depth_m has 8 rows, must have 0 to 7"},
        RelaxationViolation{"BundlesThatDoNotRise",
                            [](Viscoelasticity& r) {
                              r.bundle_depth_m = {0.002, 0.001};
                            },
                            "/memory/bundle_depth_m: element 1 is 0.001 after 0.002"}));

INSTANTIATE_TEST_SUITE_P(
    Rows, ViscoelasticityRule,
    testing::Values(
        RelaxationViolation{"NegativeShare",
                            [](Viscoelasticity& r) {
                              r.g(3, 1) = -0.25F;
                            },
                            "/relaxation/g: row 3 has -0.25, must be at least 0"},
        RelaxationViolation{"NaNShare",
                            [](Viscoelasticity& r) {
                              r.g(2, 0) = std::numeric_limits<float>::quiet_NaN();
                            },
                            "/relaxation/g: row 2 has nan"},
        RelaxationViolation{"MoreThanAllRelaxes",
                            [](Viscoelasticity& r) {
                              r.g(4, 0) = 0.75F;
                            },
                            "/relaxation/g: row 4 sums to 1.05, must sum to at most 1"},
        RelaxationViolation{"SharesOfOtherTerms",
                            [](Viscoelasticity& r) {
                              r.tau_s = {1.0};
                            },
                            "/relaxation/g is 6 x 2, must be 1 or 6 x 1"},
        RelaxationViolation{"SharesOfOtherNodes",
                            [](Viscoelasticity& r) {
                              r.g.conservativeResize(5, 2);
                            },
                            "/relaxation/g is 5 x 2, must be 1 or 6 x 2"},
        RelaxationViolation{"ErrorsOfOtherNodes",
                            [](Viscoelasticity& r) {
                              r.error_relative.resize(2);
                            },
                            "/relaxation/error_relative has 2 rows, must have 1 or 6"},
        RelaxationViolation{"NegativeError",
                            [](Viscoelasticity& r) {
                              r.error_relative[1] = -0.5F;
                            },
                            "/relaxation/error_relative: row 1 has -0.5"}));

INSTANTIATE_TEST_SUITE_P(
    Sites, ViscoelasticityRule,
    testing::Values(
        RelaxationViolation{"ASiteThatIsNotThere",
                            [](Viscoelasticity& r) {
                              r.sites.site(1, 0) = 3;
                            },
                            "/memory/site: row 1 has 3, must lie in [-1, 2]"},
        RelaxationViolation{"ASiteBelowNone",
                            [](Viscoelasticity& r) {
                              r.sites.site(1, 3) = -2;
                            },
                            "/memory/site: row 1 has -2"},
        RelaxationViolation{"AWeightWithoutASite",
                            [](Viscoelasticity& r) {
                              r.sites.weight(5, 2) = 0.5F;
                            },
                            "/memory/weight: row 5 has 0.5 at site -1"},
        RelaxationViolation{"NegativeWeight",
                            [](Viscoelasticity& r) {
                              r.sites.weight.row(1) << -0.5F, 1.5F, 0.0F, 0.0F;
                            },
                            "/memory/weight: row 1 has -0.5"},
        RelaxationViolation{"WeightsOfLessThanAll",
                            [](Viscoelasticity& r) {
                              r.sites.weight(3, 1) = 0.25F;
                            },
                            "/memory/weight: row 3 sums to 0.75, must sum to 1"},
        RelaxationViolation{"NoSpacing",
                            [](Viscoelasticity& r) {
                              r.sites.spacing_m = 0.0;
                            },
                            "/memory@spacing_m is 0, must be positive"},
        RelaxationViolation{"SitesOfOtherNodes",
                            [](Viscoelasticity& r) {
                              r.sites.site.conservativeResize(5, 4);
                            },
                            "/memory/site is 5 x 4, must be 6 x 4"},
        RelaxationViolation{"WeightsOfFewerSites",
                            [](Viscoelasticity& r) {
                              r.sites.weight.conservativeResize(6, 3);
                            },
                            "/memory/weight is 6 x 3, must be 6 x 4"},
        RelaxationViolation{"ASiteAtNoNode",
                            [](Viscoelasticity& r) {
                              r.sites.node[2] = 6;
                            },
                            "/memory/site_node: row 2 has 6, must lie in [-1, 5]"}));

INSTANTIATE_TEST_SUITE_P(
    Yielding, ViscoelasticityRule,
    testing::Values(
        RelaxationViolation{"AllStays",
                            [](Viscoelasticity& r) {
                              r.yielding.share = {1.0};
                            },
                            "/plastic/share: row 0 has 1, must lie in [0, 1)"},
        RelaxationViolation{"AllSoftens",
                            [](Viscoelasticity& r) {
                              r.yielding.largest = {1.0};
                            },
                            "/damage/largest: row 0 has 1, must lie in [0, 1)"},
        RelaxationViolation{"NoScale",
                            [](Viscoelasticity& r) {
                              r.yielding.scale_m = {0.0};
                            },
                            "/damage/scale_m: row 0 has 0, must be positive"},
        RelaxationViolation{"NegativeOnset",
                            [](Viscoelasticity& r) {
                              r.yielding.onset_m = {-1e-3};
                            },
                            "/damage/onset_m: row 0 has -0.001, must be at least 0"},
        RelaxationViolation{"NaNDepth",
                            [](Viscoelasticity& r) {
                              r.yielding.yield_depth_m = {kNaN};
                            },
                            "/plastic/yield_depth_m: row 0 has nan"},
        RelaxationViolation{"RowsOfOtherNodes",
                            [](Viscoelasticity& r) {
                              r.yielding.share = {0.1, 0.1};
                            },
                            "/plastic/share has 2 rows, must have 1 or 6"},
        RelaxationViolation{"DentsWithoutADepth",
                            [](Viscoelasticity& r) {
                              r.yielding.yield_depth_m = {};
                            },
                            "/plastic has 1 of its 2 datasets, must have all"},
        RelaxationViolation{"SofteningWithoutAScale",
                            [](Viscoelasticity& r) {
                              r.yielding.scale_m = {};
                            },
                            "/damage has 2 of its 3 datasets, must have all"}));

TEST(ViscoelasticityRules, WhatIsJustRightIsRight) {
  Viscoelasticity relaxation = yielding_too();
  relaxation.tau_s = {1e-9, 2e300};
  relaxation.g.resize(1, 2);
  relaxation.g << 0.0F, 1.0F;  // all of it relaxes, alike at every node
  relaxation.error_relative = {0.0F};
  relaxation.instantaneous = true;
  relaxation.speed_m_per_s = 0.0;
  relaxation.yielding.share = {0.0, 0.1, 0.2, 0.3, 0.4, 0.999};
  EXPECT_NO_THROW(check("/tools/ball", relaxation, kRuledNodes));
  EXPECT_NO_THROW(check("/tools/ball", Viscoelasticity{}, kRuledNodes));
}

TEST(ViscoelasticityRules, RowsOfAChunkCountAsTheFileDoes) {
  Viscoelasticity relaxation = viscous();
  relaxation.g(3, 1) = -1.0F;
  expect_says(refusal([&] {
                check_node_rows("/t", relaxation, 6, 3, 100);
              }),
              "/t/relaxation/g: row 103");
  relaxation = viscous();
  relaxation.sites.site(2, 0) = 9;
  expect_says(refusal([&] {
                check_node_rows("/t", relaxation, 6, 9, 100);
              }),
              "/t/memory/site: row 102 has 9, must lie in [-1, 8]");
  EXPECT_EQ(refusal([&] {
              check_node_rows("/t", relaxation, 6, 10, 100);
            }),
            "");
  // A row for all nodes alike is the file's first.
  relaxation.g = RowsOf<float>::Constant(1, 2, 0.75F);
  expect_says(refusal([&] {
                check_node_rows("/t", relaxation, 6, 10, 100);
              }),
              "/t/relaxation/g: row 0 sums to 1.5");
  Yielding yielding{.yield_depth_m = std::vector<double>(6, 1e-3),
                    .share = {0.1, 0.1, 0.1, 0.1, 0.1, 2.0}};
  expect_says(refusal([&] {
                check_yielding("/t", yielding, 6, 100);
              }),
              "/t/plastic/share: row 105 has 2");
  yielding.share = {2.0};
  expect_says(refusal([&] {
                check_yielding("/t", yielding, 6, 100);
              }),
              "/t/plastic/share: row 0 has 2");
}

}  // namespace
}  // namespace palpate
