#include "formats/database/compliance_rules.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/contact_set.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

constexpr std::int64_t kCoupledNodes = 3;

ComplianceTable coupled_table() {
  ComplianceTable table;
  table.distance_m = log_spaced(0.001, 0.1, 6);
  table.value.setConstant(kCoupledNodes, 6, 1e-6F);
  table.mode.setConstant(kCoupledNodes, 2, 0.5F);
  table.added_modes = 1;
  table.error_relative = 0.05;
  return table;
}

template <typename Change>
std::string head_refusal(const Change& change) {
  ComplianceTable table = coupled_table();
  change(table);
  return refusal([&] {
    check_compliance_head("/t", table);
  });
}

template <typename Change>
std::string rows_refusal(const Change& change) {
  ComplianceTable table = coupled_table();
  change(table);
  return refusal([&] {
    check_compliance_rows("/t", table, kCoupledNodes, 100);
  });
}

TEST(ComplianceRules, AWholeTableAndNoneAreRight) {
  const ComplianceTable table = coupled_table();
  EXPECT_NO_THROW(check_compliance_head("/t", table));
  EXPECT_NO_THROW(check_compliance_rows("/t", table, kCoupledNodes));
  EXPECT_NO_THROW(check_compliance_head("/t", {}));
  EXPECT_NO_THROW(check_compliance_rows("/t", {}, kCoupledNodes));
  ComplianceTable plain = coupled_table();
  plain.mode.resize(0, 0);
  plain.added_modes = 0;
  EXPECT_NO_THROW(check_compliance_rows("/t", plain, kCoupledNodes));
}

TEST(ComplianceRules, DistancesAreFourTo32) {
  for (const std::size_t count : {std::size_t{4}, std::size_t{32}}) {
    EXPECT_EQ(head_refusal([&](ComplianceTable& table) {
                table.distance_m = log_spaced(0.001, 0.1, count);
              }),
              "");
  }
  EXPECT_EQ(head_refusal([](ComplianceTable& table) {
              table.distance_m = {0.001, 0.01, 0.1};
            }),
            "/t/compliance/distance_m has 3 rows, must have 4 to 32");
  expect_says(head_refusal([](ComplianceTable& table) {
                table.distance_m.assign(33, 1.0);
              }),
              "has 33 rows");
}

TEST(ComplianceRules, DistancesAreEvenInTheLogarithm) {
  expect_says(head_refusal([](ComplianceTable& table) {
                table.distance_m = {0.001, 0.002, 0.003, 0.004};
              }),
              "/t/compliance/distance_m: element 1 is 0.002, must be 0.0015");
  const auto off = [](double share) {
    return head_refusal([=](ComplianceTable& table) {
      table.distance_m[2] *= 1.0 + share;
    });
  };
  EXPECT_EQ(off(5e-10), "");
  expect_says(off(5e-9), "element 2");
  expect_says(off(-5e-9), "element 2");
}

TEST(ComplianceRules, DistancesArePositiveFiniteAndIncrease) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const std::vector<std::vector<double>> wrong{
      {0.0, 0.1, 0.2, 0.4},  {-0.1, 0.1, 0.2, 0.4},      {0.1, 0.1, 0.1, 0.1},
      {0.4, 0.2, 0.1, 0.05}, {0.1, 0.2, 0.4, kInfinite}, {std::nan(""), 0.2, 0.4, 0.8}};
  for (const std::vector<double>& distance_m : wrong) {
    expect_says(head_refusal([&](ComplianceTable& table) {
                  table.distance_m = distance_m;
                }),
                "must be positive and increase");
  }
  expect_says(head_refusal([](ComplianceTable& table) {
                table.distance_m[2] = std::nan("");
              }),
              "element 2 is nan");
}

TEST(ComplianceRules, TheErrorIsNoNegativeNumberAndFinite) {
  for (const double error : {-1e-9, std::nan(""), HUGE_VAL}) {
    expect_says(head_refusal([&](ComplianceTable& table) {
                  table.error_relative = error;
                }),
                "/t/compliance@error_relative is ");
  }
  EXPECT_EQ(head_refusal([](ComplianceTable& table) {
              table.error_relative = 0.0;
            }),
            "");
}

