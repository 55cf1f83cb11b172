#include "formats/mesh/surface_reader.h"

#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "tests/support/said.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class SurfaceReader : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string message(const std::string& name, const std::string& text) {
    try {
      (void)read_surface(file(name, text), "mm");
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  }
  ScratchFolder folder_;
};

const std::string kObj =
    "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\n"
    "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

std::string ascii_stl(const SurfaceMesh& mesh, const std::string& head) {
  std::string text = head;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int j = 0; j < 3; ++j) {
      const auto p = mesh.position_m.row(mesh.triangle(t, j));
      text += fmt::format("vertex {} {} {}\n", p(0), p(1), p(2));
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

std::string binary_stl(const SurfaceMesh& mesh) {
  std::string bytes(80, ' ');
  bytes.replace(0, 11, "solid but no");
  bytes.resize(80);
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  append(static_cast<std::uint32_t>(mesh.triangle.rows()));
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    append(std::array<float, 3>{});
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        append(static_cast<float>(mesh.position_m(mesh.triangle(t, j), k)));
      }
    }
    append(std::uint16_t{0});
  }
  return bytes;
}

TEST_F(SurfaceReader, ConvertsToMetres) {
  const auto path = file("a.obj", kObj);
  EXPECT_EQ(read_surface(path, "mm").position_m.maxCoeff(), 0.01);
  EXPECT_EQ(read_surface(path, "m").position_m.maxCoeff(), 10.0);
  EXPECT_THROW((void)read_surface(path, "furlong"), InputError);
}

TEST_F(SurfaceReader, KeepsVerticesAndTrianglesInOrder) {
  const SurfaceMesh body = sphere_surface(0.05, 2);
  write_obj(body, folder_ / "organ.obj", "a test");
  const SurfaceMesh read = read_surface(folder_ / "organ.obj", "m");
  EXPECT_EQ(read.position_m, body.position_m);  // bit for bit
  EXPECT_EQ(read.triangle, body.triangle);
}

TEST_F(SurfaceReader, DoesNotMergeEqualVerticesOfAnObj) {
  const auto path = file("a.obj", "v 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n");
  EXPECT_EQ(read_surface(path, "m").position_m.rows(), 4);
}

TEST_F(SurfaceReader, ReadsObjAsPeopleWriteIt) {
  const auto path =
      file("A.OBJ",
           "# c\r\nmtllib x.mtl\r\no thing\r\nv 0 0 0 0.5 0.5 0.5\r\n"
           "v\t10 0 0\r\n  v 0 10 0\r\nv 0 0 10\r\nvn 0 0 1\r\nl 1 2\r\n"
           "unknown statement\r\nf 1//1\t3//1\t2//1\r\nf 1/1/1 2/1 4/1/1\r\n"
           "f -4 -1 -2\r\nf 2 3 4\r\n");
  const SurfaceMesh mesh = read_surface(path, "mm");
  EXPECT_EQ(mesh.triangle, read_surface(file("b.obj", kObj), "mm").triangle);
}

TEST_F(SurfaceReader, ReadsObjWithContinuedLinesAndCarriageReturnsAlone) {
  const auto path = file("a.obj",
                         "\xEF\xBB\xBF# from a Macintosh\rv 0 0 0\rv 10 \\\r0 0\r"
                         "v 0 10 0\rv 0 0 +10.0e0\rf 1 3 2 # a comment\rf 1 2 4\r"
                         "f -4 -1 -2\rf 2\t3 \\\r4");
  const SurfaceMesh mesh = read_surface(path, "mm");
  EXPECT_EQ(mesh.triangle, read_surface(file("b.obj", kObj), "mm").triangle);
  EXPECT_EQ(mesh.position_m, read_surface(file("b.obj", kObj), "mm").position_m);
}

TEST_F(SurfaceReader, CountsNegativeIndicesBackFromTheFaceItself) {
  const auto path = file("a.obj",
                         "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\n"
                         "v 5 5 5\nf -2 -4 -5\n");
  Triangles expected(2, 3);
  expected << 1, 2, 3, 4, 2, 1;
  EXPECT_EQ(read_surface(path, "m").triangle, expected);
}

