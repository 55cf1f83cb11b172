// What instruments write as text, in files of our own.
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/measurement/instrument_file.h"
#include "formats/measurement/mach1_map.h"
#include "tests/formats/measurement/expect_near.h"
#include "tests/support/said.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kGramForce = 9.80665e-3;  // [N]

class InstrumentText : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text,
                              const std::string& name = "any.dat") const {
    const std::filesystem::path file = folder_ / name;
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

  static std::string layout(const std::filesystem::path& file) {
    return std::string(layout_of(file).name);
  }

  static MeasurementFile read(const std::filesystem::path& file, std::size_t which = 0,
                              const InstrumentRequest& request = {}) {
    const InstrumentLayout& layout = layout_of(file);
    return layout.read(file, layout.list(file).curve.at(which), request);
  }

  static std::string complaint(const std::filesystem::path& file, std::size_t which = 0,
                               const InstrumentRequest& request = {}) {
    try {
      (void)read(file, which, request);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  ScratchFolder folder_;
};

std::string mach1_block(const std::string& function, const std::string& keys,
                        const std::string& rows,
                        const std::string& end = "<END DATA>\r\n") {
  return "<INFO>\r\nLoad Cell Type:\tMultiple-axis\r\n<END INFO>\r\n<" + function +
         ">\r\n" + keys + "<DATA>\r\n" + rows + end;
}

const std::string kMach1 =
    "<Mach-1 File>\r\n" +
    mach1_block(
        "Find Contact", "Stage Axis:\tPosition (z)\r\nLoad Cell Axis:\tFz\r\n",
        "Time, s\tPosition (z), mm\tFz, gf\r\n0.0\t1.0\t0.0\r\n0.1\t1.1\t0.5\r\n") +
    mach1_block("Stress Relaxation",
                "Stage Axis:\tPosition (x)\r\nLoad Cell Axis:\tFx\r\n",
                "Time, s\tPosition (z), mm\tPosition (x), mm\tFz, gf\tFx, gf\r\n"
                "0.0\t9\t2.0\t7\t1\r\n0.5\t9\t2.5\t7\t3\r\n<divider>\r\n"
                "1.0\t9\t3.0\t7\t4\r\n") +
    mach1_block(
        "Stress Relaxation", "",
        "Time, s\tPosition (z), mm\tFz, N\r\n0.0\t1.0\t0.25\r\n0.1\t1.5\t0.5\r\n");

TEST_F(InstrumentText, Mach1BlocksThatPressAreTheFilesPresses) {
  const auto file = write(kMach1);
  EXPECT_EQ(layout(file), "Biomomentum Mach-1 text");
  const InstrumentFile list = layout_of(file).list(file);
  ASSERT_EQ(list.curve.size(), 2U);
  EXPECT_EQ(list.left_out, "1 Find Contact");
  EXPECT_EQ(name_curves(list.curve),
            "1 (Stress Relaxation, line 20), 2 (Stress Relaxation, line 31)");
  const MeasurementFile first = read(file, 0);  // its own axes, the divider passed over
  expect_near(first.samples.depth_m, {2e-3, 2.5e-3, 3e-3});
  expect_near(first.samples.force_n, {kGramForce, 3 * kGramForce, 4 * kGramForce});
  expect_near(first.samples.time_s, {0.0, 0.5, 1.0}, 1e-18);
  const MeasurementFile second = read(file, 1);  // another unit in another block
  expect_near(second.samples.force_n, {0.25, 0.5});
  const MeasurementFile told =
      read(file, 0, {{{"Position (z)", ""}, {"Fz", ""}, std::nullopt}});
  expect_near(told.samples.depth_m, {9e-3, 9e-3, 9e-3});
}

TEST_F(InstrumentText, Mach1TakesFindContactOnlyWhereNothingElsePresses) {
  const std::string rows = "Time, s\tPosition (z), mm\tFz, gf\n0\t1\t0\n1\t2\t1\n";
  const auto contact = write("<Mach-1 File>\n" + mach1_block("Find Contact", "", rows) +
                             mach1_block("Wait", "", rows));
  const InstrumentFile list = layout_of(contact).list(contact);
  EXPECT_EQ(list.curve.size(), 1U);
  EXPECT_EQ(list.left_out, "1 Wait");
  const auto still = write("<Mach-1 File>\n" + mach1_block("Sinusoid", "", rows) +
                           mach1_block("Sinusoid", "", rows));
  expect_says(complaint(still), "no block of the file presses: it holds 2 Sinusoid");
}

// Normal (3, 0, 4) / 5: the stage moves 0.5 mm along it, pressed with 2 N.
TEST_F(InstrumentText, Mach1NormalIndentationIsAlongTheNormalWithItsPosition) {
  const std::string keys =
      "Contacts mapping (x, y, z):\t1.5\t-2\t3\r\n"
      "Surface Normal (x, y, z):\t0.6\t0\t0.8\r\n";
  const std::string names =
      "Time, s\tPosition (z), mm\tPosition (x), mm\tPosition (y), mm\tFx, N\tFy, "
      "N\tFz, "
      "N\r\n";
  const auto file = write(
      "<Mach-1 File>\r\n" +
      mach1_block("Normal Indentation", keys,
                  names + "0\t10\t5\t1\t0\t0\t0\r\n1\t10.4\t5.3\t1\t1.2\t9\t1.6\r\n"));
  const InstrumentCurve curve = layout_of(file).list(file).curve.at(0);
  ASSERT_TRUE(curve.position_m && curve.normal);
  EXPECT_TRUE(curve.position_m->isApprox(Eigen::Vector3d(1.5e-3, -2e-3, 3e-3)));
  EXPECT_TRUE(curve.normal->isApprox(Eigen::Vector3d(0.6, 0.0, 0.8)));
  const MeasurementFile along = read(file);
  EXPECT_NEAR(along.samples.depth_m.at(1), 0.5e-3, 1e-15);
  EXPECT_NEAR(along.samples.force_n.at(1), 2.0, 1e-12);
  const auto beside =
      write("<Mach-1 File>\r\n" +
            mach1_block("Normal Indentation", keys,
                        names + "0\t10\t5\t1\t0\t0\t0\r\n1\t10.5\t5\t1\t0\t0\t1\r\n"));
  expect_says(complaint(beside), "37 deg off the surface normal");
}

TEST_F(InstrumentText, Mach1NamesTheBlockThatIsCutShort) {
  const std::string rows = "Time, s\tPosition (z), mm\tFz, gf\n0\t1\t0\n1\t2\t1\n";
  const auto file =
      write("<Mach-1 File>\n" + mach1_block("Stress Relaxation", "", rows) +
            mach1_block("Stress Relaxation", "", rows, ""));
  EXPECT_EQ(complaint(file, 0), "");
  expect_says(complaint(file, 1),
              "<Stress Relaxation> ends with the file, without <END DATA>");
  const auto bad = write("<Mach-1 File>\n" +
                         mach1_block("Stress Relaxation", "",
                                     "Time, s\tPosition (z), mm\tFz, gf\n0\t1\n"));
  expect_says(complaint(bad), "has 2 cells, column 3 \"Fz, gf\" is missing");
}

TEST_F(InstrumentText, AMapsPointsHavePositionsOfTheScan) {
  const std::string info = "a\ta\ta\ta\ta\ta\ta\n";
  const std::string names =
      "PixelX\tPixelY\tPointID\tPointType\tSub-SurfaceID\tScanX(mm)\tScanY(mm)\n";
  const auto lines = text_lines(info + info + names +
                                    "9\t9\t2\t0\tQP\t1.5\t-2\n9\t9\t1\t1\tQP\t8\t8\n"
                                    "9\t9\t1\t0\tQP\t4\t5\n",
                                "x.map");
  ASSERT_TRUE(is_mach1_map(lines));
  const auto points = read_mach1_map("x.map", lines);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].id, 2);
  EXPECT_TRUE(points[0].position_m.isApprox(Eigen::Vector2d(1.5e-3, -2e-3)));
  const auto pixels =
      text_lines("PixelX\tPixelY\tPointID\tPointType\n9\t9\t1\t0\n", "x.map");
  EXPECT_THROW((void)read_mach1_map("x.map", pixels), FormatError);
  const auto twice =
      text_lines(names + "9\t9\t1\t0\tQ\t1\t1\n9\t9\t1\t0\tQ\t1\t1\n", "x");
  EXPECT_THROW((void)read_mach1_map("x.map", twice), FormatError);
}