TEST(ComplianceRules, RowsAreOfEveryNodeAndDistanceAndFinite) {
  EXPECT_EQ(rows_refusal([](ComplianceTable& table) {
              table.value.conservativeResize(2, 6);
            }),
            "/t/compliance/value is 2 x 6, must be 3 x 6");
  EXPECT_EQ(rows_refusal([](ComplianceTable& table) {
              table.value.conservativeResize(3, 5);
            }),
            "/t/compliance/value is 3 x 5, must be 3 x 6");
  EXPECT_EQ(rows_refusal([](ComplianceTable& table) {
              table.value(2, 5) = std::numeric_limits<float>::infinity();
            }),
            "/t/compliance/value: row 102 has inf, must be finite");
  EXPECT_EQ(rows_refusal([](ComplianceTable& table) {
              table.mode(1, 1) = std::numeric_limits<float>::quiet_NaN();
            }),
            "/t/compliance/mode: row 101 has nan, must be finite");
  EXPECT_EQ(rows_refusal([](ComplianceTable& table) {
              table.mode.conservativeResize(2, 2);
            }),
            "/t/compliance/mode is 2 x 2, must be 3 x 2");
  // Without distances there are no rows.
  EXPECT_EQ(rows_refusal([](ComplianceTable& table) {
              table.distance_m.clear();
            }),
            "/t/compliance/value is 3 x 6, must be 0 x 0");
}

TEST(ComplianceRules, ModesAreAtMost16OfWhichNoMoreAddThanThereAre) {
  const auto modes = [](Eigen::Index count, std::int64_t added) {
    return rows_refusal([=](ComplianceTable& table) {
      table.mode.setConstant(kCoupledNodes, count, 1.0F);
      table.added_modes = added;
    });
  };
  EXPECT_EQ(modes(16, 16), "");
  EXPECT_EQ(modes(16, 0), "");
  expect_says(modes(17, 0), "/t/compliance/mode has 17 columns of which 0 add");
  expect_says(modes(2, 3), "has 2 columns of which 3 add");
  expect_says(modes(2, -1), "has 2 columns of which -1 add");
}

// A tool of two radii, whose own table is of the first, and the table of the second.
std::vector<ResponseTable> tables_of_pads() {
  std::vector<ResponseTable> tables(2);
  tables[0].tool = ToolShape{"pads", "sphere", 0.005, 0.0, 0.0};
  tables[0].tool.contact.point_m = Points::Zero(2, 3);
  tables[0].tool.contact.point_m(1, 0) = 0.02;
  tables[0].tool.contact.radius_m = {0.005, 0.008};
  tables[1].tool = spheres_of(tables[0].tool).at(1);
  return tables;
}

TEST(ComplianceRules, EveryRadiusOfContactsHasATableOfItsOwn) {
  std::vector<ResponseTable> tables = tables_of_pads();
  EXPECT_NO_THROW(check_contact_tables(tables));
  tables.pop_back();
  EXPECT_THROW(check_contact_tables(tables), FormatError);
  expect_says(refusal([&] {
                check_contact_tables(tables);
              }),
              "/tools/pads/contact/radius_m has 0.008, must have a table");
}

TEST(ComplianceRules, ThatTableIsOfASphereOfThatRadius) {
  std::vector<ResponseTable> tables = tables_of_pads();
  const std::string name = tables[1].tool.name;
  tables[1].tool.radius_m = 0.006;
  expect_says(refusal([&] {
                check_contact_tables(tables);
              }),
              "/tools/" + name +
                  " is a sphere of radius 0.006, must be a sphere of "
                  "radius 0.008 as pads has it");
  tables = tables_of_pads();
  tables[1].tool.kind = "punch";
  expect_says(refusal([&] {
                check_contact_tables(tables);
              }),
              "/tools/" + name + " is a punch");
}

}  // namespace
}  // namespace palpate