TEST_F(SurfaceReader, RefusesObjIndicesThatNameNoVertex) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_TRUE(contains(message("a.obj", points + "f 0 1 2\n"),
                       "line 4: face 1 has the corner \"0\""));
  EXPECT_TRUE(contains(message("a.obj", points + "f 1 2 3x\n"), "the corner \"3x\""));
  EXPECT_TRUE(contains(message("a.obj", points + "f 1 2 3 99999999999999999999\n"),
                       "the corner \"99999999999999999999\""));
  EXPECT_TRUE(contains(message("a.obj", points + "f 1 2 -4\n"),
                       "face 1 has corner 0, allowed are 1 to 3"));
  EXPECT_TRUE(contains(message("a.obj", "v 0,5 0 0\nf 1 1 1\n"),
                       "line 1: vertex 1 is not three finite numbers"));
}

TEST_F(SurfaceReader, ReadsStlTextAsPeopleWriteIt) {
  const SurfaceMesh body = sphere_surface(1.0, 0);
  std::string text = ascii_stl(body, "solid a facet of it\n");
  const SurfaceMesh plain = read_surface(file("a.stl", text), "cm");
  EXPECT_EQ(plain.triangle.rows(), body.triangle.rows());
  text += text;  // a second solid
  std::string shouted;
  for (const char c : text) {
    shouted += c == '\n' ? std::string("\r\n  ")
                         : std::string(1, static_cast<char>(std::toupper(c)));
  }
  const SurfaceMesh read = read_surface(file("b.stl", "\r\n" + shouted), "cm");
  EXPECT_EQ(read.position_m, plain.position_m);
  EXPECT_EQ(read.triangle.rows(), 2 * plain.triangle.rows());
}

TEST_F(SurfaceReader, ReadsOffWithCommentsAndCarriageReturns) {
  const std::string points = "0 0 0\r\n# a corner\r\n10 0 0\r\n0 10 0\r\n0 0 10\r\n";
  const std::string faces = "3 0 2 1\r\n3 0 1 3\r\n3 0 3 2\r\n\r\n3 1 2 3\r\n";
  const SurfaceMesh mesh = read_surface(
      file("a.off", "OFF # by hand\r\n# sizes\r\n4 4 0\r\n" + points + faces), "mm");
  EXPECT_EQ(mesh.triangle, read_surface(file("b.obj", kObj), "mm").triangle);
  EXPECT_EQ(mesh.position_m, read_surface(file("b.obj", kObj), "mm").position_m);
}

TEST_F(SurfaceReader, PassesOverNormalsAndColoursOfOff) {
  const std::string text =
      "CNOFF 4 4 6\n0 0 0 0 0 1 .5 .5 .5 1\n10 0 0 0 0 1 .5 .5 .5 1\n"
      "0 10 0 0 0 1 .5 .5 .5 1\n0 0 10 0 0 1 .5 .5 .5 1\n"
      "3 0 2 1 255 0 0\n3 0 1 3 # blue\n3 0 3 2\n3 1 2 3 7\n";
  const SurfaceMesh mesh = read_surface(file("a.off", text), "mm");
  EXPECT_EQ(mesh.triangle, read_surface(file("b.obj", kObj), "mm").triangle);
  EXPECT_EQ(mesh.position_m, read_surface(file("b.obj", kObj), "mm").position_m);
}

TEST_F(SurfaceReader, RefusesOffThatIsNot) {
  EXPECT_TRUE(contains(message("a.off", "4OFF\n4 4 0\n"), "must be OFF"));
  EXPECT_TRUE(contains(message("b.off", "OFF BINARY\n4 4 0\n"), "must be text"));
  EXPECT_TRUE(contains(message("c.off", "OFF\nfour\n"), "not the counts"));
  EXPECT_TRUE(contains(message("d.off", "OFF\n1 1 0\n0 0\n"), "line 3: vertex 1"));
  EXPECT_TRUE(contains(message("e.off", "OFF\n1 1 0\n0 0 0\n3 0 0\n"),
                       "line 4: face 1 is not a count and as many vertices"));
  // Counts that no memory holds.
  EXPECT_TRUE(contains(message("f.off", "OFF\n1 1 0\n0 0 0\n999999999999 0\n"),
                       "line 4: face 1"));
  EXPECT_TRUE(
      contains(message("g.off", "OFF\n99999999999999 1 0\n0 0 0\n"), "cut short"));
}

TEST_F(SurfaceReader, CutsQuadranglesIntoTriangles) {
  const auto path =
      file("cube.off",
           "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n"
           "0 1 1\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n"
           "4 3 0 4 7\n");
  const SurfaceMesh cube = read_surface(path, "m");
  EXPECT_EQ(cube.position_m.rows(), 8);
  EXPECT_EQ(cube.triangle.rows(), 12);
  EXPECT_DOUBLE_EQ(enclosed_volume_m3(cube), 1.0);
}

