#include "formats/measurement/measurement_file.h"

#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class MeasurementFileTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    const std::filesystem::path file = folder_ / "curve.csv";
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

  // The message of the error that reading `text` gives; empty if it is read.
  template <typename Kind>
  std::string complaint(const std::string& text, const MeasurementColumn& depth,
                        const MeasurementColumn& force) const {
    try {
      (void)read_measurement(write(text), depth, force);
    } catch (const Kind& error) {
      return error.what();
    }
    return "";
  }

  const MeasurementColumn x_{"x", "mm"};
  const MeasurementColumn f_{"f", "N"};

 private:
  ScratchFolder folder_;
};

TEST_F(MeasurementFileTest, ConvertsToSi) {
  const auto read =
      read_measurement(write("x,f\n1,100\n2.5,-200\n"), {"x", "um"}, {"f", "gf"});
  EXPECT_EQ(read.samples.depth_m, (std::vector<double>{1.0 * 1e-6, 2.5 * 1e-6}));
  EXPECT_EQ(read.samples.force_n,
            (std::vector<double>{100 * 9.80665e-3, -200 * 9.80665e-3}));
}

TEST_F(MeasurementFileTest, ReadsEveryDelimiterAndTheDecimalComma) {
  const std::vector<double> depth{0.5 * 1e-3, 1.25 * 1e-3};
  for (const char* text :
       {"x,f\n0.5,1\n1.25,2\n", "x\tf\n0.5\t1\n1.25\t2\n", "x\tf\n0,5\t1\n1,25\t2,0\n",
        "x;f\n0,5;1\n1,25;2\n", "x,f\n\"0,5\",\"1,0\"\n\"1,25\",2\n",
        "  x   f\n 0.5  1\n1.25\t2\n", "x,f\r0.5,1\r1.25,2\r",
        "# of a rig\n#\n# x f\n0.5 1\n1.25 2\n", "% x f\n0.5 1\n1.25 2\n",
        "x ; f\r\n +0,5 ; 1e0\r\n\r\n1.25;2\r\n"}) {
    const auto read = read_measurement(write(text), x_, f_);
    EXPECT_EQ(read.samples.depth_m, depth) << text;
    EXPECT_EQ(read.samples.force_n, (std::vector<double>{1.0, 2.0})) << text;
  }
}

TEST_F(MeasurementFileTest, SkipsCommentsFreeLinesUnitsAndEmptyPairs) {
  const std::string text =
      "\xEF\xBB\xBF# made by a machine, 2, 3\nCylinder Height: 30mm;\nspeed,10\n\n"
      "\"time, s\",x,f\n(s),(mm),[N]\n0,1,2\n# pause\n1,2,3\n2,,\n3,nan,NaN\n";
  const auto read = read_measurement(write(text), x_, f_);
  EXPECT_EQ(read.samples.force_n, (std::vector<double>{2.0, 3.0}));
}

TEST_F(MeasurementFileTest, FindsColumnsByNumberWithAndWithoutHeader) {
  for (const char* text : {"0,1,2\n0,3,4\n", "a,b,c\n0,1,2\n0,3,4\n"}) {
    const auto read = read_measurement(write(text), {"3", "m"}, {"2", "N"});
    EXPECT_EQ(read.samples.depth_m, (std::vector<double>{2.0, 4.0}));
    EXPECT_EQ(read.samples.force_n, (std::vector<double>{1.0, 3.0}));
  }
}

TEST_F(MeasurementFileTest, NamesMatchExactlyThenByCaseThenWithoutUnit) {
  const std::string text = "Load,load,Load (N),travel_mm\n1,2,3,4\n";
  const MeasurementColumn travel{"Travel", "mm"};
  const auto force = [&](const std::string& name) {
    return read_measurement(write(text), travel, {name, "N"}).samples.force_n[0];
  };
  EXPECT_EQ(force("load"), 2.0);
  EXPECT_EQ(force("load (n)"), 3.0);
  EXPECT_NE(complaint<InputError>(text, travel, {"LOAD", "N"}).find("2 columns"),
            std::string::npos);
}

TEST_F(MeasurementFileTest, RefusesAUnitThatTheHeaderContradicts) {
  const std::string text = "travel_um,Load (N)\n1,2\n";
  EXPECT_NE(complaint<InputError>(text, {"travel", "um"}, {"Load", "gf"})
                .find("states the unit N, but the force unit is given as gf"),
            std::string::npos);
  EXPECT_NE(complaint<InputError>(text, {"travel", "mm"}, {"Load", "N"}).find("um"),
            std::string::npos);
  EXPECT_NE(complaint<InputError>(text, {"Load", "mm"}, {"travel", "N"}), "");
  EXPECT_NE(complaint<InputError>("x,f\n(um),(N)\n1,2\n", x_, f_).find("line 2"),
            std::string::npos);
  const auto read = read_measurement(write(text), {"travel", "mm"}, {"Load", "gf"},
                                     HeaderUnits::kIgnored);
  EXPECT_DOUBLE_EQ(read.samples.depth_m[0], 1e-3);
}

