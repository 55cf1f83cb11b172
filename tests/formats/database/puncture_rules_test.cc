#include "formats/database/puncture_rules.h"

#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/database_rules.h"
#include "tests/formats/database/violation.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class BrokenPuncture : public testing::TestWithParam<Violation<Puncture>> {};

TEST_P(BrokenPuncture, IsRefusedByName) {
  ResponseDatabase database = small_database();
  Puncture& puncture = database.tools[1].puncture;
  puncture = some_puncture(6);
  const ScratchFolder folder;
  write_database(folder / "a.h5", database);
  GetParam().make(puncture);
  try {
    write_database(folder / "a.h5", database);
    FAIL() << "written";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
        << error.what();
  }
}

const std::vector<Violation<Puncture>> kHeadViolations{
    {"RuleUnknown",
     [](Puncture& p) {
       p.rule = "strain";
     },
     "/tools/ball/puncture@rule is \"strain\", must be \"force\" or \"energy\""},
    {"NoMaterials",
     [](Puncture& p) {
       p.material.clear();
     },
     "/tools/ball/puncture/material has 0 lines, must have 1 to 8"},
    {"NineMaterials",
     [](Puncture& p) {
       p.material = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
     },
     "/tools/ball/puncture/material has 9 lines, must have 1 to 8"},
    {"MaterialTwice",
     [](Puncture& p) {
       p.material[2] = "skin";
     },
     "/tools/ball/puncture/material: line 2 is \"skin\" as line 0 is, must be unique"},
    {"MaterialOfTwoLines",
     [](Puncture& p) {
       p.material[1] = "a\nb";
     },
     "/tools/ball/puncture/material: line 1 is \"a\\nb\", must be one line"},
    {"MembranesOfOthers",
     [](Puncture& p) {
       p.membrane_n.pop_back();
     },
     "/tools/ball/puncture/membrane_n has 2 rows, must have one per material: 3"},
    {"MembraneNotANumber",
     [](Puncture& p) {
       p.membrane_n[1] = kNaN;
     },
     "/tools/ball/puncture/membrane_n: row 1 has nan, must be at least 0"},
    {"CuttingNegative",
     [](Puncture& p) {
       p.cutting_n[0] = -0.5;
     },
     "/tools/ball/puncture/cutting_n: row 0 has -0.5, must be at least 0"},
    {"FrictionInfinite",
     [](Puncture& p) {
       p.friction_n_per_m[2] = std::numeric_limits<double>::infinity();
     },
     "/tools/ball/puncture/friction_n_per_m: row 2 has inf, must be at least 0 and "
     "finite"},
    {"ToughnessNegative",
     [](Puncture& p) {
       p.toughness_j_per_m2[0] = -1.0;
     },
     "/tools/ball/puncture/toughness_j_per_m2: row 0 has -1, must be at least 0 or not "
     "a number"},
    {"EdgeNegative",
     [](Puncture& p) {
       p.edge_width_m = -1e-3;
     },
     "/tools/ball/puncture@edge_width_m is -0.001, must be at least 0 and finite"},
    {"StaticBelowKinetic",
     [](Puncture& p) {
       p.static_ratio[1] = 0.9;
     },
     "/tools/ball/puncture/static_ratio: row 1 has 0.9, must be at least 1 and finite"},
    {"ShaftOfZero",
     [](Puncture& p) {
       p.shaft_n_per_m = 0.0;
     },
     "/tools/ball/puncture@shaft_n_per_m is 0, must be positive and finite"},
    {"LateralNotANumber",
     [](Puncture& p) {
       p.lateral_n_per_m2 = kNaN;
     },
     "/tools/ball/puncture@lateral_n_per_m2 is nan, must be at least 0 and finite"},
    {"MouthNegative",
     [](Puncture& p) {
       p.mouth_m = -1.0;
     },
     "/tools/ball/puncture@mouth_m is -1, must be positive and finite"},
    {"RadiusNegative",
     [](Puncture& p) {
       p.radius_m = -1e-3;
     },
     "/tools/ball/puncture@radius_m is -0.001, must be at least 0 and finite"},
    {"TipOfAHalfPlane",
     [](Puncture& p) {
       p.tip_angle_rad = 3.2;
     },
     "/tools/ball/puncture@tip_angle_rad is 3.2, must be in [0, pi)"},
    {"InsertableNotANumber",
     [](Puncture& p) {
       p.insertable_m = kNaN;
     },
     "/tools/ball/puncture@insertable_m is nan, must be at least 0 and finite"},
    {"MembraneEnergiesOfOthers",
     [](Puncture& p) {
       p.membrane_j = {1.0};
     },
     "/tools/ball/puncture/membrane_j has 1 rows, must have one per material: 3"},
    {"MembraneEnergyInfinite",
     [](Puncture& p) {
       p.membrane_j = {kNaN, std::numeric_limits<double>::infinity(), kNaN};
     },
     "/tools/ball/puncture/membrane_j: row 1 has inf, must be at least 0 and finite or "
     "not a number"},
};
INSTANTIATE_TEST_SUITE_P(OfTheTool, BrokenPuncture, testing::ValuesIn(kHeadViolations),
                         [](const auto& violation) {
                           return violation.param.name;
                         });