TEST_F(SurfaceReader, ReadsAsciiPly) {
  const auto path =
      file("a.ply",
           "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
           "property float y\nproperty float z\nelement face 4\nproperty "
           "list uchar int vertex_indices\nend_header\n0 0 0\n10 0 0\n0 10 "
           "0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const SurfaceMesh mesh = read_surface(path, "mm");
  EXPECT_EQ(mesh.triangle, read_surface(file("b.obj", kObj), "mm").triangle);
}

TEST_F(SurfaceReader, MergesTheEqualPointsOfStl) {
  const SurfaceMesh body = sphere_surface(1.0, 1);
  const std::string texts[] = {ascii_stl(body, "solid ball\n"),
                               ascii_stl(body, "solid\tball\n"), binary_stl(body)};
  for (const std::string& text : texts) {
    const SurfaceMesh read = read_surface(file("a.stl", text), "cm");
    EXPECT_EQ(read.position_m.rows(), body.position_m.rows());
    EXPECT_EQ(read.triangle.rows(), body.triangle.rows());
    // 1e-6: coordinates in single precision.
    EXPECT_NEAR(enclosed_volume_m3(read) / enclosed_volume_m3(body) * 1e6, 1.0, 1e-6);
  }
}

TEST_F(SurfaceReader, RefusesStlThatIsCutShort) {
  const std::string binary = binary_stl(sphere_surface(1.0, 1));
  EXPECT_TRUE(contains(message("a.stl", 'x' + binary.substr(1, binary.size() - 30)),
                       "announces 80 triangles, 4084 bytes, but the file has 4055"))
      << message("a.stl", 'x' + binary.substr(1, binary.size() - 30));
  const std::string text = ascii_stl(sphere_surface(1.0, 1), "solid\n");
  EXPECT_TRUE(
      contains(message("b.stl", text.substr(0, text.find("outer", text.size() / 2))),
               "cut short"));
  EXPECT_TRUE(contains(message("c.stl", binary.substr(0, 3000)), "cut short"));
}

TEST_F(SurfaceReader, RefusesOtherFilesThatAreCutShort) {
  EXPECT_TRUE(contains(message("a.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n"), "cut short"));
  EXPECT_TRUE(contains(
      message("a.ply",
              "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty "
              "float y\nproperty float z\nelement face 4\nproperty list uchar int "
              "vertex_indices\nend_header\n0 0 0\n10 0 0\n"),
      "cut short"));
}

TEST_F(SurfaceReader, NamesTheVertexThatIsNotFinite) {
  EXPECT_TRUE(contains(message("a.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"),
                       "line 2: vertex 2 is not three finite numbers"));
  SurfaceMesh body = sphere_surface(1.0, 1);
  body.position_m(body.triangle(0, 1), 2) = std::nan("");
  EXPECT_TRUE(contains(message("b.stl", binary_stl(body)), "must be finite"));
}

TEST_F(SurfaceReader, NamesTheFaceWhoseIndexIsOutOfRange) {
  const std::string text =
      message("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
  EXPECT_TRUE(contains(text, "face 2 has corner 4, allowed are 1 to 3")) << text;
  EXPECT_TRUE(
      contains(message("b.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), "needs at least 3"));
}

TEST_F(SurfaceReader, RefusesWhatIsNoMesh) {
  EXPECT_TRUE(contains(message("a.obj", ""), "the file is empty"));
  EXPECT_TRUE(contains(message("b.obj", "hello, world\n"), "0 vertices"));
  EXPECT_TRUE(contains(message("a.stp", kObj), "known: .obj, .stl, .ply, .off"));
  EXPECT_TRUE(contains(message("a.o", kObj), "unknown mesh format"));
  std::string garbage;
  for (int i = 0; i < 4000; ++i) {
    garbage += static_cast<char>((i * 7919 + i / 13) % 256);
  }
  for (const char* name : {"g.obj", "g.stl", "g.ply", "g.off"}) {
    EXPECT_NE(message(name, garbage), "accepted") << name;
    EXPECT_TRUE(contains(message(name, garbage), name));
  }
  EXPECT_THROW((void)read_surface(folder_ / "absent.obj", "m"), InputError);
}

TEST_F(SurfaceReader, RefusesAFaceOfEndlessCorners) {
  std::string face = "f";
  std::string points;
  for (int i = 1; i <= 10'001; ++i) {
    face += fmt::format(" {}", i);
    points += fmt::format("v {} {} 0\n", std::cos(6e-4 * i), std::sin(6e-4 * i));
  }
  EXPECT_TRUE(contains(message("a.obj", points + face + "\n"),
                       "a face has 10001 corners, at most 10000"));
}

TEST_F(SurfaceReader, NamesACountThatIsNoNumber) {
  const std::string text = message(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 18446744073709551616\nproperty double "
      "x\nproperty double y\nproperty double z\nelement face 1\nproperty list uchar "
      "int vertex_indices\nend_header\n0 0 0\n");
  EXPECT_TRUE(contains(text, "announces 18446744073709551616 elements")) << text;
}

TEST_F(SurfaceReader, RefusesABodyOfImpossibleSize) {
  const std::string text =
      message("a.obj", "v 0 0 0\nv 1e34 0 0\nv 0 1e34 0\nf 1 2 3\n");
  EXPECT_TRUE(contains(text, "coordinates in mm")) << text;
}

TEST_F(SurfaceReader, TellsABodyOfUnusualSize) {
  const std::string huge = "v 0 0 0\nv 12000 0 0\nv 0 12000 0\nf 1 2 3\n";
  std::vector<std::string> notes;
  (void)read_surface(file("a.obj", huge), "mm", &notes);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(contains(notes[0], "a.obj: the body is 12 m long")) << notes[0];
  EXPECT_TRUE(contains(notes[0], "--length-unit")) << notes[0];
  (void)read_surface(file("a.obj", huge), "nm", &notes);  // 12 um
  EXPECT_EQ(notes.size(), 2U);
  (void)read_surface(file("a.obj", huge), "um", &notes);  // 12 mm
  EXPECT_EQ(notes.size(), 2U);
}

TEST_F(SurfaceReader, WriterRefusesOtherFormats) {
  EXPECT_THROW(write_obj(sphere_surface(0.05, 1), folder_ / "a.stl", "a test"),
               InputError);
}

TEST_F(SurfaceReader, BytesBehindAWholeBinaryStlArePassedOverAndSaid) {
  const SurfaceMesh mesh = sphere_surface(1.0, 0);
  std::vector<std::string> notes;
  const SurfaceMesh read =
      read_surface(file("a.stl", binary_stl(mesh) + "\r\n"), "mm", &notes);
  EXPECT_EQ(read.triangle.rows(), mesh.triangle.rows());
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("2 bytes behind"), std::string::npos) << notes[0];
  // As many as a triangle has: the header may be wrong.
  EXPECT_NE(message("b.stl", binary_stl(mesh) + std::string(50, ' ')), "accepted");
}

TEST_F(SurfaceReader, CornersOfStlThatRoundingPartedAreWeldedAndSaid) {
  SurfaceMesh mesh = sphere_surface(1.0, 0);
  mesh.position_m.rowwise() += Eigen::RowVector3d(100.0, 0.0, 1000.0);
  SurfaceMesh soup;
  soup.triangle.resize(mesh.triangle.rows(), 3);
  soup.position_m.resize(3 * mesh.triangle.rows(), 3);
  for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      soup.triangle(t, j) = 3 * t + j;
      soup.position_m.row(3 * t + j) = mesh.position_m.row(mesh.triangle(t, j));
      soup.position_m(3 * t + j, 2) += t % 2 == 0 ? 0.0 : 6e-5;  // a step at 1000
    }
  }
  std::vector<std::string> notes;
  const SurfaceMesh read = read_surface(file("a.stl", binary_stl(soup)), "mm", &notes);
  EXPECT_EQ(read.position_m.rows(), mesh.position_m.rows());
  EXPECT_EQ(read.triangle.rows(), mesh.triangle.rows());
  EXPECT_EQ(notes.size(), 1U);
}

TEST_F(SurfaceReader, NumbersMayStandCloseToTheirWord) {
  const SurfaceMesh off =
      read_surface(file("a.off",
                        "OFF4 4 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n"
                        "3 0 3 2\n3 1 2 3\n"),
                   "mm");
  EXPECT_EQ(off.triangle.rows(), 4);
  std::string text = ascii_stl(sphere_surface(1.0, 0), "solid\n");
  for (std::size_t at = 0; (at = text.find("vertex ", at)) != std::string::npos;) {
    text.erase(at + 6, 1);
  }
  EXPECT_EQ(read_surface(file("a.stl", text), "cm").triangle.rows(), 20);
}

}  // namespace
}  // namespace palpate
