#include "precompute/tets/tetrahedralise.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/subdivide.h"
#include "precompute/surface/surface_check.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

SurfaceMesh moved(SurfaceMesh mesh, const Eigen::RowVector3d& by_m) {
  mesh.position_m.rowwise() += by_m;
  return mesh;
}

TEST(Tetrahedralise, KeepsTheSurfaceVerticesBitForBit) {
  for (const double scale : {1e-5, 0.0931, 1.0, 77.7}) {  // not powers of two
    const SurfaceMesh surface = icosphere(scale, 2);
    const TetMesh mesh = tetrahedralise(surface);
    EXPECT_EQ(mesh.surface_vertices, surface.position_m.rows());
    EXPECT_EQ(mesh.position_m.topRows(surface.position_m.rows()), surface.position_m);
  }
}

TEST(Tetrahedralise, FillsTheVolumeWithPositiveTets) {
  const SurfaceMesh surface = organ();
  const TetMesh mesh = tetrahedralise(surface);
  const TetQuality quality = tet_quality(mesh);
  EXPECT_GT(quality.smallest_volume_m3, 0.0);
  // 1e-12: rounding of some thousand terms.
  EXPECT_NEAR(quality.volume_m3 / enclosed_volume_m3(surface), 1.0, 1e-12);
  EXPECT_GT(quality.smallest_dihedral_rad, 3.0 * kDegree);
}

TEST(Tetrahedralise, KeepsCoplanarTrianglesApart) {
  // A flat face might be triangulated anew: the check of the faces inside would throw.
  const SurfaceMesh surface = graded_block(0.1, 0.1, 0.005, 8);
  const TetMesh mesh = tetrahedralise(surface);
  EXPECT_GT(tet_quality(mesh).smallest_dihedral_rad, 8.0 * kDegree);
}

TEST(Tetrahedralise, MakesFewSliversInARealLiver) {
  const auto file = test_data("meshes/sofa_liver2.obj");
  if (!file) {
    GTEST_SKIP() << "no test data";
  }
  const TetMesh mesh = tetrahedralise(subdivide_midpoint(read_surface(*file, "cm")));
  // 0.4 degrees if TetGen is not asked for dihedral angles.
  EXPECT_GT(tet_quality(mesh).smallest_dihedral_rad, 0.7 * kDegree);
}

TEST(Tetrahedralise, FillsDisjointParts) {
  const SurfaceMesh one = icosphere(0.01, 2);
  const SurfaceMesh two = joined(one, moved(one, {0.05, 0.0, 0.0}));
  EXPECT_NEAR(tet_quality(tetrahedralise(two)).volume_m3 / enclosed_volume_m3(one), 2.0,
              1e-11);
}

TEST(Tetrahedralise, GivesTheSameMeshForTheSameSurface) {
  const TetMesh a = tetrahedralise(organ());
  const TetMesh b = tetrahedralise(organ());
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.tet, b.tet);
}

TEST(Tetrahedralise, EstimatesTheNumberOfTets) {
  struct Case {
    SurfaceMesh surface;
    TetOptions options;
  };
  const Case cases[] = {{icosphere(0.01, 2), {}},
                        {icosphere(0.01, 4), {}},
                        {organ(), {}},
                        {organ(), {.edge_max_m = 0.004}},
                        {graded_block(0.1, 0.1, 0.005, 12), {}},
                        {icosphere(0.01, 3), {.edge_max_m = 0.0008}}};
  for (const Case& c : cases) {
    const double made =
        static_cast<double>(tetrahedralise(c.surface, c.options).tet.rows());
    const double estimate = estimated_tets(c.surface, c.options);
    EXPECT_LT(estimate / made, 2.0) << made;
    EXPECT_GT(estimate / made, 0.5) << made;
  }
}