const std::vector<Violation<Puncture>> kNodeViolations{
    {"RupturesOfOthers",
     [](Puncture& p) {
       p.rupture.pop_back();
     },
     "/tools/ball/puncture/rupture has 5 rows, must have 1 or 6"},
    {"RuptureNegative",
     [](Puncture& p) {
       p.rupture[3] = -2.0;
     },
     "/tools/ball/puncture/rupture: row 3 has -2, must be at least 0"},
    {"LayersOfOthers",
     [](Puncture& p) {
       p.layer_depth_m.conservativeResize(4, 3);
     },
     "/tools/ball/puncture/layer_depth_m has 4 rows, must have 1 or 6"},
    {"SevenLayers",
     [](Puncture& p) {
       p.layer_depth_m.setConstant(6, 7, kNaN);
       p.layer_material.setConstant(6, 7, -1);
     },
     "/tools/ball/puncture/layer_depth_m has 7 columns, must have 1 to 6"},
    {"MaterialsOfOtherLayers",
     [](Puncture& p) {
       p.layer_material.conservativeResize(6, 2);
     },
     "/tools/ball/puncture/layer_material is 6 x 2, must be as layer_depth_m: 6 x 3"},
    {"FirstBelowTheSurface",
     [](Puncture& p) {
       p.layer_depth_m(2, 0) = 1e-3;
     },
     "/tools/ball/puncture/layer_depth_m: row 2 begins with 0.001, must begin with 0"},
    {"NoFirst",
     [](Puncture& p) {
       p.layer_depth_m(2, 0) = kNaN;
     },
     "/tools/ball/puncture/layer_depth_m: row 2 begins with nan, must begin with 0"},
    {"NotDeeper",
     [](Puncture& p) {
       p.layer_depth_m(4, 2) = 0.002;
     },
     "/tools/ball/puncture/layer_depth_m: row 4 has 0.002 after"},
    {"LayerBehindTheLast",
     [](Puncture& p) {
       p.layer_depth_m(4, 1) = kNaN;
     },
     "/tools/ball/puncture: row 4 has a layer at nan of material 1 behind its last, "
     "must have none"},
    {"MaterialBehindTheLast",
     [](Puncture& p) {
       p.layer_material(1, 2) = 0;
     },
     "/tools/ball/puncture: row 1 has a layer at nan of material 0 behind its last"},
    {"MaterialUnknown",
     [](Puncture& p) {
       p.layer_material(0, 1) = 3;
     },
     "/tools/ball/puncture/layer_material: row 0 has 3 at 0.002 m, must lie in [0, 2]"},
};
INSTANTIATE_TEST_SUITE_P(OfTheNodes, BrokenPuncture, testing::ValuesIn(kNodeViolations),
                         [](const auto& violation) {
                           return violation.param.name;
                         });

TEST(PunctureRules, WhatNothingBreaksIsInfinite) {
  ResponseDatabase database = small_database();
  database.tools[0].puncture = some_puncture(6);
  database.tools[0].puncture.rupture = {std::numeric_limits<double>::infinity()};
  EXPECT_NO_THROW(check(database));
}

}  // namespace
}  // namespace palpate
