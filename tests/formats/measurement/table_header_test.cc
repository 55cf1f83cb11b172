#include "formats/measurement/table_header.h"

#include <gtest/gtest.h>

#include "formats/measurement/column_name.h"

namespace palpate {
namespace {

using HeaderCells = std::vector<std::string>;

std::optional<TableHeader> header_of(const std::string& text) {
  return find_header(text_lines(text, "a.csv"));
}

TEST(TableHeader, UnitsStandInTheNames) {
  const auto header = header_of("a note\nTime (s),Load (mN),Run\n0,1,2\n1,3,4\n");
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->delimiter, ',');
  EXPECT_EQ(header->names, 1U);
  EXPECT_EQ(header->begin, 2U);
  EXPECT_EQ(header->name, (HeaderCells{"Time (s)", "Load (mN)", "Run"}));
  EXPECT_EQ(header->unit, (HeaderCells{"s", "mN", ""}));
}

TEST(TableHeader, UnitsStandInALineOfTheirOwn) {
  const auto header = header_of("Travel;Load;Run\n(mm);[N];\n0;1;2\n");
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->names, 0U);
  EXPECT_EQ(header->begin, 2U);
  EXPECT_EQ(header->name, (HeaderCells{"Travel", "Load", "Run"}));
  EXPECT_EQ(header->unit, (HeaderCells{"mm", "N", ""}));
  // A name's own unit is nearer than the line below.
  EXPECT_EQ(header_of("Travel (um);Load\nmm;N\n0;1\n")->unit, (HeaderCells{"um", "N"}));
}

TEST(TableHeader, GramsOfALoadAreAForce) {
  EXPECT_EQ(header_of("Travel;Load\nmm;g\n0;1\n")->unit, (HeaderCells{"mm", "gf"}));
}

TEST(TableHeader, UnitsAloneAreNames) {
  const auto header = header_of("mm\tN\n0\t1\n");
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->names, 0U);
  EXPECT_EQ(header->unit, (HeaderCells{"mm", "N"}));
}

TEST(TableHeader, NumbersBesideUnitsBelongToTheHeader) {
  // Somebody's sums at the right of names and units.
  const auto header = header_of("Travel,Load,5,7\nmm,N,3,4\n0,1,,\n2,3,,\n");
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->begin, 2U);
  EXPECT_EQ(header->name, (HeaderCells{"Travel", "Load", "5", "7"}));
  EXPECT_EQ(header->unit[1], "N");
}

TEST(TableHeader, ARowHasTwoNumbersOrMore) {
  const std::vector<TextLine> lines = text_lines("1,a\n1,2\n1;2\n", "a.csv");
  EXPECT_FALSE(is_number_row(lines, 0, ','));
  EXPECT_TRUE(is_number_row(lines, 1, ','));
  EXPECT_FALSE(is_number_row(lines, 2, ','));  // one number with a decimal comma
  EXPECT_TRUE(is_number_row(lines, 2, ';'));
}

TEST(TableHeader, WithoutALineOfAsManyCellsThereAreNoNames) {
  const std::vector<TextLine> lines = text_lines("Load,Travel\n1,2,3\n", "a.csv");
  const auto header = find_header(lines, ',');
  ASSERT_TRUE(header.has_value());
  EXPECT_TRUE(header->name.empty() && header->unit.empty());
  EXPECT_EQ(header->names, 1U);
  EXPECT_EQ(header->begin, 1U);
  EXPECT_FALSE(header_of("1,2\n3,4\n").has_value());
  EXPECT_FALSE(find_header(text_lines("a,b\nc,d\n", "a.csv"), ',').has_value());
}

TEST(TableHeader, BeginsWhereItIsToldTo) {
  const std::vector<TextLine> lines =
      text_lines("Load (N),Travel (mm)\n1,2\nForce (mN),Depth (um)\n3,4\n", "a.csv");
  EXPECT_EQ(find_header(lines, ',')->begin, 1U);
  const auto second = find_header(lines, ',', 2);
  EXPECT_EQ(second->begin, 3U);
  EXPECT_EQ(second->names, 2U);
  EXPECT_EQ(second->unit, (HeaderCells{"mN", "um"}));
  // Lines before that are none of its.
  const auto bare = find_header(lines, ',', 3);
  EXPECT_EQ(bare->begin, 3U);
  EXPECT_TRUE(bare->name.empty());
}

TEST(TableHeader, ColumnsAreFoundByTheirUnitsAndSpreadsLeftOut) {
  const auto header =
      header_of("Travel (mm),Load (N),Load SD (N),Time (s),Depth (um)\n1,2,3,4,5\n");
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(columns_with_unit(*header, kDepth), (std::vector<std::size_t>{0, 4}));
  EXPECT_EQ(columns_with_unit(*header, kForce), (std::vector<std::size_t>{1}));
  EXPECT_EQ(columns_with_unit(*header, kTime), (std::vector<std::size_t>{3}));
  // Where all are spreads, they are what there is.
  const auto spreads = header_of("x (mm),F_std (N)\n1,2\n");
  EXPECT_EQ(columns_with_unit(*spreads, kForce), (std::vector<std::size_t>{1}));
  // "Standard" is no "std".
  const auto standard = header_of("Load standard (N),Load err (N)\n1,2\n");
  EXPECT_EQ(columns_with_unit(*standard, kForce), (std::vector<std::size_t>{0}));
}

TEST(TableHeader, AColumnIsAskedForByNameOrByNumberWhereOthersHaveThat) {
  const auto header = header_of("Load,Load,Travel,7,\n1,2,3,4,5\n");
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(chosen_by(*header, 0), "1");
  EXPECT_EQ(chosen_by(*header, 1), "2");
  EXPECT_EQ(chosen_by(*header, 2), "Travel");
  EXPECT_EQ(chosen_by(*header, 3), "4");
  EXPECT_EQ(chosen_by(*header, 4), "5");
}

TEST(TableHeader, AUnitsBracketsAreTakenOff) {
  EXPECT_EQ(stated_unit("mm"), "mm");
  EXPECT_EQ(stated_unit("(mm)"), "mm");
  EXPECT_EQ(stated_unit("[mm]"), "mm");
  EXPECT_EQ(stated_unit("Travel (mm)"), "mm");
}

}  // namespace
}  // namespace palpate
