#include "fitting/session/session.h"

#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/batch_folder.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// A session that reads columns x and f, and has these tables too.
std::string with(const std::string& rest) {
  return fmt::format("{}{}", kRead, rest);
}

class SessionTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  Session read(const std::string& text) const {
    write("session.toml", text);
    return read_session(folder_ / "session.toml");
  }

  std::string complaint(const std::string& text) const {
    try {
      (void)read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  void expect_complaint(const std::string& text, const std::string& part) const {
    const std::string message = complaint(text);
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }

  ScratchFolder folder_;
};

TEST_F(SessionTest, ReadsWhatIsThere) {
  const Session s =
      read(with("time_column = 3\ntime_unit = \"ms\"\n"
                "[session]\nname = \"liver\"\n"
                "[indenter]\nshape = \"cone\"\nhalf_angle_deg = 45\n"
                "poissons_ratio = 0.4\nfriction = 0.3\n"
                "[body]\nmesh = \"b.obj\"\nlength_unit = \"mm\"\n"
                "[fit]\nfrom_m = 0.001\nbaseline_m = [0, 0.002]\n"
                "families = [\"polynomial\"]\ncriterion = \"bic\"\n"
                "noise_relative = 0.02\n"
                "[[run]]\nfile = \"a.csv\"\nposition_m = [1, 2, 3]\n"
                "normal = [0, 0, 2]\npoint = \"A\"\n"));
  EXPECT_EQ(s.name, "liver");
  EXPECT_EQ(s.columns.time->column, "3");
  EXPECT_EQ(s.columns.time->unit, "ms");
  EXPECT_NEAR(s.indenter.half_angle_rad, std::numbers::pi / 4, 1e-15);
  EXPECT_EQ(s.tool->kind, "cone");
  EXPECT_EQ(s.tool->friction, 0.3);
  EXPECT_EQ(s.mesh, folder_ / "b.obj");
  EXPECT_EQ(s.fit.range.from_m, 0.001);
  EXPECT_EQ(s.fit.baseline->to_m, 0.002);
  EXPECT_EQ(s.fit.families, std::vector<std::string>{"polynomial"});
  EXPECT_EQ(s.fit.criterion, "bic");
  EXPECT_EQ(s.fit.noise_relative, 0.02);
  ASSERT_EQ(s.run.size(), 1U);
  EXPECT_EQ(s.run[0].file, folder_ / "a.csv");
  EXPECT_EQ(*s.run[0].position_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(*s.run[0].normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(s.run[0].point, "A");
}

TEST_F(SessionTest, ClaimsNothingOfAnIndenterThatItDoesNotName) {
  const Session s = read(with("[[run]]\nfile = \"a.csv\"\n"));
  EXPECT_EQ(s.indenter.shape, "unknown");
  EXPECT_FALSE(s.tool.has_value());
  EXPECT_EQ(s.name, "session");
  EXPECT_EQ(s.fit.families.size(), kFamilyNames.size());
}

TEST_F(SessionTest, ExpandsPatternsInTheOrderOfTheAlphabet) {
  for (const char* name : {"b.csv", "a.csv", "c.txt"}) {
    write(name, "");
  }
  const Session s = read(with("[[run]]\nfiles = [\"*.csv\", \"c.txt\"]\n"));
  ASSERT_EQ(s.run.size(), 3U);
  EXPECT_EQ(s.run[0].name, "a.csv");
  EXPECT_EQ(s.run[1].name, "b.csv");
  EXPECT_EQ(s.run[2].name, "c.txt");
  EXPECT_EQ(s.run[0].point, "a.csv");
  expect_complaint(with("[[run]]\nfiles = \"*.dat\"\n"),
                   "\"*.dat\" in [[run]] matches no file");
}

TEST_F(SessionTest, FilesAtOnePositionAreRepeats) {
  const Session s =
      read(with("[[run]]\nfiles = [\"a.csv\", \"b.csv\"]\nposition_m = [0,0,0]\n"
                "[[run]]\nfile = \"c.csv\"\nposition_m = [1,0,0]\n"));
  EXPECT_EQ(s.run[0].point, s.run[1].point);
  EXPECT_NE(s.run[0].point, s.run[2].point);
}

TEST_F(SessionTest, TakesPositionsFromATable) {
  write("points.csv",
        "file;x;y;z;nx;ny;nz;point\na.csv;1,5;2;3;0;3;4;P\nb.csv;0;0;0;1;0;0;P\n");
  const std::string points = "[points]\ntable = \"points.csv\"\nlength_unit = \"mm\"\n";
  const std::string both = "[[run]]\nfiles = [\"a.csv\", \"b.csv\"]\n";
  const Session s = read(with(both + points));
  EXPECT_NEAR((*s.run[0].position_m - Eigen::Vector3d(1.5e-3, 2e-3, 3e-3)).norm(), 0.0,
              1e-18);
  EXPECT_NEAR((*s.run[0].normal - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_EQ(s.run[1].point, "P");
  expect_complaint(with("[[run]]\nfile = \"a.csv\"\n") + points,
                   "line 3: the session has no run of \"b.csv\"");
  expect_complaint(with(both + "[[run]]\nfile = \"c.csv\"\n" + points),
                   "no row for the run \"c.csv\"");
}

TEST_F(SessionTest, SaysWhereItIsWrongAndWhatIsRight) {
  const std::string run = "[[run]]\nfile = \"a.csv\"\n";
  expect_complaint(with(run + "[indentor]\n"), "nearest known one is \"indenter\"");
  expect_complaint("[read]\ndepth_colum = 1\n" + run, "session.toml:2: unknown key");
  expect_complaint("[read]\ndepth_column = 0\n" + run, "counted from 1");
  expect_complaint("[read]\ndepth_column = 1\ndepth_unit = \"furlong\"\n" + run,
                   "session.toml:3: depth_unit in [read]: unknown length unit");
  expect_complaint(with(run + "[indenter]\nshape = \"ball\"\n"),
                   "available: sphere, flat-punch, cone, plate, unknown");
  expect_complaint(with(run + "[indenter]\nshape = \"sphere\"\n"), "radius_m");
  expect_complaint(with(run + "[indenter]\nshape = \"unknown\"\nradius_m = 1.0\n"),
                   "does not belong to shape \"unknown\"");
  expect_complaint(with(run + "[fit]\nfamilies = [\"spline\"]\n"), "convex-spline");
  expect_complaint(with(run + "[fit]\nfrom_m = 2.0\nto_m = 1.0\n"), "less than");
  expect_complaint(with(run + "[fit]\nnoise_relative = 1.0\n"), "in [0, 1)");
  expect_complaint(with(run + run), "a second time");
  expect_complaint(with("[[run]]\nfiles = []\n"), "list of texts");
  expect_complaint(kRead, "run");
  expect_complaint("[read\n", "is not TOML");
  EXPECT_THROW((void)read_session(folder_ / "absent.toml"), InputError);
  std::ofstream(folder_ / "a.csv") << "Travel (mm),Load (N)\n1,2\n";
  try {
    (void)read_session(folder_ / "a.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("palpate-fit curve"), std::string::npos);
  }
}

TEST_F(SessionTest, ReadsARunWithItsTime) {
  write("a.csv", "t,x,f\n0,1,2\n5,3,4\n");
  const Session s =
      read(with("time_column = \"t\"\ntime_unit = \"ms\"\n"
                "[[run]]\nfile = \"a.csv\"\n"));
  const Measurement m = read_run(s, s.run[0]).samples;
  EXPECT_EQ(m.depth_m, (std::vector<double>{1e-3, 3e-3}));
  EXPECT_EQ(m.time_s, (std::vector<double>{0.0, 5e-3}));
}

TEST_F(SessionTest, ReadsForceCurvesOfAfmformats) {
  const auto file = test_data("afm/fmt-hdf5-fd_version_0.13.3.h5");
  if (!file) {
    GTEST_SKIP() << "no test data";
  }
  const Session s = read("[read]\nlayout = \"afm-hdf5\"\n[[run]]\nfile = \"" +
                         file->string() + "\"\n");
  ASSERT_EQ(s.run.size(), 1U);
  EXPECT_TRUE(s.run[0].name.ends_with("#0"));
  const Measurement m = read_run(s, s.run[0]).samples;
  EXPECT_EQ(m.force_n.size(), 7796U);
  EXPECT_EQ(m.time_s.size(), 7796U);
  EXPECT_GT(*std::max_element(m.depth_m.begin(), m.depth_m.end()), m.depth_m.front());
}

TEST_F(SessionTest, AnAfmFileThatIsNoneIsNamedWhenItIsRead) {
  write("a.h5", "nothing");
  const Session s = read("[read]\nlayout = \"afm-hdf5\"\n[[run]]\nfile = \"a.h5\"\n");
  ASSERT_EQ(s.run.size(), 1U);
  EXPECT_THROW((void)read_run(s, s.run[0]), FormatError);
}

std::string mach1(const std::string& position, const std::string& normal, int presses) {
  std::string text = "<Mach-1 File>\n";
  for (int i = 0; i < presses; ++i) {
    text += "<INFO>\n<END INFO>\n<Normal Indentation>\nContacts mapping (x, y, z):\t" +
            position + "\nSurface Normal (x, y, z):\t" + normal +
            "\n<DATA>\nTime, s\tPosition (z), mm\tFz, gf\n0\t0\t0\n1\t1\t1000\n"
            "<END DATA>\n";
  }
  return text;
}

TEST_F(SessionTest, AutoTakesPressesPositionsAndNormalsOfTheFiles) {
  write("a.txt", mach1("1\t2\t3", "0\t0\t2", 2));
  write("b.csv", "Travel (mm),Load (N)\n0,1\n1,2\n");
  const Session s = read("[read]\nlayout = \"auto\"\n[[run]]\nfiles = \"[ab].*\"\n");
  ASSERT_EQ(s.run.size(), 3U);
  EXPECT_EQ(s.run[0].name, "a.txt#1");
  EXPECT_EQ(s.run[1].name, "a.txt#2");
  EXPECT_EQ(s.run[2].name, "b.csv");
  EXPECT_TRUE(s.run[1].position_m->isApprox(Eigen::Vector3d(1e-3, 2e-3, 3e-3)));
  EXPECT_EQ(*s.run[1].normal, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(s.run[2].position_m);
  ASSERT_EQ(s.notes.size(), 2U);
  EXPECT_EQ(s.notes[0],
            "a.txt: Biomomentum Mach-1 text, 2 presses; positions and normals are the "
            "file's");
  EXPECT_NEAR(read_run(s, s.run[0]).samples.force_n.at(1), 9.80665, 1e-12);
  EXPECT_EQ(read_run(s, s.run[0]).samples.time_s.size(), 2U);
  EXPECT_NEAR(read_run(s, s.run[2]).samples.depth_m.at(1), 1e-3, 1e-15);
}

TEST_F(SessionTest, TheSessionsPositionGoesBeforeTheFiles) {
  write("a.txt", mach1("1\t2\t3", "0\t0\t1", 2));
  write("points.csv", "file,x,y,z\na.txt#2,7,8,9\n");
  const std::string start = "[read]\nlayout = \"auto\"\n[[run]]\nfile = \"a.txt\"\n";
  const Session told = read(start + "position_m = [4, 5, 6]\n");
  EXPECT_EQ(*told.run[1].position_m, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(*told.run[1].normal, Eigen::Vector3d::UnitZ());  // the file's still
  const Session table =
      read(start + "[points]\ntable = \"points.csv\"\nlength_unit = \"m\"\n");
  EXPECT_EQ(*table.run[1].position_m, Eigen::Vector3d(7, 8, 9));
  EXPECT_TRUE(table.run[0].position_m->isApprox(Eigen::Vector3d(1e-3, 2e-3, 3e-3)));
}

TEST_F(SessionTest, AMapPlacesThePressesOfItsFile) {
  write("a.txt", mach1("", "", 2));
  const std::string names =
      "PixelX\tPixelY\tPointID\tPointType\tScanX(mm)\tScanY(mm)\n";
  write("a.map", "i\ti\n" + names + "0\t0\t2\t0\t3\t4\n0\t0\t1\t0\t1\t2\n");
  const std::string start =
      "[read]\nlayout = \"auto\"\n[[run]]\nfile = \"a.txt\"\n[points]\ntable = ";
  const Session s = read(start + "\"a.map\"\n");
  EXPECT_TRUE(s.run[0].position_m->isApprox(Eigen::Vector3d(1e-3, 2e-3, 0.0)));
  EXPECT_TRUE(s.run[1].position_m->isApprox(Eigen::Vector3d(3e-3, 4e-3, 0.0)));
  write("short.map", names + "0\t0\t1\t0\t1\t2\n");
  expect_complaint(start + "\"short.map\"\n", "1 points that were pressed");
}

std::string optics11(const std::string& radius) {
  return "Tip radius (um)\t" + radius +
         "\nTime (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\n"
         "0\t0\t0\t0\t0\n1\t1\t90\t10\t100\n";
}

TEST_F(SessionTest, ASphereWithoutARadiusHasTheFiles) {
  write("a.txt", optics11("25"));
  write("b.txt", optics11("25.0"));
  const std::string start =
      "[read]\nlayout = \"auto\"\n[[run]]\nfiles = \"*.txt\"\n[indenter]\nshape = "
      "\"sphere\"\n";
  const Session s = read(start);
  EXPECT_DOUBLE_EQ(s.indenter.radius_m, 25e-6);
  EXPECT_DOUBLE_EQ(s.tool->radius_m, 25e-6);
  EXPECT_DOUBLE_EQ(read(start + "radius_m = 3e-5\n").indenter.radius_m, 3e-5);
  write("b.txt", optics11("9"));
  expect_complaint(start, "states 9e-06 m where others state 2.5e-05 m; tell radius_m");
  write("b.txt", "x (mm),f (N)\n1,2\n3,4\n");
  expect_complaint(start, "the run \"b.txt\" states none; tell radius_m");
}

TEST_F(SessionTest, AutoTakesWhatIsToldBeforeTheHeader) {
  write("a.csv", "Stroke (mm),Gauge (um),Load (N)\n0,0,1\n1,500,2\n");
  const std::string run = "[[run]]\nfile = \"a.csv\"\n";
  const Session ask = read("[read]\nlayout = \"auto\"\n" + run);
  EXPECT_THROW((void)read_run(ask, ask.run[0]), InputError);
  const Session s = read("[read]\nlayout = \"auto\"\ndepth_column = \"Gauge\"\n" + run);
  EXPECT_NEAR(read_run(s, s.run[0]).samples.depth_m.at(1), 5e-4, 1e-15);
  expect_complaint("[read]\nlayout = \"auto\"\ndepth_unit = \"mm\"\n" + run,
                   "needs depth_column");
}

TEST_F(SessionTest, AFileThatCannotBeListedIsARunWithItsReason) {
  write("a.jpk-force", "PK\x03\x04 and no more");
  const Session s =
      read("[read]\nlayout = \"auto\"\n[[run]]\nfile = \"a.jpk-force\"\n");
  ASSERT_EQ(s.run.size(), 1U);
  EXPECT_THROW((void)read_run(s, s.run[0]), FormatError);
}

}  // namespace
}  // namespace palpate
