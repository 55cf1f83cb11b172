#include "formats/measurement/column_choice.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/measurement/machine_table.h"
#include "formats/measurement/text_table.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

struct Chosen {
  MeasurementFile read;
  std::vector<std::string> notes;
  std::string asked;
};

Chosen choose(const std::string& text, const MeasurementColumns& told = {}) {
  Chosen chosen;
  const std::vector<TextLine> lines = text_lines(text, "x.txt");
  try {
    const MeasurementColumns columns =
        columns_of_lines("x.txt", lines, told, &chosen.notes);
    chosen.read = read_table("x.txt", lines, columns);
  } catch (const Error& error) {
    chosen.asked = error.what();
  }
  return chosen;
}

TEST(ColumnChoice, TheHeaderTellsDepthAndForceByTheirUnits) {
  for (const char* text :
       {"Time (s),Compression (mm),Load (N)\n0,1,2\n1,3,4\n",
        "Load_N;Travel_mm\n2;1\n4;3\n", "Load N;Travel mm;Cycle N\n2;1;1\n4;3;1\n",
        "Travel (mm)   Load(N)\n 1.0  2.0\n 3.0  4.0\n",
        "# Travel [mm]\tLoad [N]\n1\t2\n3\t4\n",
        "Travel (millimeters),Load (Newtons)\n1,2\n3,4\n",
        "Load,Travel,Time\nNewton,Millimetre,Second\n2,1,0\n4,3,1\n",
        "Rig 7\n\nTime\tz\tF\ns\tmm\tN\n0\t1\t2\n1\t3\t4\n"}) {
    const Chosen c = choose(text);
    EXPECT_EQ(c.asked, "") << text;
    EXPECT_EQ(c.read.samples.depth_m, (std::vector<double>{1.0 * 1e-3, 3.0 * 1e-3}))
        << text;
    EXPECT_EQ(c.read.samples.force_n, (std::vector<double>{2.0, 4.0})) << text;
    EXPECT_TRUE(c.notes.empty());
  }
}

TEST(ColumnChoice, PoundsAndGramsAreForcesBesideAForcesName) {
  const double grams =
      choose("Way (inches),Force (grams)\n1,2\n3,4\n").read.samples.force_n.at(1);
  EXPECT_EQ(grams, 4 * 9.80665e-3);
  const MeasurementFile pounds = choose("Way (inch),Load (lbs)\n1,2\n3,4\n").read;
  EXPECT_EQ(pounds.samples.force_n.at(0), 2 * (0.45359237 * 9.80665));
  EXPECT_EQ(pounds.samples.depth_m.at(1), 3 * 0.0254);
  expect_says(choose("Way (mm),Specimen (lbs)\n1,2\n3,4\n").asked, "unit of force");
}

TEST(ColumnChoice, WhatTheHeaderDoesNotTellIsAskedFor) {
  const std::string two = "Stroke (mm),Gauge (mm),Load (N)\n0,1,2\n1,3,4\n2,4,5\n";
  expect_says(choose(two).asked,
              "2 columns may be the depth: \"Stroke (mm)\" (column 1), "
              "\"Gauge (mm)\" (column 2); tell which");
  EXPECT_EQ(choose(two, {{"Gauge", ""}, {}}).asked, "");
  expect_says(choose("a,b\n0,1\n1,3\n").asked,
              "no column of the header states a unit of length; columns found: \"a\", "
              "\"b\"");
  expect_says(choose("0,1\n1,3\n").asked, "no line of names");
  expect_says(choose("").asked, "is empty");
  expect_says(choose("Travel (mm),Load (N)\n").asked, "no line of names above a row");
  EXPECT_EQ(choose("0,1\n1,3\n", {{"1", "mm"}, {"2", "N"}}).asked, "");
}

// A displacement and the gap that it leaves; a force in two systems of units.
TEST(ColumnChoice, ColumnsThatTellTheSameAreOne) {
  const Chosen c = choose(
      "Gap (mm);Travel (um);Load (N);Load (gf)\n"
      "9;0;0;0\n8.5;500;0.980665;100\n8;1000;1.96133;200\n");
  EXPECT_EQ(c.asked, "");
  EXPECT_EQ(c.read.depth_column, "Travel (um)");
  EXPECT_EQ(c.read.force_column, "Load (N)");
  ASSERT_EQ(c.notes.size(), 2U);
  EXPECT_EQ(c.notes[0],
            "\"Travel (um)\" is the depth: \"Gap (mm)\" (column 1) tells the same");
  // The same numbers in two units are two different forces.
  expect_says(choose("x (mm);Load (N);Load (gf)\n0;0;0\n1;1;1\n2;3;3\n").asked,
              "2 columns may be the force");
  expect_says(choose("Gap (mm);Travel (mm);F (N)\n9;0;0\n8;1;1\n7.5;2;2\n").asked,
              "2 columns may be the depth");
}

// One wild reading of the travel: the gap is taken.
TEST(ColumnChoice, OfTwoThatTellTheSameTheOneWithoutAGlitchIsTaken) {
  std::string text = "Travel (mm);Gap (mm);Load (N)\n";
  for (int i = 0; i < 60; ++i) {
    text += fmt::format("{};{};{}\n", i == 30 ? 90 : i, 100 - i, i);
  }
  const Chosen c = choose(text);
  EXPECT_EQ(c.asked, "");
  EXPECT_EQ(c.read.depth_column, "Gap (mm)");
}

// Somebody's calculations in the sheet: numbers beside names, units and samples.
TEST(ColumnChoice, NumbersBesideTheHeaderDoNotHideIt) {
  const std::string text =
      "FF1\tFF1\tFF1\t\t\t\n"
      "Temps d'essai\tForce standard\tAllongement\t\t20\t80\n"
      "s\tN\tmm\t\t5.4843516\t45.305687\n"
      "0\t0.5\t0.0\t7\t1\t1\n0.1\t1.5\t0.25\t8\t\t\n";
  const Chosen c = choose(text);
  EXPECT_EQ(c.asked, "");
  EXPECT_EQ(c.read.samples.depth_m, (std::vector<double>{0.0, 0.25e-3}));
  EXPECT_EQ(c.read.samples.force_n, (std::vector<double>{0.5, 1.5}));
  const auto lines = text_lines(text, "x.txt");
  const auto curves = tables_in(lines);
  ASSERT_EQ(curves.size(), 1U);
  EXPECT_EQ(curves[0].line, 2U);
  EXPECT_TRUE(curves[0].columns.time.has_value());
}

}  // namespace
}  // namespace palpate