TEST_F(MeasurementFileTest, ReadsTimeBesideDepthAndForce) {
  const auto read = read_measurement(write("t\tx\tf\n0\t1\t2\n500\t1,5\t4\n"),
                                     {x_, f_, MeasurementColumn{"t", "ms"}});
  EXPECT_EQ(read.samples.time_s, (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(read.time_column, "t");
}

TEST_F(MeasurementFileTest, TakesUnitsFromHeaderOrUnitLineWhereAsked) {
  const MeasurementColumns any{{"x", kUnitFromHeader},
                               {"f", kUnitFromHeader},
                               MeasurementColumn{"t", kUnitFromHeader}};
  for (const char* text :
       {"t_ms,x [um],f (gf)\n500,1000,2\n", "t,x,f\n(ms),[um],gf\n500,1000,2\n"}) {
    const Measurement m = read_measurement(write(text), any).samples;
    EXPECT_DOUBLE_EQ(m.time_s[0], 0.5);
    EXPECT_DOUBLE_EQ(m.depth_m[0], 1e-3);
    EXPECT_DOUBLE_EQ(m.force_n[0], 2 * 9.80665e-3);
  }
  for (const char* text : {"t_ms,x,f (gf)\n1,1,1\n", "t_ms,x (N),f (gf)\n1,1,1\n"}) {
    EXPECT_THROW((void)read_measurement(write(text), any), InputError) << text;
  }
}

TEST_F(MeasurementFileTest, NamesTheBadCell) {
  for (const char* cell : {"nan", "inf", "1,5", "1.2.3", "--", "", "1 2"}) {
    const std::string text = fmt::format("x;f\n1;2\n# c\n2;{}x\n", cell);
    EXPECT_NE(complaint<FormatError>(text, x_, f_).find("line 4, column 2 \"f\""),
              std::string::npos)
        << cell;
  }
  for (const char* cell : {"nan", "-inf", ""}) {
    EXPECT_NE(complaint<FormatError>(fmt::format("x,f\n{},1\n", cell), x_, f_)
                  .find("line 2, column 1 \"x\""),
              std::string::npos);
  }
  EXPECT_NE(complaint<FormatError>("x,f\n1,2\n3\n", x_, f_).find("line 3 has 1 cells"),
            std::string::npos);
}

TEST_F(MeasurementFileTest, ListsTheColumnsNearestFirst) {
  const std::string text = "time_s,Load (N),Compression (mm)\n0,1,2\n";
  EXPECT_NE(complaint<InputError>(text, {"compresion", "mm"}, {"Load", "N"})
                .find("\"Compression (mm)\", \"time_s\", \"Load (N)\""),
            std::string::npos);
  EXPECT_NE(complaint<InputError>("1,2\n3,4\n", x_, f_).find("none has a name"),
            std::string::npos);
}

TEST_F(MeasurementFileTest, RefusesWhatIsNoTable) {
  EXPECT_NE(complaint<InputError>("words\n", x_, f_).find("no row"), std::string::npos);
  EXPECT_NE(complaint<InputError>("x,f\n", x_, f_).find("no rows"), std::string::npos);
  EXPECT_NE(complaint<InputError>("", x_, f_), "");
  EXPECT_NE(complaint<FormatError>(std::string("x\0f\n", 4), x_, f_).find("zero byte"),
            std::string::npos);
  EXPECT_NE(complaint<InputError>("x,f\n1,2\n", {"0", "mm"}, f_), "");
  EXPECT_NE(complaint<InputError>("x,f\n1,2\n", {"7", "mm"}, {"2", "N"}), "");
  EXPECT_NE(complaint<InputError>("x,f\n1,2\n", {"x", "furlong"}, f_).find("furlong"),
            std::string::npos);
  EXPECT_THROW((void)read_measurement("absent.csv", x_, f_), InputError);
  EXPECT_THROW((void)read_measurement("/", x_, f_), InputError);
}

TEST(MeasurementFileOnRealData, ReadsAnInstrumentsExport) {
  const auto file = test_data("tissue_phantom_compression/EF10_0T/EF10_0T_A1.csv");
  if (!file) {
    GTEST_SKIP() << "no test data";
  }
  const auto read = read_measurement(*file, {"compression", "mm"}, {"Load (N)", "N"});
  ASSERT_EQ(read.samples.depth_m.size(), 1202U);
  EXPECT_DOUBLE_EQ(read.samples.depth_m.back(), 20.00004e-3);
  EXPECT_DOUBLE_EQ(read.samples.force_n.back(), 499.32315);
}

}  // namespace
}  // namespace palpate
