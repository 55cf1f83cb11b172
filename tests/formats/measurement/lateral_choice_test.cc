#include "formats/measurement/lateral_choice.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/measurement/machine_table.h"

namespace palpate {
namespace {

MeasurementFile read_lateral(const std::string& text, LateralColumns lateral = {}) {
  const auto lines = text_lines(text, "a.csv");
  MeasurementColumns given;
  given.lateral = lateral;
  return read_lines("a.csv", lines, tables_in(lines).front(),
                    {given, HeaderUnits::kMustAgree, false});
}

struct ChoiceCase {
  const char* header;
  const char *displacement, *force, *normal;  // "" : none
};

TEST(LateralChoice, NamesTellForcesAndDisplacementsApart) {
  const ChoiceCase cases[] = {
      {"x (mm),Fx (N),Fz (N)", "x (mm)", "Fx (N)", "Fz (N)"},
      {"Normal load [N],Friction force [mN],Stroke [um]", "Stroke [um]",
       "Friction force [mN]", "Normal load [N]"},
      {"depth_mm,pos_mm,F_N_N,F_T_N", "pos_mm", "F_T_N", "F_N_N"},
      {"Load (N),Shear force (N),X (mm),Z (mm)", "X (mm)", "Shear force (N)",
       "Load (N)"},
      {"LateralForce (N),NormalForce (N),Travel (mm)", "Travel (mm)",
       "LateralForce (N)", "NormalForce (N)"},
      {"Displacement (mm),Force (N)", "Displacement (mm)", "Force (N)", ""}};
  for (const ChoiceCase& c : cases) {
    const std::size_t columns =
        1 + std::count(c.header, c.header + std::strlen(c.header), ',');
    std::string row = "1";
    for (std::size_t i = 1; i < columns; ++i) {
      row += "," + std::to_string(i + 1);
    }
    const MeasurementFile read =
        read_lateral(std::string(c.header) + "\n" + row + "\n" + row + "\n");
    EXPECT_EQ(read.depth_column, c.displacement) << c.header;
    EXPECT_EQ(read.force_column, c.force) << c.header;
    EXPECT_EQ(read.normal_column, c.normal) << c.header;
    EXPECT_EQ(read.normal_n.size(), *c.normal == '\0' ? 0U : 2U) << c.header;
  }
}

TEST(LateralChoice, UnitsOfAllColumnsAreTaken) {
  const MeasurementFile read =
      read_lateral("x [um];Ft [mN];Fn [N]\n1,5;2;0,5\n2,5;3;0,5\n");
  EXPECT_DOUBLE_EQ(read.samples.depth_m[0], 1.5e-6);
  EXPECT_DOUBLE_EQ(read.samples.force_n[1], 3e-3);
  EXPECT_DOUBLE_EQ(read.normal_n[1], 0.5);
}

TEST(LateralChoice, RowsWithNanAreLeftOut) {
  const MeasurementFile read =
      read_lateral("x (mm),Fx (N),Fz (N)\n1,2,3\n2,nan,3\nnan,nan,nan\n4,5,6\n");
  EXPECT_EQ(read.samples.depth_m.size(), 2U);
  EXPECT_EQ(read.normal_n.size(), 2U);
  ASSERT_FALSE(read.notes.empty());
  EXPECT_EQ(read.notes.back(), "rows with NaN left out: 1");
}

TEST(LateralChoice, ASecondDirectionNeedsForceAndDisplacement) {
  const char* both = "x (mm),y (mm),Fx (N),Fy (N),Fz (N)\n1,2,3,4,5\n1,2,3,4,5\n";
  EXPECT_EQ(read_lateral(both).across_n, (std::vector<double>{4.0, 4.0}));
  EXPECT_DOUBLE_EQ(read_lateral(both).across_m[0], 2e-3);
  EXPECT_TRUE(read_lateral("x (mm),Fx (N),Fy (N)\n1,2,3\n1,2,3\n").across_n.empty());
}

TEST(LateralChoice, AKnownNormalForceIsNotLookedFor) {
  LateralColumns known;
  known.normal_is_known = true;
  EXPECT_TRUE(
      read_lateral("x (mm),Fx (N),Fz (N)\n1,2,3\n1,2,3\n", known).normal_n.empty());
}

TEST(LateralChoice, RefusesWhatMayBeSeveral) {
  for (const char* header : {"x (mm),Fx (N),Ft (N)", "x (mm),Fz (N),Fn (N)",
                             "a (mm),b (mm),Fx (N)", "x (mm),a (N),b (N),c (N)"}) {
    const bool four = std::string(header).find("c (N)") != std::string::npos;
    const std::string row = four ? "1,2,3,4\n" : "1,2,3\n";
    EXPECT_THROW((void)read_lateral(std::string(header) + "\n" + row + row), InputError)
        << header;
  }
}

}  // namespace
}  // namespace palpate
