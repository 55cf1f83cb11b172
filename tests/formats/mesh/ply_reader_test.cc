// PLY files as programs write them, in all three encodings, and what is wrong with
// others.
#include "formats/mesh/ply_reader.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

const std::string kHeader =
    "comment by hand\nelement vertex 4\nproperty uchar red\nproperty double x\n"
    "property float y\nproperty short z\nelement edge 1\nproperty list ushort char "
    "vertices\nelement face 2\nproperty list uchar {} vertex_indices\n"
    "property float quality\nend_header\n";

std::string header(const std::string& format, const std::string& index_type) {
  return "ply\nformat " + format + " 1.0\n" +
         fmt::format(fmt::runtime(kHeader), index_type);
}

// The same body, a triangle and a quadrangle, as raw bytes.
class Raw {
 public:
  explicit Raw(bool big_endian) : big_endian_(big_endian) {}
  template <typename T>
  Raw& add(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof raw);
    if (big_endian_) {
      std::reverse(raw, raw + sizeof raw);
    }
    bytes_.append(raw, sizeof raw);
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

template <typename Index>
std::string raw_body(bool big_endian) {
  Raw raw(big_endian);
  for (int v = 0; v < 4; ++v) {
    raw.add(std::uint8_t{200}).add(0.1 * v).add(-1.5F * static_cast<float>(v));
    raw.add(static_cast<std::int16_t>(-300 * v));
  }
  raw.add(std::uint16_t{2}).add(std::int8_t{0}).add(std::int8_t{-1});
  raw.add(std::uint8_t{3}).add(Index{0}).add(Index{1}).add(Index{2}).add(0.5F);
  raw.add(std::uint8_t{4}).add(Index{3}).add(Index{2}).add(Index{1}).add(Index{0});
  return raw.add(0.5F).bytes();
}

void expect_body(const PolygonSoup& soup) {
  ASSERT_EQ(soup.point.size(), 4u);
  EXPECT_EQ(soup.point[3], Eigen::Vector3d(0.1 * 3, -4.5, -900.0));
  EXPECT_EQ(soup.face,
            (std::vector<std::vector<std::size_t>>{{0, 1, 2}, {3, 2, 1, 0}}));
}

std::string message(const std::string& bytes) {
  try {
    (void)read_ply(bytes);
  } catch (const FormatError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "read";
}

#define EXPECT_SAYS(what, text) \
  EXPECT_NE((what).find(text), std::string::npos) << (what)

TEST(PlyReader, ReadsEveryEncodingAndIndexType) {
  expect_body(
      read_ply(header("binary_little_endian", "int") + raw_body<std::int32_t>(false)));
  expect_body(
      read_ply(header("binary_big_endian", "uint") + raw_body<std::uint32_t>(true)));
  expect_body(
      read_ply(header("binary_big_endian", "short") + raw_body<std::int16_t>(true)));
  expect_body(read_ply(header("binary_little_endian", "uchar") +
                       raw_body<std::uint8_t>(false)));
  expect_body(read_ply(header("ascii", "int32") +
                       "1 0 0 0\n2 0.1 -1.5 -300\n3 0.2 -3 -600\n"
                       "+4 0.30000000000000004 -4.5e0 -900\n"
                       "2 0 -1\n3 0 1 2 0.5\n4 3 2 1 0 0.5\n"));
}

TEST(PlyReader, ReadsLinesThatEndWithCarriageReturns) {
  const std::string text =
      "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty "
      "float "
      "y\r\nproperty float z\r\nelement face 1\r\nproperty list uchar int "
      "vertex_index\r\nend_header\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n";
  const PolygonSoup soup = read_ply(text);
  EXPECT_EQ(soup.point.size(), 3u);
  EXPECT_EQ(soup.face.front(), (std::vector<std::size_t>{0, 1, 2}));
}

TEST(PlyReader, ReadsNumbersInTheLastLineOfTheHeader) {
  const std::string body =
      "1 0 0 0\n2 0.1 -1.5 -300\n3 0.2 -3 -600\n4 0.30000000000000004 -4.5 -900\n"
      "2 0 -1\n3 0 1 2 0.5\n4 3 2 1 0 0.5\n";
  std::string text = header("ascii", "int32");
  text.pop_back();
  expect_body(read_ply(text + body));
  expect_body(read_ply(text + " " + body));
  std::string raw = header("binary_little_endian", "int");
  raw.insert(raw.size() - 1, " 1");
  EXPECT_SAYS(message(raw + raw_body<std::int32_t>(false)), "end_header alone");
}

TEST(PlyReader, NamesTheHeaderLineThatIsWrong) {
  EXPECT_SAYS(message("solid\n"), "not PLY");
  EXPECT_SAYS(message("ply\nformat ascii 1.0\n"), "the header does not end");
  EXPECT_SAYS(message("ply\nformat ascii 1rtex 3\n"), "line 2: must be \"format\"");
  EXPECT_SAYS(message("ply\nformat pdp_endian 1.0\n"), "line 2: must be \"format\"");
  EXPECT_SAYS(message("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
              "line 3: a property before any element");
  EXPECT_SAYS(message("ply\nformat ascii 1.0\nelement vertex -1\n"),
              "line 3: must be \"element\", a name and a count");
  EXPECT_SAYS(message("ply\nformat ascii 1.0\nelement vertex 4000000000\n"),
              "line 3: announces 4000000000 elements");
  EXPECT_SAYS(message("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n"),
              "line 4: element \"vertex\" has no property");
  EXPECT_SAYS(message("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n"),
              "line 4: unknown type \"half\"");
  EXPECT_SAYS(
      message("ply\nformat ascii 1.0\nelement face 1\nproperty list float int a\n"),
      "line 4: a list's length must be an integer, is float");
}

TEST(PlyReader, NeedsCoordinatesAndFaces) {
  EXPECT_SAYS(message("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                      "property float y\nend_header\n0 0\n"),
              "2 of the vertex properties x, y and z");
  EXPECT_SAYS(message("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                      "property float y\nproperty float z\nend_header\n0 0 0\n"),
              "no faces");
}

TEST(PlyReader, NamesTheElementThatIsCutShortOrNoNumber) {
  const std::string big = header("binary_big_endian", "int");
  const std::string body = raw_body<std::int32_t>(true);
  for (std::size_t cut = 1; cut <= body.size(); ++cut) {
    EXPECT_SAYS(message(big + body.substr(0, body.size() - cut)), " of ");
  }
  EXPECT_SAYS(message(big + body.substr(0, 40)), "vertex 3 of 4 is cut short");
  EXPECT_SAYS(message(header("ascii", "int") + "1 0 0 0\n1 0,5 0 0\n"),
              "vertex 2 of 4 is cut short or no number");
  EXPECT_SAYS(message(header("ascii", "int") + "1 0 0 0 1 0 0 0 1 0 0 0 1 0 0 0 99 "),
              "edge 1 of 1 has a list vertices of 99 values");
  EXPECT_SAYS(message(header("ascii", "int") +
                      "1 0 0 0 1 0 0 0 1 0 0 0 1 0 0 0 0 3 0 1 -2 0 3 0 1 2 0"),
              "face 1 of 2 has the corner -2");
}

}  // namespace
}  // namespace palpate
