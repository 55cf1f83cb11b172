// Layouts that laboratories hand over, each a small file of our own.
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/measurement/instrument_file.h"
#include "tests/support/said.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class LabLayouts : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    std::ofstream(folder_ / "a.txt", std::ios::binary) << text;
    return folder_ / "a.txt";
  }
  MeasurementFile read(const std::string& text, std::size_t which = 0,
                       const InstrumentRequest& request = {}) const {
    const auto file = write(text);
    const InstrumentLayout& layout = layout_of(file);
    const InstrumentFile list = layout.list(file);
    return layout.read(file, list.curve.at(which), request);
  }
  std::string refused(const std::string& text) const {
    return refusal([&] {
      (void)read(text);
    });
  }

  ScratchFolder folder_;
};

constexpr double kSpring = 0.3;  // [N/m]

// A cantilever's foot 10 nm further each sample, bent by a tenth of it after the fifth.
double foot_nm(int i) {
  return 10.0 * i;
}
double bent_nm(int i) {
  return i < 5 ? 0.0 : 1.0 * (i - 5);
}

std::string jpk_segment(const char* name, int first, int last) {
  std::string text = fmt::format(
      "# segmentIndex: 0\n# segment: {}\n# columns: vDeflection height measuredHeight "
      "seriesTime\n# springConstant: 0.3\n#\n# units: N m m s\n\n",
      name);
  const int step = first < last ? 1 : -1;
  for (int i = first; i != last; i += step) {
    text += fmt::format("{:e} 0 {:e} {}\n", kSpring * 1e-9 * bent_nm(i),
                        1e-5 - 1e-9 * foot_nm(i), step > 0 ? i : 40 - i);
  }
  return text + "\n";
}

TEST_F(LabLayouts, JpkTextGivesIndentationOfAllSegments) {
  const MeasurementFile file = read("# TEXT EXPORT\n" + jpk_segment("extend", 0, 20) +
                                    jpk_segment("retract", 19, -1));
  ASSERT_EQ(file.samples.depth_m.size(), 40U);
  EXPECT_EQ(file.samples.time_s.size(), 40U);
  for (const int i : {0, 4, 10, 19}) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_NEAR(file.samples.depth_m[at], 1e-9 * (foot_nm(i) - bent_nm(i)) - 1e-5,
                1e-18);
    EXPECT_NEAR(file.samples.force_n[at], kSpring * 1e-9 * bent_nm(i), 1e-18);
    EXPECT_NEAR(file.samples.force_n[39 - at], file.samples.force_n[at], 1e-18);
  }
}

TEST_F(LabLayouts, JpkTextWithoutSpringConstantSaysSo) {
  std::string text = "# TEXT EXPORT\n" + jpk_segment("extend", 0, 20);
  text.erase(text.find("# springConstant: 0.3\n"), 22);
  EXPECT_NE(refused(text).find("spring constant"), std::string::npos);
}

std::string nanoscope(const std::string& head, const char* unit, double per_nm) {
  std::string text = head + fmt::format(
                                "Calc_Ramp_Ex_nm\tCalc_Ramp_Rt_nm\tDefl_{0}_Ex\t"
                                "Defl_{0}_Rt\t\n",
                                unit);
  for (int i = 0; i < 20; ++i) {
    text += fmt::format("{}\t{}\t{}\t{}\t\n", foot_nm(i), foot_nm(19 - i),
                        per_nm * bent_nm(i), per_nm * bent_nm(19 - i));
  }
  return text;
}

TEST_F(LabLayouts, NanoScopeTextIsApproachThenRetract) {
  const std::string head = "\"\\?Force file list\"\n\"\\Spring Constant: 0.3\"\n";
  for (const auto& [unit, per_nm] : {std::pair{"nm", 1.0}, std::pair{"pN", 300.0}}) {
    const MeasurementFile file = read(nanoscope(head, unit, per_nm));
    ASSERT_EQ(file.samples.depth_m.size(), 40U) << unit;
    EXPECT_NEAR(file.samples.depth_m[19], 1e-9 * (foot_nm(19) - bent_nm(19)), 1e-18);
    EXPECT_NEAR(file.samples.force_n[20], kSpring * 1e-9 * bent_nm(19), 1e-18);
    EXPECT_NEAR(file.samples.force_n[39], 0.0, 1e-18);
  }
  const MeasurementFile volts =
      read(nanoscope(head + "\"\\@Sens. DeflSens: V 50.0 nm/V\"\n", "V", 0.02));
  EXPECT_NEAR(volts.samples.force_n[19], kSpring * 1e-9 * bent_nm(19), 1e-18);
}

TEST_F(LabLayouts, NanoScopeTextInVoltsSaysWhatLacks) {
  const std::string text = refused(nanoscope("", "V", 0.02));
  EXPECT_NE(text.find("sensitivity"), std::string::npos) << text;
  EXPECT_NE(text.find("spring constant"), std::string::npos) << text;
}

TEST_F(LabLayouts, TwoLengthsWithoutAForceAreADeflection) {
  const std::string text =
      refused("    \xC2\xB5m   \tnm\n0.0\t0.1\n0.1\t0.2\n0.2\t0.1\n");
  EXPECT_NE(text.find("cantilever"), std::string::npos) << text;
}

