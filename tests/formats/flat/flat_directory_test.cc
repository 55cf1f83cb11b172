#include "formats/flat/flat_directory.h"

#include <gtest/gtest.h>

#include "tests/support/said.h"

namespace palpate {
namespace {

using namespace std::string_literals;

FlatObject group_object() {
  return {};
}

FlatObject array_at(std::uint64_t offset, std::vector<std::uint64_t> extent) {
  return {.kind = FlatKind::kFloat64, .extent = std::move(extent), .offset = offset};
}

// What the reader says of a directory of these entries.
std::string refusal_of(std::uint32_t objects, const std::string& entries,
                       std::uint64_t directory = 192) {
  const FlatHeader header{
      .objects = objects, .bytes = directory + entries.size(), .directory = directory};
  return refusal([&] {
    (void)read_flat_directory(header, entries);
  });
}

// The bytes of FLAT.md, "Directory".
TEST(FlatDirectoryBytes, AnEntryIsThatOfThePage) {
  FlatObject object = array_at(128, {7, 3});
  object.attributes["units"] = {FlatKind::kText, "m"};
  EXPECT_EQ(flat_entry("/a", object),
            "\2\0\0\0/a"s          // path
            "\1\2\1\0"s            // float64, rank 2, one attribute
            "\x80\0\0\0\0\0\0\0"s  // offset
            "\7\0\0\0\0\0\0\0"s    // 7 rows
            "\3\0\0\0\0\0\0\0"s    // 3 columns
            "\5\0\0\0units\7"s     // a text
            "\1\0\0\0m"s);
}

TEST(FlatDirectoryBytes, TheHeaderIsThatOfThePage) {
  const FlatHeader header{.objects = 2,
                          .bytes = 0x1234,
                          .directory = 0x1000,
                          .sha256 = std::string(64, 'a')};
  const std::string bytes = flat_header(header);
  EXPECT_EQ(bytes,
            "\x89PAL\r\n\x1a\n"s
            "\1\0\0\0\2\0\0\0"s
            "\x34\x12\0\0\0\0\0\0\0\x10\0\0\0\0\0\0"s +
                std::string(64, 'a'));
  const FlatHeader read = read_flat_header(bytes);
  EXPECT_EQ(read.objects, 2U);
  EXPECT_EQ(read.bytes, 0x1234U);
  EXPECT_EQ(read.directory, 0x1000U);
  EXPECT_EQ(read.sha256, header.sha256);
}

TEST(FlatDirectoryBytes, ItIsReadAsItWasWritten) {
  FlatObject text{.kind = FlatKind::kText, .extent = {5}, .offset = 192};
  text.attributes["rate"] = {FlatKind::kFloat64, std::string(8, '\0')};
  const std::string entries = flat_entry("/", group_object()) +
                              flat_entry("/a", array_at(128, {2, 1, 3})) +
                              flat_entry("/t", text);
  const FlatHeader header{
      .objects = 3, .bytes = 256 + entries.size(), .directory = 256};
  const FlatDirectory read = read_flat_directory(header, entries);
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read.at("/").kind, FlatKind::kGroup);
  EXPECT_EQ(read.at("/a").extent, (std::vector<std::uint64_t>{2, 1, 3}));
  EXPECT_EQ(read.at("/a").offset, 128U);
  EXPECT_EQ(read.at("/t").kind, FlatKind::kText);
  EXPECT_EQ(read.at("/t").attributes.at("rate").value.size(), 8U);
}

TEST(FlatDirectoryBytes, EveryLieIsNamed) {
  const std::string root = flat_entry("/", group_object());
  EXPECT_EQ(refusal_of(1, root + flat_entry("/a", array_at(128, {8})), 192),
            "the directory of 1 objects does not end the file");
  EXPECT_EQ(refusal_of(2, root, 128), "the directory ends within an entry");
  EXPECT_EQ(refusal_of(1, root.substr(0, root.size() - 1), 128),
            "the directory ends within an entry");
  EXPECT_EQ(refusal_of(2, root + root, 128), "the directory names \"/\" twice");
  // Data that overlap, leave room, or reach into the directory.
  for (const std::uint64_t offset : {0U, 64U, 127U, 129U, 192U}) {
    EXPECT_NE(refusal_of(2, root + flat_entry("/a", array_at(offset, {1})))
                  .find("must follow at 128 and end before the directory at 192"),
              std::string::npos)
        << offset;
  }
  EXPECT_EQ(refusal_of(2, root + flat_entry("/a", array_at(128, {8}))), "");
  EXPECT_NE(refusal_of(2, root + flat_entry("/a", array_at(128, {9}))), "");
  EXPECT_NE(refusal_of(3, root + flat_entry("/a", array_at(128, {8})) +
                              flat_entry("/b", array_at(128, {8}))),
            "");
}

// Products that overflow, also beside a zero.
TEST(FlatDirectoryBytes, ExtentsThatOverflowAreRefused) {
  const std::string root = flat_entry("/", group_object());
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 62;
  for (const std::vector<std::uint64_t>& extent :
       std::vector<std::vector<std::uint64_t>>{{kHuge},
                                               {kHuge, kHuge},
                                               {0, kHuge},
                                               {kHuge, 0},
                                               {UINT64_MAX},
                                               {1U << 31U, 1U << 31U, 4}}) {
    EXPECT_FALSE(array_at(128, extent).bytes()) << extent.front();
    EXPECT_NE(refusal_of(2, root + flat_entry("/a", array_at(128, extent))), "");
  }
  EXPECT_EQ(array_at(128, {0, 3}).bytes(), 0U);
  EXPECT_EQ(array_at(128, {5, 3}).bytes(), 120U);
}

TEST(FlatDirectoryBytes, ShapesAreThoseOfTheirTypes) {
  const std::string root = flat_entry("/", group_object());
  const auto with = [&](FlatObject object) {
    return refusal_of(2, root + flat_entry("/a", object));
  };
  EXPECT_NE(with(array_at(128, {})).find("0 extents"), std::string::npos);
  EXPECT_NE(with(array_at(128, {1, 1, 1, 1})).find("4 extents"), std::string::npos);
  EXPECT_NE(with({.kind = FlatKind::kText, .extent = {1, 1}, .offset = 128}), "");
  EXPECT_NE(with({.kind = FlatKind::kGroup, .extent = {1}}), "");
  EXPECT_NE(with({.kind = static_cast<FlatKind>(8), .extent = {1}, .offset = 128})
                .find("has the type 8, must be 0 to 7"),
            std::string::npos);
}

TEST(FlatDirectoryBytes, TheDigestCoversHeaderAndDirectory) {
  FlatHeader header{.objects = 1, .bytes = 200, .directory = 128};
  const std::string sha256 = flat_sha256(header, "directory");
  EXPECT_NE(flat_sha256(header, "Directory"), sha256);
  header.objects = 2;
  EXPECT_NE(flat_sha256(header, "directory"), sha256);
}

}  // namespace
}  // namespace palpate
