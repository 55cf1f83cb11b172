// JPK archives of our own: integers, calibration slots, maps, and what may be wrong.
#include "formats/measurement/jpk_file.h"

#include <cstdint>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/measurement/jpk_header.h"
#include "tests/support/test_data.h"
#include "tests/support/zip_writer.h"

namespace palpate {
namespace {

using Entries = std::map<std::string, std::string>;

std::string big_endian(const std::vector<int>& numbers, int bytes) {
  std::string text;
  for (const int number : numbers) {
    for (int byte = bytes - 1; byte >= 0; --byte) {
      text +=
          static_cast<char>((static_cast<std::int64_t>(number) >> (8 * byte)) & 0xFF);
    }
  }
  return text;
}

std::string slot(const std::string& name, const std::string& base, double multiplier,
                 double offset, const std::string& unit) {
  const std::string key = "conversion-set.conversion." + name + ".";
  return fmt::format(
      "{0}defined=true\n{0}base-calibration-slot={1}\n{0}scaling.multiplier={2}\n"
      "{0}scaling.offset={3}\n{0}scaling.unit.unit={4}\n",
      key, base, multiplier, offset, unit);
}

std::string encoder(const std::string& type, double multiplier, double offset) {
  return fmt::format(
      "encoder.type={}\nencoder.scaling.multiplier={}\nencoder.scaling.offset={}\n"
      "encoder.scaling.unit.unit=V\n",
      type, multiplier, offset);
}

// height [m] = 1e-4 - 1e-6 V, V = 2 raw; deflection: V = 0.5 raw + 1, distance 1e-7 V,
// force 0.25 N/m.
const std::string kHeight = encoder("signedshort", 2.0, 0.0) +
                            "conversion-set.conversions.base=volts\n"
                            "conversion-set.conversions.default=nominal\n" +
                            slot("nominal", "volts", -1e-6, 1e-4, "m");
const std::string kDeflection = encoder("signedinteger", 0.5, 1.0) +
                                "conversion-set.conversions.base=volts\n"
                                "conversion-set.conversions.default=force\n" +
                                slot("distance", "volts", 1e-7, 0.0, "m") +
                                slot("force", "distance", 0.25, 0.0, "N");

std::string below(const std::string& prefix, const std::string& lines) {
  std::string text;
  for (std::size_t at = 0; at < lines.size();) {
    const std::size_t end = lines.find('\n', at) + 1;
    text += prefix + lines.substr(at, end - at);
    at = end;
  }
  return text;
}

std::string data_keys(const std::string& channel, std::size_t count) {
  return fmt::format(
      "channel.{0}.data.file.name=channels/{0}.dat\nchannel.{0}.data.num-points={1}\n",
      channel, count);
}

// A segment with its own scalings, or with those of the shared header.
void add_segment(Entries& entries, const std::string& folder, const std::string& style,
                 const std::vector<int>& height, const std::vector<int>& deflection,
                 bool shared) {
  std::string header = "#Thu Mar 31\nforce-segment-header.settings.style=" + style +
                       "\nforce-segment-header.duration=2.0\n" +
                       data_keys("height", height.size()) +
                       data_keys("vDeflection", deflection.size());
  header += shared ? "channel.height.lcd-info.*=0\nchannel.vDeflection.lcd-info.*=1\n"
                   : below("channel.height.", kHeight) +
                         below("channel.vDeflection.", kDeflection);
  entries[folder + "segment-header.properties"] = header;
  entries[folder + "channels/height.dat"] = big_endian(height, 2);
  entries[folder + "channels/vDeflection.dat"] = big_endian(deflection, 4);
}

Entries single() {
  Entries entries;
  entries["header.properties"] =
      "force-scan-series.header.position.x=1.0E-5\n"
      "force-scan-series.header.position.y=-2.0E-5\n";
  add_segment(entries, "segments/0/", "extend", {10, 20, 30, 40}, {-2, -2, -2, 98},
              false);
  add_segment(entries, "segments/1/", "retract", {30, 10}, {-2, -4}, false);
  return entries;
}

Entries map() {
  Entries entries;
  entries["shared-data/header.properties"] = below("lcd-info.0.", kHeight) +
                                             below("lcd-info.1.", kDeflection) +
                                             "lcd-info.10.encoder.type=nonsense\n";
  for (const int index : {3, 12}) {
    const std::string folder = fmt::format("index/{}/", index);
    entries[folder + "header.properties"] = fmt::format(
        "force-scan-series.header.position.x={}e-6\n"
        "force-scan-series.header.position.y=0\n",
        index);
    add_segment(entries, folder + "segments/0/", "extend", {10, 20, 30, 40},
                {-2, -2, -2, 10 * index}, true);
  }
  return entries;
}

class JpkFile : public testing::Test {
 protected:
  std::filesystem::path write(const Entries& entries,
                              const std::string& name = "any.dat") const {
    const std::filesystem::path file = folder_ / name;
    write_zip(file, entries);
    return file;
  }

  static MeasurementFile read(const std::filesystem::path& file,
                              std::size_t which = 0) {
    const InstrumentLayout& layout = layout_of(file);
    EXPECT_EQ(layout.name, "JPK force archive");
    return layout.read(file, layout.list(file).curve.at(which), {});
  }

  void expect_complaint(const Entries& entries, const std::string& part) const {
    try {
      (void)read(write(entries));
      FAIL() << "no complaint: " << part;
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << error.what();
    }
  }

