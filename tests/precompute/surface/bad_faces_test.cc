#include "precompute/surface/bad_faces.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(BadFaces, AGoodBodyHasNone) {
  EXPECT_TRUE(bad_faces(organ(2)).empty());
}

TEST(BadFaces, AreTheNeighboursOfAHole) {
  SurfaceMesh mesh = icosphere(0.01, 2);
  mesh.triangle.conservativeResize(mesh.triangle.rows() - 1, 3);
  const std::vector<BadFace> faces = bad_faces(mesh);
  ASSERT_EQ(faces.size(), 3U);
  for (const BadFace& face : faces) {
    EXPECT_EQ(face.fault, FaceFault::kBorder);
  }
}

TEST(BadFaces, AreATurnedTriangleAndItsNeighbours) {
  SurfaceMesh mesh = icosphere(0.01, 2);
  std::swap(mesh.triangle(9, 0), mesh.triangle(9, 1));
  const std::vector<BadFace> faces = bad_faces(mesh);
  ASSERT_EQ(faces.size(), 4U);
  for (const BadFace& face : faces) {
    EXPECT_EQ(face.fault, FaceFault::kFlipped);
  }
}

TEST(BadFaces, AreThoseThatCutThroughOthers) {
  SurfaceMesh mesh = icosphere(0.01, 2);
  mesh.position_m.row(0) *= -1.2;
  const std::vector<BadFace> faces = bad_faces(mesh);
  EXPECT_GT(faces.size(), 5U);
  for (const BadFace& face : faces) {
    EXPECT_EQ(face.fault, FaceFault::kSelfIntersecting);
  }
}

TEST(BadFaces, AreWrittenAsAFileThatReadsBack) {
  const ScratchFolder folder;
  SurfaceMesh mesh = icosphere(0.01, 2);
  mesh.triangle.conservativeResize(mesh.triangle.rows() - 1, 3);
  const std::vector<BadFace> faces = bad_faces(mesh);
  write_bad_faces(mesh, faces, folder / "bad.ply");
  const SurfaceMesh back = read_surface(folder / "bad.ply", "m");
  ASSERT_EQ(back.triangle.rows(), 3);
  for (Eigen::Index t = 0; t < 3; ++t) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const std::int32_t of = faces[static_cast<std::size_t>(t)].triangle;
      EXPECT_EQ(back.position_m.row(back.triangle(t, j)),
                mesh.position_m.row(mesh.triangle(of, j)));
    }
  }
  EXPECT_THROW(write_bad_faces(mesh, faces, folder / "bad.obj"), InputError);
}

}  // namespace
}  // namespace palpate
