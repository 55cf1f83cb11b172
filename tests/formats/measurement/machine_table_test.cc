// What testing machines export as tables: several in a file, heads in German, grams.
#include "formats/measurement/machine_table.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/formats/measurement/expect_near.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class MachineTable : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    const std::filesystem::path file = folder_ / "export.txt";
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

  Measurement read(const std::string& text, std::size_t which = 0) const {
    const auto file = write(text);
    const InstrumentLayout& layout = layout_of(file);
    EXPECT_EQ(layout.name, "delimited text");
    return layout.read(file, layout.list(file).curve.at(which), {}).samples;
  }

  std::size_t presses(const std::string& text) const {
    return list_tables(write(text)).curve.size();
  }

  std::string complaint(const std::string& text) const {
    try {
      (void)read(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  void expect_complaint(const std::string& text, const std::string& part) const {
    const std::string said = complaint(text);
    EXPECT_NE(said.find(part), std::string::npos) << said;
  }

 private:
  ScratchFolder folder_;
};

// A table of results without times, then raw data of two specimens.
const std::string kBluehill =
    "\"Operator : somebody\"\r\n\r\n\"Results Table 1\"\r\n"
    "\"\",\"Maximum Load\",\"Extension at Maximum\"\r\n\"\",\"(kN)\",\"(mm)\"\r\n"
    "\"1\",\"0.004\",\"2.0\"\r\n\"2\",\"0.005\",\"2.0\"\r\n\r\n\"Results Table 2\"\r\n"
    "\"Time\",\"Extension\",\"Load\"\r\n\"(s)\",\"(mm)\",\"(kN)\"\r\n"
    "\"0.000\",\"0.0\",\"0.000\"\r\n\"0.500\",\"1.0\",\"0.001\"\r\n"
    "\"1.000\",\"2.0\",\"0.004\"\r\n\r\n\"Results Table 3\"\r\n"
    "\"Time\",\"Extension\",\"Load\"\r\n\"(s)\",\"(mm)\",\"(N)\"\r\n"
    "\"0.000\",\"0.0\",\"0.0\"\r\n\"1.000\",\"2.0\",\"5.0\"\r\n\"End of test\"\r\n";

TEST_F(MachineTable, BluehillTablesWithTimesAreThePresses) {
  EXPECT_EQ(presses(kBluehill), 2U);
  const Measurement first = read(kBluehill, 0);
  expect_near(first.force_n, {0.0, 1.0, 4.0});
  expect_near(first.depth_m, {0.0, 1e-3, 2e-3});
  expect_near(first.time_s, {0.0, 0.5, 1.0});
  expect_near(read(kBluehill, 1).force_n, {0.0, 5.0});  // newtons in this one
}

TEST_F(MachineTable, TestXpertInUtf8AndLatin1) {
  const auto zwick = [](const std::string& u) {
    return "Probe 1\r\n\"Pr" + u + "fgeschwindigkeit\";10;mm/min\r\nPr" + u +
           "fzeit;Standardkraft;Traversenweg;Dehnung\r\ns;N;mm;%\r\n"
           "0,5;-1,25;0,01;3\r\n1,0;-2,5;0,02;4\r\n";
  };
  for (const char* u : {"\xC3\xBC", "\xFC"}) {
    const Measurement m = read(zwick(u));
    expect_near(m.force_n, {-1.25, -2.5});
    expect_near(m.depth_m, {1e-5, 2e-5});
    expect_near(m.time_s, {0.5, 1.0});
  }
  const std::string two =
      "Standardkraft;Verformung;Traversenweg\nkN;mm;mm\n0,1;1;1\n0,2;2;2,5\n";
  expect_complaint(two, "\"Verformung\" (column 2), \"Traversenweg\" (column 3)");
}

TEST_F(MachineTable, ExponentInGramsAndSideBySide) {
  const std::string one =
      "Force (g)\tDistance (mm)\tTime (sec)\n0\t0\t0\n100\t1\t0.5\n";
  expect_near(read(one).force_n, {0.0, 0.980665});
  expect_near(read(one).time_s, {0.0, 0.5});
  const std::string kilograms = "Force\tDistance\tTime\n(kg)\t(mm)\t(sec)\n1\t1\t0\n";
  expect_near(read(kilograms).force_n, {9.80665});
  const std::string two =
      "Force (g)\tDistance (mm)\tTime (sec)\tForce (g)\tDistance (mm)\tTime (sec)\n"
      "0\t0\t0\t10\t1\t1\n100\t1\t0.5\t20\t2\t2\n200\t2\t1\t\t\t\n";
  EXPECT_EQ(presses(two), 2U);
  EXPECT_EQ(read(two, 0).force_n.size(), 3U);
  expect_near(read(two, 1).depth_m, {1e-3, 2e-3});
  expect_complaint("Mass (g)\tDistance (mm)\n1\t1\n2\t2\n", "states a unit of force");
}

TEST_F(MachineTable, CellScaleDepthIsTheDisplacementNotTheGap) {
  const Measurement m = read(
      "SetName,Cycle,Time_S,Size_mm,Displacement_mm,Force_N\n"
      "Press,1-Compress,0.0,8.0,0.0,0.0\nPress,1-Compress,0.1,7.5,-0.5,-0.25\n");
  expect_near(m.depth_m, {0.0, -0.5e-3});
  expect_near(m.force_n, {0.0, -0.25});
  expect_near(m.time_s, {0.0, 0.1});
}

TEST_F(MachineTable, UnitsAfterACommaOfTheName) {
  const Measurement m = read("Time, s\tPosition (z), mm\tFz, gf\n0\t1\t2\n1\t2\t4\n");
  expect_near(m.force_n, {2 * 9.80665e-3, 4 * 9.80665e-3});
}

TEST_F(MachineTable, ADepthThatIsClippedBeforeContactIsTold) {
  const auto notes = [&](const char* still) {
    std::string text = "Indentation (um);Load (N)\n";
    for (int i = 0; i < 9; ++i) {
      text += std::string(still) + ";" + std::to_string(i) + "\n";
    }
    const auto file = write(text + "5;9\n");
    return read_machine_table(file, list_tables(file).curve.at(0), {}).notes;
  };
  ASSERT_EQ(notes("0").size(), 1U);
  EXPECT_NE(notes("0")[0].find("first 9 samples"), std::string::npos);
  EXPECT_TRUE(notes("1").empty());
}

TEST_F(MachineTable, RefusesTwoUnitsOfOneColumn) {
  expect_complaint("Travel (mm);Load (N)\nmm;kN\n1;2\n3;4\n",
                   "states the unit N in its name and kN below it");
}

TEST_F(MachineTable, RefusesThousandsSeparators) {
  EXPECT_EQ(complaint("Travel (mm),Load (N)\n1.0,\"1,234.5\"\n"),
            "");  // the point tells
  expect_complaint("Travel (mm);Load (N)\n0,5;999,5\n1,0;1.234\n",
                   "a comma in line 2 and a point in line 3");
  expect_complaint("Travel (mm)\tLoad (N)\n0.5\t999.5\n1.0\t1,234\n",
                   "separates thousands");
  EXPECT_EQ(complaint("Travel (mm);Load (N)\n0,5;999,5\n1,0;1,234\n"), "");
  expect_complaint("Travel (um),Load (N)\n993,1\n\"1,007\",2\n",
                   "the comma in line 3 separates thousands or decimals");
}

// A mean that somebody wrote below the table, an empty line apart.
TEST_F(MachineTable, WhatStandsApartBelowTheTableIsNoRow) {
  const auto file = write("x (mm),f (N)\n1,2\n2,4\n\n,3\n\n");
  const MeasurementFile got =
      read_machine_table(file, list_tables(file).curve.at(0), {});
  expect_near(got.samples.force_n, {2.0, 4.0});
  ASSERT_EQ(got.notes.size(), 1U);
  EXPECT_NE(got.notes[0].find("line 5 stands below an empty one"), std::string::npos);
  expect_complaint("x (mm),f (N)\n1,2\n\n,3\n2,4\n", "line 4, column 1");
}

TEST_F(MachineTable, RefusesMissingCellsInTheMiddleAndAtTheEnd) {
  expect_complaint("x (mm),f (N)\n1,2\n3\n4,5\n", "line 3 has 1 cells");
  expect_complaint("x (mm),f (N)\n1,2\n3,4\n5,\n", "line 4, column 2");
  expect_complaint("x (mm),f (N)\n1,2\nlost,row\n4,5\n", "line 3, column 1");
  expect_complaint("x,f\n1,2\n3,4\n", "no column of the header states a unit");
  expect_complaint("\xFF\xFEx\0", "UTF-16");
}

}  // namespace
}  // namespace palpate
