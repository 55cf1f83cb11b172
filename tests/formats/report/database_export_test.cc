#include "formats/report/database_export.h"

#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

TEST(DatabaseExport, CsvNumbersReadBackAsTheyWere) {
  const ResponseDatabase database = small_database();
  const ResponseTable& table = database.tools[1];
  std::istringstream lines(to_csv(database, table));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "node,x_m,y_m,z_m,depth_m,force_n,stiffness_n_per_m,energy_j");
  for (std::size_t i = 0; i < table.depth_m.size(); ++i) {
    ASSERT_TRUE(std::getline(lines, line));
    std::vector<double> values;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      values.push_back(std::stod(field));
    }
    ASSERT_EQ(values.size(), 8u);
    EXPECT_EQ(values[4], table.depth_m[i]);
    EXPECT_EQ(values[5], table.force_n[i]);
    EXPECT_EQ(values[6], table.stiffness_n_per_m[i]);
    EXPECT_EQ(values[7], table.energy_j[i]);
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(DatabaseExport, JsonHoldsEveryResponseOrNull) {
  const ResponseDatabase database = small_database();
  const ResponseTable& table = database.tools[1];
  const auto report = parse_json(to_json_text(database, table));
  EXPECT_EQ(report.at("tool").at("name"), "ball");
  EXPECT_EQ(report.at("position_m").size(), 6u);
  EXPECT_EQ(report.at("triangle").size(), 8u);
  ASSERT_EQ(report.at("response").size(), 6u);
  EXPECT_TRUE(report.at("response")[5].is_null());
  const std::vector<double> force_n = report.at("response")[2].at("force_n");
  EXPECT_EQ(force_n, std::vector<double>(table.curve(2).force_n.begin(),
                                         table.curve(2).force_n.end()));
}

TEST(DatabaseExport, VtuNamesTheFieldsOfTheBody) {
  const ResponseDatabase database = small_database();
  const std::string text = to_vtu(database, database.tools[1]);
  EXPECT_NE(text.find("NumberOfPoints=\"6\" NumberOfCells=\"8\""), std::string::npos);
  for (const char* name :
       {"stiffness", "depth_max", "error", "origin", "connectivity"}) {
    EXPECT_NE(text.find(fmt::format("Name=\"{}\"", name)), std::string::npos) << name;
  }
  EXPECT_NE(text.find("\n1 1 1 1 1 0\n"), std::string::npos);  // origins, as numbers
}

TEST(DatabaseExport, EveryFormatSaysHowResponsesRelax) {
  ResponseDatabase database = small_database();
  ResponseTable& table = database.tools[1];
  table.viscoelasticity = viscous();
  std::istringstream lines(to_csv(database, table));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.substr(line.size() - 8), ",g_1,g_2");
  while (std::getline(lines, line) && line[0] != '4') {
  }
  EXPECT_EQ(line.substr(line.rfind(',', line.rfind(',') - 1)),
            fmt::format(",{},{}", double{0.2F}, double{0.3F}));
  const std::string vtu = to_vtu(database, table);
  for (const char* name : {"relaxing_g_1", "relaxing_g_2", "relaxation_time_s"}) {
    EXPECT_NE(vtu.find(fmt::format("Name=\"{}\"", name)), std::string::npos) << name;
  }
  const auto report = parse_json(to_json_text(database, table));
  const auto& relaxation = report.at("viscoelasticity");
  EXPECT_EQ(relaxation.at("curve"), "press");
  EXPECT_EQ(relaxation.at("tau_s"), (std::vector<double>{0.5, 4.0}));
  EXPECT_EQ(relaxation.at("g").at(4).at(1), 0.3F);
  EXPECT_EQ(relaxation.at("sites").at("weight").at(1).at(1), 0.75F);
}

TEST(DatabaseExport, EveryFormatSaysWhatANeedleBreaks) {
  ResponseDatabase database = small_database();
  ResponseTable& table = database.tools[1];
  table.puncture = known_puncture(6);
  table.puncture.rupture[2] = std::numeric_limits<double>::infinity();
  std::istringstream lines(to_csv(database, table));
  std::string line;
  std::getline(lines, line);
  EXPECT_TRUE(line.ends_with(
      ",rupture_n,layer_depth_m_1,layer_material_1,layer_depth_m_2,layer_material_2,"
      "layer_depth_m_3,layer_material_3"))
      << line;
  std::getline(lines, line);
  EXPECT_TRUE(line.ends_with(",2,0,0,0.002,1,0.01,2")) << line;
  const std::string vtu = to_vtu(database, table);
  const auto after = [&](const std::string& head) {
    const std::size_t at = vtu.find(head);
    EXPECT_NE(at, std::string::npos) << head;
    return vtu.substr(vtu.find('\n', at) + 1, 40);
  };
  // Neither "inf" nor "nan", which VTK does not read.
  EXPECT_TRUE(after("Name=\"rupture_n\"").starts_with("2 2.01 -1 2.03 "));
  EXPECT_TRUE(after("Name=\"layer_depth_m\" NumberOfComponents=\"3\"")
                  .starts_with("0 0.002 0.01 0 0.002001 -1 "));
  EXPECT_TRUE(after("Name=\"layer_material\"").starts_with("0 1 2 0 1 -1 "));
  const auto puncture = parse_json(to_json_text(database, table)).at("puncture");
  EXPECT_EQ(puncture.at("material").at(2), "bone");
  EXPECT_EQ(puncture.at("radius_m"), 7.5e-4);
  EXPECT_EQ(puncture.at("insertable_m"), 0.03);
  EXPECT_EQ(puncture.at("membrane_j").at(1), 2e-3);
  EXPECT_TRUE(puncture.at("membrane_j").at(0).is_null());
  EXPECT_TRUE(puncture.at("rupture_n").at(2).is_null());
  EXPECT_EQ(puncture.at("layer_depth_m").at(0).at(2), 0.01);
  table.puncture.rule = "energy";
  EXPECT_NE(to_vtu(database, table).find("Name=\"rupture_j\""), std::string::npos);
}

}  // namespace
}  // namespace palpate