TEST(Tetrahedralise, RefusesToExplodeBeforeItStarts) {
  try {
    (void)tetrahedralise(icosphere(10.0, 2), {.edge_max_m = 0.001});
    FAIL() << "accepted a slip of the unit";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("length unit"), std::string::npos);
  }
}

TEST(Tetrahedralise, TurnsTheMeshersFailureIntoAnError) {
  const SurfaceMesh one = icosphere(0.01, 2);
  const SurfaceMesh crossing = joined(one, moved(one, {0.01, 0.001, 0.002}));
  try {
    (void)tetrahedralise(crossing);
    FAIL() << "meshed a self-intersecting surface";
  } catch (const NumericalError& error) {
    // Only if the failure path threw in the child instead of killing it.
    EXPECT_NE(std::string(error.what()).find("intersects itself"), std::string::npos)
        << error.what();
  }
}

TEST(Tetrahedralise, SurvivesInputThatKillsTheMesher) {
  SurfaceMesh flat = icosphere(0.01, 1);
  flat.position_m.col(2).setZero();
  EXPECT_THROW((void)tetrahedralise(flat), NumericalError);
}

TEST(Tetrahedralise, RefusesWhatIsNoSurface) {
  SurfaceMesh broken = icosphere(0.01, 1);
  broken.position_m(3, 1) = std::nan("");
  EXPECT_THROW((void)tetrahedralise(broken), InputError);
  broken = icosphere(0.01, 1);
  broken.triangle(5, 2) = 1000;
  EXPECT_THROW((void)tetrahedralise(broken), InputError);
  EXPECT_THROW((void)tetrahedralise(SurfaceMesh{}), InputError);
}

TEST(Tetrahedralise, RefusesOptionsOutOfRange) {
  const SurfaceMesh surface = icosphere(0.01, 1);
  EXPECT_THROW((void)tetrahedralise(surface, {.edge_max_m = 0.0}), InputError);
  EXPECT_THROW((void)tetrahedralise(surface, {.radius_edge_max = std::nan("")}),
               InputError);
  EXPECT_THROW((void)tetrahedralise(surface, {.time_limit_s = -1.0}), InputError);
}

TEST(TetQuality, RegularTetHasDihedralArccosOneThird) {
  TetMesh mesh;
  mesh.position_m.resize(4, 3);
  mesh.position_m << 1, 1, 1, -1, 1, -1, 1, -1, -1, -1, -1, 1;
  mesh.tet.resize(1, 4);
  mesh.tet << 0, 1, 2, 3;
  const TetQuality quality = tet_quality(mesh);
  EXPECT_NEAR(quality.volume_m3, 8.0 / 3.0, 1e-15);
  EXPECT_NEAR(quality.smallest_dihedral_rad, std::acos(1.0 / 3.0), 1e-15);
  EXPECT_NEAR(quality.largest_dihedral_rad, std::acos(1.0 / 3.0), 1e-15);
}

// A machine part of 161 vertices on which TetGen 1.5 aborts while it improves tets;
// from Debian's libcgal-demo.
TEST(Tetrahedralise, IsTriedAgainWhereTheMesherAborts) {
  const std::string archive = "/usr/share/doc/libcgal-dev/data.tar.gz";
  if (!std::filesystem::exists(archive)) {
    GTEST_SKIP() << "no " << archive << " (package libcgal-demo)";
  }
  const ScratchFolder folder;
  const std::string command = "tar xzf " + archive + " -C " + folder.path().string() +
                              " data/meshes/dragknob.off";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const SurfaceMesh surface =
      require_body(read_surface(folder / "data/meshes/dragknob.off", "m"), "a knob")
          .mesh;
  for (SurfaceMesh finer : {surface, subdivide_midpoint(surface)}) {
    const TetMesh mesh = tetrahedralise(finer);
    EXPECT_EQ(mesh.position_m.topRows(finer.position_m.rows()), finer.position_m);
    EXPECT_NEAR(tet_quality(mesh).volume_m3 / enclosed_volume_m3(finer), 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace palpate
