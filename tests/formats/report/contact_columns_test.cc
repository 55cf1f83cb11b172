#include "formats/report/contact_columns.h"

#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "formats/report/database_export.h"
#include "tests/support/contact_database.h"

namespace palpate {
namespace {

// K = S N / d at each sample, at the touch by the slope: columns of a CSV read back.
TEST(ContactColumns, AreTheTablesAtEachSample) {
  const ResponseDatabase database = with_contacts();
  const ResponseTable& table = database.tools.front();
  std::istringstream lines(to_csv(database, table));
  std::string line;
  std::getline(lines, line);
  EXPECT_NE(line.find(",contact_radius_m,lateral_xx_n_per_m,lateral_xy_n_per_m,"
                      "lateral_yy_n_per_m"),
            std::string::npos)
      << line;
  std::size_t compared = 0;
  while (std::getline(lines, line)) {
    std::vector<double> value;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      value.push_back(std::stod(field));
    }
    const auto node = static_cast<std::int64_t>(value[0]);
    const double end_m = table.curve(node).depth_m.back();
    const double per_m = value[4] > 0.0 ? value[5] / value[4] : value[6];
    const std::size_t columns = value.size();
    const Eigen::Matrix2d S = lateral_at(table.contact, node, value[4] / end_m);
    EXPECT_NEAR(value[columns - 3], S(0, 0) * per_m, 1e-12 * per_m) << line;
    EXPECT_NEAR(value[columns - 2], S(0, 1) * per_m, 1e-12 * per_m) << line;
    EXPECT_NEAR(value[columns - 1], S(1, 1) * per_m, 1e-12 * per_m) << line;
    const double radius_m =
        pressure_at(table.contact, node, value[4] / end_m, 1.0).radius_m();
    EXPECT_NEAR(value[columns - 4], radius_m, 1e-15) << line;
    compared += value[columns - 1] > 0.0 && radius_m > 0.0;
  }
  EXPECT_GT(compared, 5u);
}

TEST(ContactColumns, AreNoneOfATableWithoutContacts) {
  EXPECT_EQ(contact_columns({}), "");
  const ResponseDatabase database = with_contacts();
  EXPECT_NE(to_vtu(database, database.tools[0]).find("Name=\"lateral_n_per_m\""),
            std::string::npos);
  EXPECT_EQ(to_vtu(database, database.tools[1]).find("lateral"), std::string::npos);
  EXPECT_NE(to_json_text(database, database.tools[0]).find("lateral_n_per_m"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