std::string optics11(const std::string& rows) {
  return "Date\t1/2/2026\r\n\rX-position (um)\t5000,5\r\nY-position (um)\t20.0\r\n"
         "k (N/m)\t0.5\r\nTip radius (um)\t25.000\r\nMax load (\xB5N)\t0.05\r\n\r\n"
         "Time (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\tAuxiliary"
         "\r\n" +
         rows;
}

TEST_F(InstrumentText, Optics11DepthIsPiezoLessCantileverAndTheTipItsOwn) {
  std::string rows;
  for (int i = 0; i < 10; ++i) {  // free: the indentation stands at 0
    rows += fmt::format("0.{0}\t0.0{0}\t0.0\t0.0\t{0}0.0\t0\r\n", i);
  }
  rows += "1.0\t2.5\t95.0\t5.0\t100.0\t0\r\n";
  const auto file = write(optics11(rows));
  EXPECT_EQ(layout(file), "Optics11 text");
  const InstrumentCurve curve = layout_of(file).list(file).curve.at(0);
  EXPECT_DOUBLE_EQ(curve.tip_radius_m.value(), 25e-6);
  EXPECT_DOUBLE_EQ(curve.spring_n_per_m.value(), 0.5);
  EXPECT_TRUE(curve.position_m->isApprox(Eigen::Vector3d(5000.5e-6, 20e-6, 0.0)));
  const MeasurementFile got = read(file);
  EXPECT_NEAR(got.samples.depth_m.at(5), 50e-9, 1e-18);
  EXPECT_NEAR(got.samples.depth_m.back(), 95e-9, 1e-18);
  EXPECT_NEAR(got.samples.force_n.back(), 2.5e-6, 1e-15);
  EXPECT_NEAR(got.samples.time_s.back(), 1.0, 1e-12);
  expect_says(complaint(file, 0, {{{"Indentation", ""}, {}, std::nullopt}}),
              "stands at 0 in the first 10 samples: it is clipped");
  expect_says(complaint(write(optics11("0\t1\t2\n"))), "is missing");
}

