#include "formats/measurement/delimited_text.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

using Split = std::vector<std::string>;

// "number:text" of each line that carries something.
Split numbered(std::string_view text) {
  Split lines;
  for (const TextLine& line : text_lines(text, "a.csv")) {
    lines.push_back(std::to_string(line.number) + ":" + line.text);
  }
  return lines;
}

TEST(DelimitedText, LinesAreCountedAsEditorsDo) {
  EXPECT_EQ(numbered("a,b\n\n  \t\n1,2\n3,4"), (Split{"1:a,b", "4:1,2", "5:3,4"}));
  EXPECT_EQ(numbered("a\r\n1\r\n"), (Split{"1:a", "2:1"}));
  EXPECT_EQ(numbered("a\r1\r"), (Split{"1:a", "2:1"}));
  EXPECT_EQ(numbered("\xEF\xBB\xBFx\n1"), (Split{"1:x", "2:1"}));
  EXPECT_EQ(numbered(""), Split{});
  EXPECT_EQ(text_lines("x\n", "a.csv", 7).at(0).number, 7U);
}

TEST(DelimitedText, OfCommentsAboveARowOfNumbersTheLastMayNameColumns) {
  EXPECT_EQ(numbered("# first\n# x, y\n1,2\n# later\n3,4"),
            (Split{"2:x, y", "3:1,2", "5:3,4"}));
  EXPECT_EQ(numbered("% x y\n-.5 2\n"), (Split{"1:x y", "2:-.5 2"}));
  // Names of their own need none.
  EXPECT_EQ(numbered("# note\nx,y\n1,2"), (Split{"2:x,y", "3:1,2"}));
  // Below the first line a percent sign is somebody's unit.
  EXPECT_EQ(numbered("strain\n%\n1"), (Split{"1:strain", "2:%", "3:1"}));
}

TEST(DelimitedText, OtherTextIsRefusedOrTurned) {
  EXPECT_THROW((void)numbered("\xFF\xFE"
                              "a"),
               FormatError);
  expect_says(refusal([] {
                (void)numbered(
                    "\xFE\xFF"
                    "a");
              }),
              "is text in UTF-16");
  expect_says(refusal([] {
                (void)numbered(std::string_view("a\nb\0c\n", 6));
              }),
              "a.csv: line 2 holds a zero byte");
  EXPECT_EQ(numbered("Kraft (\xB5N)\nf\xFCr"),
            (Split{"1:Kraft (\xC2\xB5N)", "2:f\xC3\xBCr"}));
  EXPECT_EQ(numbered("\xC2\xB5m"), (Split{"1:\xC2\xB5m"}));
}

TEST(DelimitedText, CellsAreBetweenDelimitersWithoutBlanks) {
  EXPECT_EQ(split_cells(" a , b\t,,c ", ','), (Split{"a", "b", "", "c"}));
  EXPECT_EQ(split_cells("1,5;2,5", ';'), (Split{"1,5", "2,5"}));
  EXPECT_EQ(split_cells("1\t\t3", '\t'), (Split{"1", "", "3"}));
  EXPECT_EQ(split_cells("", ','), (Split{""}));
}

TEST(DelimitedText, QuotesHoldDelimitersAndQuotes) {
  EXPECT_EQ(split_cells(R"("Load, N","a ""b""",3)", ','),
            (Split{"Load, N", "a \"b\"", "3"}));
}

TEST(DelimitedText, ThousandsInQuotesAreTakenOutWhereThePointTellsThem) {
  EXPECT_EQ(split_cells(R"("1,000.06","-12,345,678.5","+1,234.")", ','),
            (Split{"1000.06", "-12345678.5", "+1234."}));
  // None of these is thousands for sure.
  for (const char* cell : {"1,000", "1,00.5", "1,000.5,0", "1.000,5", ",123.5",
                           "12345,678.5", "1,000.5 N"}) {
    EXPECT_EQ(split_cells(std::string("\"") + cell + "\"", ','), (Split{cell}));
  }
  EXPECT_EQ(split_cells("1,000.06;2", ';'), (Split{"1,000.06", "2"}));
}

TEST(DelimitedText, BlanksOfAnyNumberDelimitAndUnitsBelongToTheNameBefore) {
  EXPECT_EQ(split_cells("  1   2\t3 ", ' '), (Split{"1", "2", "3"}));
  EXPECT_EQ(split_cells("Depth (mm)  Load [N] t", ' '),
            (Split{"Depth (mm)", "Load [N]", "t"}));
  EXPECT_EQ(split_cells("(mm) [N]", ' '), (Split{"(mm) [N]"}));
}

TEST(DelimitedText, ANumberFillsItsCell) {
  for (const auto& [cell, value] :
       {std::pair{"1.5", 1.5}, std::pair{" -2e-3 ", -2e-3}, std::pair{"+7", 7.0},
        std::pair{".5", 0.5}, std::pair{"1E6", 1e6}, std::pair{"1.", 1.0}}) {
    EXPECT_EQ(parse_number(cell, false), value) << cell;
  }
  for (const char* cell :
       {"", "+", "-", "+-1", "++1", "1.5N", "1 2", "0x10", "1,5", "1.2.3", "e5"}) {
    EXPECT_EQ(parse_number(cell, false), std::nullopt) << cell;
  }
  EXPECT_TRUE(std::isnan(parse_number("nan", false).value()));
  EXPECT_EQ(parse_number("-inf", false), -HUGE_VAL);
}

TEST(DelimitedText, ACommaIsADecimalMarkWhereItMayBeAndOnce) {
  EXPECT_EQ(parse_number("-1,25", true), -1.25);
  EXPECT_EQ(parse_number("1.25", true), 1.25);
  EXPECT_EQ(parse_number("1,234,567", true), std::nullopt);
  EXPECT_EQ(parse_number("1,234.5", true), std::nullopt);
  EXPECT_EQ(parse_number("1.234,5", true), std::nullopt);
}

TEST(DelimitedText, GroupsHaveThreeDigitsAndOneToThreeBefore) {
  for (const char* cell : {"1,234", "12,345", "123,456", "-123,456", "1,234,567"}) {
    EXPECT_TRUE(ends_in_groups(cell, ',')) << cell;
  }
  for (const char* cell : {"", "1234", ",123", "1,23", "1,2345", "12345,678", "1,234.5",
                           "1,234,56", "1,23a", "1.234"}) {
    EXPECT_FALSE(ends_in_groups(cell, ',')) << cell;
  }
  EXPECT_TRUE(ends_in_groups("1.234", '.'));
}

}  // namespace
}  // namespace palpate
