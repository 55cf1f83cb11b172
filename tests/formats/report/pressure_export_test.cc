#include "formats/report/pressure_export.h"

#include <numbers>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

// 2 pi R times the trapezoid sum of the table, beside the stored force along the
// normal.
void expect_table_carries(const std::vector<double>& depth_m,
                          const std::vector<double>& pressure_pa,
                          const ResponseDatabase& database, const ResponseTable& table,
                          std::int64_t node) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < depth_m.size(); ++i) {
    sum += 0.5 * (pressure_pa[i] + pressure_pa[i + 1]) * (depth_m[i + 1] - depth_m[i]);
  }
  const double lean =
      std::abs(database.normal.row(node).dot(table.direction.row(node)));
  const double stored_n = lean * table.curve(node).at(lean * depth_m.back()).force_n;
  EXPECT_NEAR(2.0 * std::numbers::pi * table.tool.radius_m * sum, stored_n,
              0.01 * stored_n)
      << node;
}

TEST(PressureExport, JsonCarriesTheStoredForces) {
  const ResponseDatabase database = small_database();
  const ResponseTable& table = find_tool(database, "ball");
  const auto report = parse_json(pressure_json(database, table));
  EXPECT_EQ(report.at("tool").at("radius_m"), table.tool.radius_m);
  const auto& laws = report.at("law");
  ASSERT_EQ(laws.size(), 6u);
  EXPECT_TRUE(laws[5].is_null());
  for (const std::int64_t node : {0, 1, 2, 3}) {
    const auto& law = laws[static_cast<std::size_t>(node)];
    const std::vector<double> depth_m = law.at("depth_m");
    ASSERT_EQ(depth_m.size(), 33u);
    EXPECT_GT(law.at("slope_pa_per_m"), 0.0);
    expect_table_carries(depth_m, law.at("pressure_pa"), database, table, node);
  }
}

TEST(PressureExport, CsvHasTheNumbersOfJson) {
  const ResponseDatabase database = small_database();
  const ResponseTable& table = find_tool(database, "ball");
  const auto laws = parse_json(pressure_json(database, table)).at("law");
  std::istringstream lines(pressure_csv(database, table));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "node,x_m,y_m,z_m,radius_m,depth_m,pressure_pa");
  for (std::size_t node = 0; node < 5; ++node) {
    for (std::size_t i = 0; i < 33; ++i) {
      ASSERT_TRUE(std::getline(lines, line));
      std::vector<double> values;
      std::istringstream fields(line);
      for (std::string field; std::getline(fields, field, ',');) {
        values.push_back(std::stod(field));
      }
      ASSERT_EQ(values.size(), 7u);
      EXPECT_EQ(values[0], static_cast<double>(node));
      EXPECT_EQ(values[1],
                database.body.position_m(static_cast<Eigen::Index>(node), 0));
      EXPECT_EQ(values[4], table.tool.radius_m);
      EXPECT_EQ(values[5], laws[node].at("depth_m")[i]);
      EXPECT_EQ(values[6], laws[node].at("pressure_pa")[i]);
    }
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(PressureExport, IsOfASphere) {
  const ResponseDatabase database = small_database();
  ResponseTable table = find_tool(database, "ball");
  table.tool.kind = "flat-punch";
  EXPECT_THROW((void)pressure_csv(database, table), InputError);
  EXPECT_THROW((void)pressure_json(database, table), InputError);
}

}  // namespace
}  // namespace palpate