std::string tab(const std::string& count, const std::string& names) {
  return "# afmformats 0.13\n#\n# BEGIN METADATA\n# {\n#   \"point count\": " + count +
         ",\n#   \"position x\": 0.25, \"position y\": 0.5,\n"
         "#   \"spring constant\": 0.5\n# }\n# END METADATA\n#\n# " +
         names + "\n1.0\t9e-6\tFalse\t0.0\n2.0\t8e-6\tFalse\t0.1\n";
}

TEST_F(InstrumentText, AfmTabDepthIsMinusHeightAndBending) {
  const auto file = write(tab("2", "force\theight (measured)\tsegment\ttime"));
  EXPECT_EQ(layout(file), "afmformats text");
  const MeasurementFile got = read(file);
  expect_near(got.samples.depth_m, {-(9e-6 + 2.0), -(8e-6 + 4.0)});
  expect_near(got.samples.force_n, {1.0, 2.0});
  expect_near(got.samples.time_s, {0.0, 0.1}, 1e-18);
  const InstrumentCurve curve = layout_of(file).list(file).curve.at(0);
  EXPECT_TRUE(curve.position_m->isApprox(Eigen::Vector3d(0.25, 0.5, 0.0)));
  expect_says(complaint(write(tab("3", "force\theight (measured)\tsegment\ttime"))),
              "holds 2 rows, its metadata count 3");
  expect_says(complaint(write(tab("2", "force\tindentation\tsegment\ttime"))),
              "does not name the columns force and");
  expect_says(
      complaint(write("# BEGIN METADATA\n# { nonsense\n# END METADATA\n1\t2\n")),
      "no JSON object");
}

}  // namespace
}  // namespace palpate
