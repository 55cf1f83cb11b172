// Workbooks of our own: shared and inline texts, prefixes, gaps, several sheets.
#include "formats/measurement/workbook_file.h"

#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/test_data.h"
#include "tests/support/zip_writer.h"

namespace palpate {
namespace {

using Entries = std::map<std::string, std::string>;

Entries book(const std::string& first, const std::string& second) {
  return {{"xl/workbook.xml",
           "<workbook xmlns:r=\"r\"><sheets><sheet name=\"Info\" sheetId=\"1\" "
           "r:id=\"rA\"/>"
           "<sheet name=\"Probe 1\" sheetId=\"2\" r:id=\"rB\"/></sheets></workbook>"},
          {"xl/_rels/workbook.xml.rels",
           "<Relationships><Relationship Id=\"rB\" Target=\"worksheets/sheet2.xml\"/>"
           "<Relationship Id=\"rA\" "
           "Target=\"/xl/worksheets/sheet1.xml\"/></Relationships>"},
          {"xl/sharedStrings.xml",
           "<sst><si><t>Standardkraft</t></si><si><r><t>Verfor</t></r><r><t>mung</t></"
           "r></si>"
           "<si><t>N</t></si><si><t>mm</t></si></sst>"},
          {"xl/worksheets/sheet1.xml", first},
          {"xl/worksheets/sheet2.xml", second}};
}

const std::string kInfo =
    "<worksheet><sheetData><row r=\"1\"><c r=\"A1\" t=\"inlineStr\"><is><t>Operator</t>"
    "</is></c><c r=\"B1\"><v>7</v></c></row></sheetData></worksheet>";

// A title, names in B and C, units, two rows; a column D that ends early.
const std::string kData =
    "<x:worksheet><x:sheetData>"
    "<x:row r=\"2\"><x:c r=\"A2\" t=\"str\"><x:v>Probe</x:v></x:c></x:row>"
    "<x:row r=\"4\"><x:c r=\"B4\" t=\"s\"><x:v>0</x:v></x:c>"
    "<x:c r=\"C4\" t=\"s\"><x:v>1</x:v></x:c></x:row>"
    "<x:row r=\"5\"><x:c r=\"B5\" t=\"s\"><x:v>2</x:v></x:c>"
    "<x:c r=\"C5\" t=\"s\"><x:v>3</x:v></x:c></x:row>"
    "<x:row r=\"6\"><x:c r=\"B6\"><x:v>1.5E-1</x:v></x:c><x:c "
    "r=\"C6\"><x:v>1</x:v></x:c>"
    "<x:c r=\"D6\"><x:v>99</x:v></x:c></x:row>"
    "<x:row r=\"7\"><x:c r=\"B7\"><x:v>0.25</x:v></x:c><x:c r=\"C7\"><x:v>2</x:v></x:c>"
    "</x:row></x:sheetData></x:worksheet>";

class Workbook : public testing::Test {
 protected:
  std::filesystem::path write(const Entries& entries) const {
    const std::filesystem::path file = folder_ / "book.dat";
    write_zip(file, entries);
    return file;
  }

  static std::string complaint(const std::filesystem::path& file) {
    try {
      const InstrumentLayout& layout = layout_of(file);
      (void)layout.read(file, layout.list(file).curve.at(0), {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  ScratchFolder folder_;
};

TEST_F(Workbook, TablesOfAllSheetsArePresses) {
  const auto file = write(book(kInfo, kData));
  const InstrumentLayout& layout = layout_of(file);
  EXPECT_EQ(layout.name, "workbook");
  const InstrumentFile list = layout.list(file);
  ASSERT_EQ(list.curve.size(), 1U);
  EXPECT_EQ(list.curve[0].kind, "Probe 1");
  EXPECT_EQ(list.curve[0].line, 4U);
  EXPECT_NE(list.left_out.find("\"Info\""), std::string::npos);
  const MeasurementFile read = layout.read(file, list.curve[0], {});
  EXPECT_EQ(read.samples.force_n, (std::vector<double>{0.15, 0.25}));
  EXPECT_EQ(read.samples.depth_m, (std::vector<double>{1e-3, 2e-3}));
  EXPECT_EQ(read.force_column, "Standardkraft");
}

TEST_F(Workbook, ASheetWithoutUnitsIsReadAsToldOrAskedFor) {
  std::string bare = kData;
  const std::size_t units = bare.find("<x:row r=\"5\">");
  bare.erase(units, bare.find("<x:row r=\"6\">") - units);
  const auto file = write(book(bare, bare));
  const InstrumentLayout& layout = layout_of(file);
  const auto curves = layout.list(file).curve;
  ASSERT_EQ(curves.size(), 2U);
  const MeasurementFile read = layout.read(
      file, curves[1], {{{"Verformung", "mm"}, {"Standardkraft", "kN"}, std::nullopt}});
  EXPECT_EQ(read.samples.force_n, (std::vector<double>{150.0, 250.0}));
  EXPECT_NE(complaint(file).find("no column of the header states a unit of length"),
            std::string::npos);
}

TEST_F(Workbook, TwoSheetsAreTwoPresses) {
  const auto file = write(book(kData, kData));
  EXPECT_EQ(layout_of(file).list(file).curve.size(), 2U);
}

TEST_F(Workbook, NamesSheetAndRowOfABadCell) {
  std::string bad = kData;
  const std::string cell = "<x:c r=\"C7\"><x:v>2</x:v></x:c>";
  bad.replace(bad.find(cell), cell.size(), "");
  const std::string said = complaint(write(book(kInfo, bad)));
  EXPECT_NE(said.find("sheet Probe 1: line 7, column 3 \"Verformung\""),
            std::string::npos)
      << said;
}

TEST_F(Workbook, SaysWhyABookCannotBeRead) {
  EXPECT_NE(complaint(write(book(kInfo, kInfo))).find("no line of names"),
            std::string::npos);
  EXPECT_NE(complaint(write(book(kInfo, "<worksheet><broken"))).find("is not XML"),
            std::string::npos);
  Entries entries = book(kInfo, kData);
  entries.erase("xl/worksheets/sheet2.xml");
  EXPECT_NE(complaint(write(entries)).find("is not in the archive"), std::string::npos);
}

}  // namespace
}  // namespace palpate
