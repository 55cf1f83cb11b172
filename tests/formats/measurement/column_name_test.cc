#include "formats/measurement/column_name.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

// "quantity|unit"
std::string apart(std::string_view header) {
  const ColumnName name = parse_column_name(header);
  return name.quantity + "|" + name.unit;
}

TEST(ColumnName, BracketsCommasAndUnderscoresHoldUnits) {
  EXPECT_EQ(apart("Load (N)"), "Load|N");
  EXPECT_EQ(apart("Load [mN]"), "Load|mN");
  EXPECT_EQ(apart("Load, N"), "Load|N");
  EXPECT_EQ(apart("load_N"), "load|N");
  EXPECT_EQ(apart("Depth mm"), "Depth|mm");
  EXPECT_EQ(apart("(mm)"), "|mm");
  EXPECT_EQ(apart("Load (cell) (N)"), "Load (cell)|N");
  EXPECT_EQ(apart("Load"), "Load|");
  EXPECT_EQ(apart(""), "|");
}

TEST(ColumnName, InBracketsAnythingIsAUnitElsewhereAKnownOne) {
  EXPECT_EQ(apart("Stress (MPa)"), "Stress|MPa");
  EXPECT_EQ(apart("Run, second try"), "Run, second try|");
  EXPECT_EQ(apart("load_cell"), "load_cell|");
  EXPECT_EQ(apart("Load N)"), "Load N)|");
}

TEST(ColumnName, AWordIsNoUnit) {
  EXPECT_EQ(apart("Cycle N"), "Cycle N|");
  EXPECT_EQ(apart("Rise in"), "Rise in|");
  EXPECT_EQ(apart("force_min"), "force_min|");
  EXPECT_EQ(apart("Load N"), "Load|N");
  EXPECT_EQ(apart("Time s"), "Time|s");
  EXPECT_EQ(apart("Group s"), "Group s|");
  EXPECT_EQ(apart("Time_S"), "Time|S");
  EXPECT_EQ(apart("run_S"), "run_S|");
  for (const char* unit : {"s", "ms", "us", "ns", "µs"}) {
    EXPECT_EQ(apart(std::string("hold_") + unit), std::string("hold|") + unit);
  }
  EXPECT_EQ(apart("hold_min"), "hold_min|");
}

TEST(ColumnName, AMassIsAForceBesideAForcesName) {
  EXPECT_EQ(apart("Load (kg)"), "Load|kgf");
  EXPECT_EQ(apart("Force [g]"), "Force|gf");
  EXPECT_EQ(apart("Weight (lbs)"), "Weight|lbf");
  EXPECT_EQ(apart("Sample (kg)"), "Sample|kg");
  EXPECT_EQ(unit_beside("Kraft", "kilograms"), "kgf");
  EXPECT_EQ(unit_beside("Fz", "g"), "gf");
  EXPECT_EQ(unit_beside("Load", "mN"), "mN");
}

TEST(ColumnName, UnitsHaveTheirSizeSpelledOutToo) {
  EXPECT_DOUBLE_EQ(length_unit_si("mm").value(), 1e-3);
  EXPECT_DOUBLE_EQ(length_unit_si("Millimetres").value(), 1e-3);
  EXPECT_DOUBLE_EQ(length_unit_si("microns").value(), 1e-6);
  EXPECT_DOUBLE_EQ(length_unit_si("nanometer").value(), 1e-9);
  EXPECT_DOUBLE_EQ(length_unit_si("centimeters").value(), 1e-2);
  EXPECT_DOUBLE_EQ(length_unit_si("inches").value(), 0.0254);
  EXPECT_DOUBLE_EQ(length_unit_si("inch").value(), 0.0254);
  EXPECT_DOUBLE_EQ(force_unit_si("Newtons").value(), 1.0);
  EXPECT_DOUBLE_EQ(force_unit_si("millinewton").value(), 1e-3);
  EXPECT_DOUBLE_EQ(force_unit_si("kN").value(), 1e3);
  // Standard gravity, 9.80665 m/s^2; a pound is 0.45359237 kg.
  EXPECT_DOUBLE_EQ(force_unit_si("gf").value(), 9.80665e-3);
  EXPECT_DOUBLE_EQ(force_unit_si("lbf").value(), 0.45359237 * 9.80665);
  EXPECT_DOUBLE_EQ(time_unit_si("seconds").value(), 1.0);
  EXPECT_DOUBLE_EQ(time_unit_si("ms").value(), 1e-3);
}

TEST(ColumnName, AUnitIsOfOneQuantity) {
  EXPECT_EQ(length_unit_si("N"), std::nullopt);
  EXPECT_EQ(force_unit_si("mm"), std::nullopt);
  EXPECT_EQ(time_unit_si("N"), std::nullopt);
  EXPECT_EQ(force_unit_si("kg"), std::nullopt);
  EXPECT_DOUBLE_EQ(unit_si(kDepth, "um").value(), 1e-6);
  EXPECT_DOUBLE_EQ(unit_si(kForce, "uN").value(), 1e-6);
  EXPECT_DOUBLE_EQ(unit_si(kTime, "ns").value(), 1e-9);
  EXPECT_EQ(unit_si(kTime, "um"), std::nullopt);
  EXPECT_TRUE(is_known_unit("mm") && is_known_unit("N") && is_known_unit("s"));
  EXPECT_FALSE(is_known_unit("MPa") || is_known_unit(""));
}

TEST(ColumnName, AChoiceIsANumberWhereAllOfItIs) {
  EXPECT_EQ(column_number("12"), 12U);
  for (const char* choice :
       {"", "1x", " 1", "-1", "1.0", "Load", "99999999999999999999999"}) {
    EXPECT_EQ(column_number(choice), std::nullopt) << choice;
  }
}

using Matches = std::vector<std::size_t>;

TEST(ColumnName, TheClosestReadingOfANameCounts) {
  const std::vector<std::string> headers{"Load (N)", "load (n)", "Load", "Time (s)"};
  EXPECT_EQ(matching_columns(headers, "Load (N)"), (Matches{0}));
  EXPECT_EQ(matching_columns(headers, "LOAD (N)"), (Matches{0, 1}));
  EXPECT_EQ(matching_columns(headers, "load"), (Matches{2}));
  EXPECT_EQ(matching_columns(headers, "time"), (Matches{3}));
  EXPECT_EQ(matching_columns(headers, "Depth"), Matches{});
  EXPECT_EQ(matching_columns({"Force (N)", "force (mN)"}, "FORCE"), (Matches{0, 1}));
}

TEST(ColumnName, AMarkOfCommentsBelongsToNoName) {
  EXPECT_EQ(matching_columns({"Load", "x"}, "# Load"), (Matches{0}));
  EXPECT_EQ(matching_columns({"# Load", "Load"}, "# Load"), (Matches{0}));
  EXPECT_EQ(matching_columns({"a", "#"}, "#"), (Matches{1}));
}

TEST(ColumnName, TheNearestIsToldFirst) {
  EXPECT_EQ(nearest_columns({"Time (s)", "Load (N)", "Depth (mm)"}, "laod"),
            "\"Load (N)\", \"Time (s)\", \"Depth (mm)\"");
  EXPECT_EQ(nearest_columns({"b", "a"}, "c"), "\"b\", \"a\"");
  EXPECT_EQ(nearest_columns({}, "c"), "");
}

}  // namespace
}  // namespace palpate