  ScratchFolder folder_;
};

TEST_F(JpkFile, NumbersBecomeForceAndTipDepthBySlots) {
  const Measurement m = read(write(single())).samples;
  ASSERT_EQ(m.depth_m.size(), 6U);
  // Raw 40: height 1e-4 - 8e-5 = 2e-5 m; raw 98: 50 V, 5e-6 m, 1.25e-6 N.
  EXPECT_NEAR(m.depth_m[3], -(2e-5 + 5e-6), 1e-15);
  EXPECT_NEAR(m.force_n[3], 1.25e-6, 1e-15);
  EXPECT_NEAR(m.depth_m[0], -8e-5, 1e-15);
  EXPECT_NEAR(m.force_n[0], 0.0, 1e-15);
  EXPECT_NEAR(m.force_n[5], -2.5e-8, 1e-15);  // adhesion: the retraction goes on
  EXPECT_NEAR(m.time_s[1], 0.5, 1e-12);
  EXPECT_NEAR(m.time_s[4], 2.0, 1e-12);
  const auto file = write(single());
  const InstrumentCurve curve = layout_of(file).list(file).curve.at(0);
  EXPECT_TRUE(curve.position_m->isApprox(Eigen::Vector3d(1e-5, -2e-5, 0.0)));
}

TEST_F(JpkFile, ADeflectionThatFallsUnderThePressIsTurned) {
  Entries entries = single();
  add_segment(entries, "segments/0/", "extend", {10, 20, 30, 40}, {-2, -2, -2, -102},
              false);
  const MeasurementFile turned = read(write(entries));
  EXPECT_NEAR(turned.samples.depth_m[3], -(2e-5 + 5e-6), 1e-15);
  EXPECT_NEAR(turned.samples.force_n[3], 1.25e-6, 1e-15);
  EXPECT_NE(turned.notes.at(0).find("sign is turned"), std::string::npos);
}

TEST_F(JpkFile, AMapsCurvesHaveItsNumbersPositionsAndSharedScalings) {
  const auto file = write(map());
  const auto curves = layout_of(file).list(file).curve;
  ASSERT_EQ(curves.size(), 2U);
  EXPECT_EQ(curves[0].number, 3);
  EXPECT_EQ(curves[1].number, 12);
  EXPECT_TRUE(curves[1].position_m->isApprox(Eigen::Vector3d(12e-6, 0.0, 0.0)));
  EXPECT_NEAR(read(file, 0).samples.force_n[3], 0.25e-7 * 16.0, 1e-15);
  EXPECT_NEAR(read(file, 1).samples.force_n[3], 0.25e-7 * 61.0, 1e-15);
}

TEST_F(JpkFile, EveryIntegerAndRealIsRead) {
  const auto numbers = [](const std::string& type, const std::string& bytes) {
    const JpkHeader header{{"channel.c.data.encoder.type", type}};
    return jpk_numbers(header, "f", "c", bytes).at(0);
  };
  EXPECT_EQ(numbers("signedshort", big_endian({-2}, 2)), -2.0);
  EXPECT_EQ(numbers("unsignedshort", big_endian({65534}, 2)), 65534.0);
  EXPECT_EQ(numbers("signedinteger", big_endian({-70000}, 4)), -70000.0);
  EXPECT_EQ(numbers("unsignedinteger", big_endian({-1}, 4)), 4294967295.0);
  EXPECT_EQ(numbers("signedlong", big_endian({-3}, 8)), -3.0);
  const JpkHeader real{{"channel.c.data.type", "float-data"}};
  EXPECT_EQ(jpk_numbers(real, "f", "c", std::string("\xC0\x20\0\0", 4)).at(0), -2.5);
}

TEST_F(JpkFile, PropertiesAreJavas) {
  const JpkHeader header = parse_jpk_header(
      "# note\n! note\n a.b = 12\\:30\nc:15 \\u00B5m\r\nlong=one \\\n  two\nempty=\n");
  EXPECT_EQ(header.at("a.b"), "12:30");
  EXPECT_EQ(header.at("c"), "15 \xC2\xB5m");
  EXPECT_EQ(header.at("long"), "one two");
  EXPECT_EQ(header.at("empty"), "");
  EXPECT_EQ(header.size(), 4U);
}

TEST_F(JpkFile, SaysWhatIsMissing) {
  Entries uncalibrated = single();
  std::string& header = uncalibrated["segments/0/segment-header.properties"];
  header.replace(header.find("conversion.force.defined=true"), 29,
                 "conversion.force.defined=false");
  expect_complaint(uncalibrated, "channel vDeflection has no slot \"force\"");

  Entries cut = single();
  cut["segments/0/channels/vDeflection.dat"].resize(12);
  expect_complaint(cut, "holds 3 samples, its header says 4");
  cut["segments/0/channels/vDeflection.dat"].resize(11);
  expect_complaint(cut, "no whole number of 4");
  cut.erase("segments/0/channels/vDeflection.dat");
  expect_complaint(cut, "is not in the archive");

  Entries circle = single();
  std::string& slots = circle["segments/0/segment-header.properties"];
  const std::string base = "conversion.distance.base-calibration-slot=volts";
  slots.replace(slots.find(base), base.size(),
                "conversion.distance.base-calibration-slot=force");
  expect_complaint(circle, "has no slot");
}

TEST_F(JpkFile, ABrokenArchiveIsNamed) {
  const auto whole = write(single(), "cut.jpk-force");
  std::filesystem::resize_file(whole, std::filesystem::file_size(whole) / 2);
  try {
    (void)read(whole);
    FAIL() << "read half an archive";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("cut short or damaged"),
              std::string::npos);
  }
  EXPECT_THROW((void)layout_of(write({{"readme.txt", "files"}})), FormatError);
}

}  // namespace
}  // namespace palpate