TEST_F(LabLayouts, ThousandsInQuotesAreReadWhereAPointTellsThem) {
  const MeasurementFile file = read(
      "Time,Extension,Load\n(s),(mm),(N)\n\"999.50000\",\"0.1\",\"0.2\"\n"
      "\"1,000.06200\",\"0.2\",\"-1,234.5\"\n\"1,000.5\",\"0.3\",\"0.4\"\n");
  ASSERT_EQ(file.samples.time_s.size(), 3U);
  EXPECT_DOUBLE_EQ(file.samples.time_s[1], 1000.062);
  EXPECT_DOUBLE_EQ(file.samples.force_n[1], -1234.5);
}

TEST_F(LabLayouts, NumberedNamesSideBySideArePresses) {
  const std::string text =
      "X_gel_1_Time_[s]\tY_gel_1_Fn_[mN]\tX_gel_1_Time_[s]\tY_gel_1_Pd_[nm]\t"
      "X_gel_2_Time_[s]\tY_gel_2_Fn_[mN]\tX_gel_2_Time_[s]\tY_gel_2_Pd_[nm]\n"
      "0\t1\t0\t10\t0.5\t2\t0.5\t20\n1\t3\t1\t30\t1.5\t4\t1.5\t40\n";
  EXPECT_EQ(layout_of(write(text)).list(folder_ / "a.txt").curve.size(), 2U);
  const MeasurementFile second = read(text, 1);
  EXPECT_DOUBLE_EQ(second.samples.force_n[1], 4e-3);
  EXPECT_DOUBLE_EQ(second.samples.depth_m[0], 20e-9);
  EXPECT_DOUBLE_EQ(second.samples.time_s[0], 0.5);
}

TEST_F(LabLayouts, GramsAreTheForceWhereNothingElseIs) {
  const MeasurementFile file =
      read("Steps,Travel (mm),Scale (grams)\n0,0.0,0.0\n1,0.1,1.0\n2,0.2,2.0\n");
  EXPECT_NEAR(file.samples.force_n[2], 2.0 * 9.80665e-3, 1e-12);
  EXPECT_FALSE(file.notes.empty());
}

TEST_F(LabLayouts, AStandardDeviationIsNoForce) {
  const MeasurementFile file =
      read("Z(m),F_avg(N),F_std(N)\n0,1,9\n1e-3,2,9\n2e-3,3,9\n");
  EXPECT_EQ(file.force_column, "F_avg(N)");
}

TEST_F(LabLayouts, AMarkOfCommentsBelongsToNoName) {
  InstrumentRequest request;
  request.given = {{"z", "m"}, {"f", "N"}, MeasurementColumn{"%time", "ns"}};
  const MeasurementFile file = read("%time,z,f\n1000,0,1\n2000,1,2\n", 0, request);
  EXPECT_NEAR(file.samples.time_s[1], 2e-6, 1e-18);
}

TEST_F(LabLayouts, AWordAmongTheFirstRowsIsNone) {
  const MeasurementFile file = read("Depth (nm)\tLoad (uN)\n1\t2\neoh\n3\t4\n5\t6\n");
  EXPECT_EQ(file.samples.depth_m.size(), 3U);
  ASSERT_FALSE(file.notes.empty());
  EXPECT_NE(file.notes[0].find("eoh"), std::string::npos);
}

TEST_F(LabLayouts, TwoTimesAreTold) {
  const MeasurementFile file = read(
      "Extension (mm),Load (N),Time (s),Video Time (s)\n0,1,0,0\n1,2,1,1\n2,3,2,2\n");
  EXPECT_TRUE(file.samples.time_s.empty());
  ASSERT_FALSE(file.notes.empty());
  EXPECT_NE(file.notes[0].find("Video Time"), std::string::npos);
}

TEST_F(LabLayouts, BinaryFilesAreNamedWithWhatToDo) {
  using namespace std::string_view_literals;
  constexpr std::pair<std::string_view, const char*> kCases[] = {
      {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv, ".xlsx"},
      {"TDSm\x0E"sv, "LabVIEW"},
      {"\\*Force file list\r\n\\Version: 1\r\n"sv, "NanoScope"},
      {"\x05\x00\xCF\x1C"sv, "Igor"},
      {"\x1F\x8B\x08"sv, "unpack"}};
  for (const auto& [head, part] : kCases) {
    expect_says(refused(std::string(head) + std::string(400, '\0')), part);
  }
}

TEST_F(LabLayouts, AMotorThatHasYetToStartIsNoClippedDepth) {
  const auto table = [](double drift) {
    std::string text = "Distance (mm)\tForce (N)\n";
    for (int i = 0; i < 60; ++i) {
      text += fmt::format("{}\t{}\n", std::max(0, i - 20) * 0.1,
                          0.01 * ((i * 7) % 5) + drift * i);
    }
    return text;
  };
  EXPECT_TRUE(read(table(0.0)).notes.empty());
  EXPECT_FALSE(read(table(0.02)).notes.empty());
}

}  // namespace
}  // namespace palpate
