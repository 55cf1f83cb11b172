#include "formats/measurement/decimal_mark.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

// What is said of a table with these cells, one a line.
std::string of_cells(const std::vector<std::string>& cells) {
  const std::string file = "a.csv";
  DecimalMark mark(file);
  return refusal([&] {
    std::size_t line = 0;
    for (const std::string& cell : cells) {
      mark.see(cell, ++line);
    }
    mark.check();
  });
}

TEST(DecimalMark, OneMarkThroughoutIsADecimalMark) {
  EXPECT_EQ(of_cells({"1,5", "0,25", "12,75", "7"}), "");
  EXPECT_EQ(of_cells({"1.5", "0.25", "1.234", "123"}), "");
  EXPECT_EQ(of_cells({"1,234", "0,5", "123"}), "");
  EXPECT_EQ(of_cells({"1,234", "2,345"}), "");
  EXPECT_EQ(of_cells({"1", "22", "4444", "555"}), "");
  EXPECT_EQ(of_cells({}), "");
}

TEST(DecimalMark, AGroupBesideTheOtherMarkSeparatesThousands) {
  const std::string tail =
      ": one of them separates thousands, which are not read; export without thousands "
      "separators";
  EXPECT_EQ(of_cells({"0.5", "7", "1,234"}),
            "a.csv: a comma in line 3 and a point in line 1" + tail);
  EXPECT_EQ(of_cells({"1,5", "1.234"}),
            "a.csv: a comma in line 1 and a point in line 2" + tail);
  EXPECT_EQ(of_cells({"1,234.5"}),
            "");  // the cell's own marks are no group of three at its end
  EXPECT_NE(of_cells({"1.5", "1,234,567"}), "");
}

TEST(DecimalMark, MarksThatCannotBeThousandsMayStandBesideEachOther) {
  EXPECT_EQ(of_cells({"1,5", "2.25"}), "");
  EXPECT_EQ(of_cells({"1,2345", "2.25"}), "");
}

TEST(DecimalMark, CommasThatMayAllBeThousandsAreRefusedBesideNumbersWithout) {
  const std::string text = of_cells({"1,234", "999", "2,345"});
  EXPECT_EQ(text,
            "a.csv: the comma in line 1 separates thousands or decimals: line 2 has a "
            "number of three digits without; export without thousands separators");
  EXPECT_NE(of_cells({"-999", "1,234"}), "");
  // Two or four digits have no place for a separator, or have had none.
  EXPECT_EQ(of_cells({"1,234", "99", "2,345"}), "");
  EXPECT_EQ(of_cells({"1,234", "9999", "2,345"}), "");
}

TEST(DecimalMark, IsAFaultOfTheFile) {
  const std::string file = "a.csv";
  DecimalMark mark(file);
  mark.see("1.5", 1);
  EXPECT_THROW(mark.see("1,234", 2), FormatError);
}

}  // namespace
}  // namespace palpate
