#include "formats/mesh/ply_header.h"

#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

// A header of these lines between the first one and the end.
std::string ply_with(const std::string& lines,
                     const std::string& format = "format ascii 1.0") {
  return "ply\n" + format + "\n" + lines + "end_header\n" + std::string(200, '7');
}

std::string header_refusal(const std::string& bytes) {
  return refusal([&] {
    (void)read_ply_header(bytes);
  });
}

std::string lines_refusal(const std::string& lines) {
  return header_refusal(ply_with(lines));
}

TEST(PlyHeader, AnnouncesElementsAndPropertiesInTheirOrder) {
  const std::string bytes = ply_with(
      "comment property float not_me\nobj_info x\n\nelement vertex 8\n"
      "property double x\n  property\tuchar red \nelement face 5\n"
      "property list uchar int vertex_indices\nproperty float quality\n",
      "format binary_big_endian 1.0");
  const PlyHeader header = read_ply_header(bytes);
  EXPECT_EQ(header.encoding, PlyEncoding::kBigEndian);
  ASSERT_EQ(header.element.size(), 2U);
  const PlyElement& vertex = header.element[0];
  EXPECT_EQ(vertex.name, "vertex");
  EXPECT_EQ(vertex.count, 8U);
  ASSERT_EQ(vertex.property.size(), 2U);
  EXPECT_EQ(vertex.property[0].name, "x");
  EXPECT_EQ(vertex.property[0].type, PlyType::kFloat64);
  EXPECT_FALSE(vertex.property[0].is_list);
  EXPECT_EQ(vertex.property[1].name, "red");
  EXPECT_EQ(vertex.property[1].type, PlyType::kUint8);
  const PlyElement& face = header.element[1];
  ASSERT_EQ(face.property.size(), 2U);
  EXPECT_TRUE(face.property[0].is_list);
  EXPECT_EQ(face.property[0].count_type, PlyType::kUint8);
  EXPECT_EQ(face.property[0].type, PlyType::kInt32);
  EXPECT_EQ(face.property[0].name, "vertex_indices");
  EXPECT_EQ(face.property[1].name, "quality");
  EXPECT_EQ(bytes.substr(header.bytes), std::string(200, '7'));
}

TEST(PlyHeader, EveryTypeHasTwoNamesAndItsSize) {
  struct Known {
    const char* names[2];
    PlyType type;
    std::size_t bytes;
    bool integer;
  };
  for (const Known& known :
       {Known{{"char", "int8"}, PlyType::kInt8, 1, true},
        Known{{"uchar", "uint8"}, PlyType::kUint8, 1, true},
        Known{{"short", "int16"}, PlyType::kInt16, 2, true},
        Known{{"ushort", "uint16"}, PlyType::kUint16, 2, true},
        Known{{"int", "int32"}, PlyType::kInt32, 4, true},
        Known{{"uint", "uint32"}, PlyType::kUint32, 4, true},
        Known{{"float", "float32"}, PlyType::kFloat32, 4, false},
        Known{{"double", "float64"}, PlyType::kFloat64, 8, false}}) {
    EXPECT_EQ(bytes_of(known.type), known.bytes) << known.names[0];
    EXPECT_EQ(is_integer(known.type), known.integer) << known.names[0];
    for (const char* name : known.names) {
      const PlyHeader header = read_ply_header(
          ply_with(std::string("element e 1\nproperty ") + name + " p\n"));
      EXPECT_EQ(header.element.at(0).property.at(0).type, known.type) << name;
    }
  }
}

TEST(PlyHeader, TheDataBeginBehindTheLineBreakWhateverItIs) {
  for (const char* format : {"format ascii 1.0", "format binary_little_endian 1.0"}) {
    const std::string head =
        std::string("ply\r\n") + format + "\r\nelement e 1\r\nproperty int p\r\n";
    const std::string bytes = head + "end_header\r\n1 2";
    EXPECT_EQ(bytes.substr(read_ply_header(bytes).bytes), "1 2") << format;
  }
}

TEST(PlyHeader, TextMayGoOnInTheLastLineAndBinaryMayNot) {
  const std::string head = "element e 1\nproperty int p\nend_header";
  const std::string text = "ply\nformat ascii 1.0\n" + head + "1 2\n3 4\n";
  EXPECT_EQ(text.substr(read_ply_header(text).bytes), "1 2\n3 4\n");
  const std::string blank = "ply\nformat ascii 1.0\n" + head + " 5 6\n";
  EXPECT_EQ(blank.substr(read_ply_header(blank).bytes), " 5 6\n");
  EXPECT_EQ(header_refusal("ply\nformat binary_little_endian 1.0\n" + head + "1\n"),
            "PLY header, line 5: must be end_header alone");
}

TEST(PlyHeader, OtherFilesAndHalfAHeaderAreRefused) {
  EXPECT_THROW((void)read_ply_header("solid\n"), FormatError);
  EXPECT_EQ(header_refusal("plyx\nformat ascii 1.0\nend_header\n"),
            "not PLY: the first line must be \"ply\"");
  EXPECT_EQ(header_refusal("ply\nformat ascii 1.0\nelement v 3"),
            "cut short or not PLY: the header does not end (no end_header) in 3 lines");
  for (const char* format : {"format ascii", "format binary 1.0", "element v 1"}) {
    expect_says(header_refusal(ply_with("", format)),
                "PLY header, line 2: must be \"format\"");
  }
}

TEST(PlyHeader, WrongLinesAreNamedAsEditorsCountThem) {
  EXPECT_EQ(lines_refusal("property int p\n"),
            "PLY header, line 3: a property before any element");
  EXPECT_EQ(lines_refusal("comment a\n\nfacet 3\n"),
            "PLY header, line 5: \"facet\" is no word of a PLY header");
  EXPECT_EQ(lines_refusal("element v 1\n"),
            "PLY header, line 4: element \"v\" has no property");
  EXPECT_EQ(lines_refusal("element v 1\nelement w 1\n"),
            "PLY header, line 4: element \"v\" has no property");
  expect_says(lines_refusal("element v 1\nproperty real x\n"),
              "PLY header, line 4: unknown type \"real\"");
  EXPECT_EQ(lines_refusal("element v 1\nproperty list float int x\n"),
            "PLY header, line 4: a list's length must be an integer, is float");
  for (const char* property :
       {"property int", "property list int x", "property a b c d"}) {
    expect_says(lines_refusal(std::string("element v 1\n") + property + "\n"),
                "PLY header, line 4: must be \"property\", a type and a name");
  }
}

TEST(PlyHeader, CountsAreWholeAndWithinTheFile) {
  for (const char* count : {"", " -1", " 1.5", " 1x", " 1 1", " x"}) {
    EXPECT_EQ(lines_refusal(std::string("element v") + count + "\n"),
              "PLY header, line 3: must be \"element\", a name and a count")
        << count;
  }
  const std::string lines = "element v 1000000\nproperty int p\n";
  const std::string size = std::to_string(ply_with(lines).size());
  EXPECT_EQ(lines_refusal(lines),
            "PLY header, line 3: announces 1000000 elements, more than a file of " +
                size + " bytes can hold");
  expect_says(lines_refusal("element v 99999999999999999999999\n"),
              "announces 99999999999999999999999 elements");
  // As many as bytes may be.
  const std::string most = ply_with("element v 111\nproperty int p\n");
  std::string exact = most;
  exact.replace(exact.find("111"), 3, std::to_string(most.size()));
  EXPECT_EQ(read_ply_header(exact).element.at(0).count, most.size());
}

}  // namespace
}  // namespace palpate
