#include "formats/report/taxel_export.h"

#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"

namespace palpate {
namespace {

// Three columns and two rows, all different.
Taxels six_taxels() {
  Taxels taxels{.pressure_pa = Eigen::MatrixXd(2, 3), .contact = {}};
  taxels.pressure_pa << 1.0, 2.0, 3.0, 4.0, 5.0, 0.1;
  taxels.contact = {.normal_n = 2.5,
                    .moment_m2 = 1e-6 * Eigen::Matrix2d::Identity(),
                    .exponent = 0.5};
  taxels.beside_n = 0.25;
  return taxels;
}

constexpr TaxelGrid kGrid{.rows = 2, .columns = 3, .pitch_m = 0.5};

TEST(TaxelExport, CsvHasTheLargestYFirst) {
  EXPECT_EQ(taxel_csv(six_taxels(), kGrid), "4,5,0.1\n1,2,3\n");
}

TEST(TaxelExport, JsonHasTheSmallestYFirst) {
  const auto report = parse_json(taxel_json(six_taxels(), kGrid));
  EXPECT_EQ(report.at("pressure_pa").at(0), (std::vector{1.0, 2.0, 3.0}));
  EXPECT_EQ(report.at("pressure_pa").at(1), (std::vector{4.0, 5.0, 0.1}));
  EXPECT_EQ(report.at("force_n"), 2.5);
  EXPECT_EQ(report.at("beside_n"), 0.25);
  EXPECT_NEAR(report.at("radius_m"), std::sqrt(5e-6), 1e-12);
  EXPECT_EQ(report.at("y"), (std::vector{0.0, 1.0, 0.0}));
}

TEST(TaxelExport, WithoutContactNothingIsPressed) {
  Taxels none{.pressure_pa = Eigen::MatrixXd::Zero(2, 3), .contact = {}};
  const auto report = parse_json(taxel_json(none, kGrid));
  EXPECT_EQ(report.at("radius_m"), 0.0);
  EXPECT_EQ(report.at("middle_pa"), 0.0);
}

}  // namespace
}  // namespace palpate
