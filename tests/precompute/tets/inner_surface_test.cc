#include "precompute/tets/inner_surface.h"

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/subdivide.h"
#include "precompute/tets/tet_regions.h"
#include "precompute/tets/tetrahedralise.h"

namespace palpate {
namespace {

SurfaceMesh cube(double half_m) {
  SurfaceMesh mesh;
  mesh.position_m.resize(8, 3);
  for (int v = 0; v < 8; ++v) {
    mesh.position_m.row(v) << (v & 1 ? half_m : -half_m), (v & 2 ? half_m : -half_m),
        (v & 4 ? half_m : -half_m);
  }
  mesh.triangle.resize(12, 3);
  mesh.triangle << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,  //
      2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
  return subdivide_midpoint(subdivide_midpoint(mesh));
}

SurfaceMesh ball(double x_m, double radius_m) {
  return sphere_surface({x_m, 0.0, 0.0}, radius_m, 0.5 * radius_m);
}

double ball_m3(double radius_m) {
  return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_m, 3);
}

double region_m3(const TetMesh& mesh, std::int32_t region) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    sum += mesh.region[static_cast<std::size_t>(t)] == region ? tet_volume_m3(mesh, t)
                                                              : 0.0;
  }
  return sum;
}

std::string refusal(const SurfaceMesh& outer, const std::vector<InnerSurface>& inner) {
  try {
    (void)tetrahedralise(outer, {}, inner);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(InnerSurfaces, PartTheBodyIntoRegionsOfTheirVolume) {
  const std::vector<InnerSurface> inner{{.surface = ball(0.3, 0.2)},
                                        {.surface = ball(-0.4, 0.3)}};
  const TetMesh mesh = tetrahedralise(cube(1.0), {}, inner);
  // 1e-12: rounding of some thousand terms.
  EXPECT_NEAR(region_m3(mesh, 1) / ball_m3(0.2), 1.0, 1e-12);
  EXPECT_NEAR(region_m3(mesh, 2) / ball_m3(0.3), 1.0, 1e-12);
  EXPECT_NEAR(region_m3(mesh, 0), 8.0 - ball_m3(0.2) - ball_m3(0.3), 1e-11);
}

TEST(InnerSurfaces, KeepTheirVerticesBehindThoseOfTheBody) {
  const SurfaceMesh outer = cube(1.0);
  const std::vector<InnerSurface> inner{{.surface = ball(0.3, 0.2)},
                                        {.surface = ball(-0.4, 0.3)}};
  const TetMesh mesh = tetrahedralise(outer, {}, inner);
  EXPECT_EQ(mesh.surface_vertices, outer.position_m.rows());
  EXPECT_EQ(mesh.position_m.topRows(outer.position_m.rows()), outer.position_m);
  Eigen::Index first = outer.position_m.rows();
  for (const InnerSurface& one : inner) {
    EXPECT_EQ(mesh.position_m.middleRows(first, one.surface.position_m.rows()),
              one.surface.position_m);
    first += one.surface.position_m.rows();
  }
}

TEST(InnerSurfaces, AreTheFacesBetweenRegions) {
  const SurfaceMesh outer = cube(1.0);
  const SurfaceMesh sphere = ball(0.1, 0.4);
  const TetMesh mesh =
      tetrahedralise(outer, {}, std::vector<InnerSurface>{{.surface = sphere}});
  Tets inside(mesh.tet.rows(), 4);
  Eigen::Index n = 0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    if (mesh.region[static_cast<std::size_t>(t)] == 1) {
      inside.row(n++) = mesh.tet.row(t);
    }
  }
  inside.conservativeResize(n, 4);
  const Triangles wall =
      sphere.triangle.array() + static_cast<int>(outer.position_m.rows());
  EXPECT_EQ(boundary_faces(inside), sorted_faces(wall));
}

TEST(InnerSurfaces, MayLieInOneAnotherInAnyOrder) {
  for (const bool inner_first : {false, true}) {
    std::vector<InnerSurface> inner{{.surface = ball(0.0, 0.6)},
                                    {.surface = ball(0.1, 0.3)}};
    if (inner_first) {
      std::swap(inner[0], inner[1]);
    }
    const TetMesh mesh = tetrahedralise(cube(1.0), {}, inner);
    const std::int32_t small = inner_first ? 1 : 2;
    EXPECT_NEAR(region_m3(mesh, small) / ball_m3(0.3), 1.0, 1e-12);
    EXPECT_NEAR(region_m3(mesh, 3 - small) / (ball_m3(0.6) - ball_m3(0.3)), 1.0, 1e-12);
    EXPECT_NEAR(region_m3(mesh, 0) / (8.0 - ball_m3(0.6)), 1.0, 1e-12);
  }
}

TEST(InnerSurfaces, CavitiesAreEmptyAndTheirSurfaceIsABoundary) {
  const SurfaceMesh outer = cube(1.0);
  const std::vector<InnerSurface> inner{{.surface = ball(0.5, 0.2)},
                                        {.surface = ball(-0.3, 0.4), .cavity = true}};
  // A size that puts vertices into the cavity, which are to vanish.
  const TetMesh mesh = tetrahedralise(outer, {.edge_max_m = 0.15}, inner);
  EXPECT_EQ(region_m3(mesh, 2), 0.0);
  EXPECT_NEAR(region_m3(mesh, 0), 8.0 - ball_m3(0.2) - ball_m3(0.4), 1e-11);
  EXPECT_EQ(boundary_faces(mesh.tet).rows(),
            outer.triangle.rows() + inner[1].surface.triangle.rows());
  std::set<std::int32_t> used(mesh.tet.data(), mesh.tet.data() + mesh.tet.size());
  EXPECT_EQ(std::ssize(used), mesh.position_m.rows());
}

TEST(InnerSurfaces, PartsOfTheBodyInACavityAreFilled) {
  const SurfaceMesh island = ball(0.0, 0.2);
  SurfaceMesh outer = cube(1.0);
  const auto first = static_cast<std::int32_t>(outer.position_m.rows());
  outer.position_m.conservativeResize(first + island.position_m.rows(), 3);
  outer.position_m.bottomRows(island.position_m.rows()) = island.position_m;
  outer.triangle.conservativeResize(outer.triangle.rows() + island.triangle.rows(), 3);
  outer.triangle.bottomRows(island.triangle.rows()) = island.triangle.array() + first;
  const std::vector<InnerSurface> inner{{.surface = ball(0.05, 0.4), .cavity = true},
                                        {.surface = ball(0.0, 0.1)}};
  const TetMesh mesh = tetrahedralise(outer, {}, inner);
  EXPECT_EQ(region_m3(mesh, 1), 0.0);
  EXPECT_NEAR(region_m3(mesh, 2) / ball_m3(0.1), 1.0, 1e-12);
  EXPECT_NEAR(region_m3(mesh, 0), 8.0 - ball_m3(0.4) + ball_m3(0.2) - ball_m3(0.1),
              1e-11);
  EXPECT_EQ(boundary_faces(mesh.tet).rows(),
            outer.triangle.rows() + inner[0].surface.triangle.rows());
}

TEST(InnerSurfaces, AreTurnedIfInsideOut) {
  SurfaceMesh sphere = ball(0.0, 0.4);
  sphere.triangle.col(1).swap(sphere.triangle.col(2));
  const TetMesh mesh =
      tetrahedralise(cube(1.0), {}, std::vector<InnerSurface>{{.surface = sphere}});
  EXPECT_NEAR(region_m3(mesh, 1) / ball_m3(0.4), 1.0, 1e-12);
}

TEST(InnerSurfaces, ThatTouchOrCrossAreRefusedByName) {
  const SurfaceMesh outer = cube(1.0);
  const std::string crossing = refusal(
      outer,
      {{.surface = ball(0.0, 0.2)}, {.surface = ball(0.3, 0.2), .name = "node"}});
  EXPECT_TRUE(
      has(crossing, "inner surface \"node\" touches or crosses inner surface 1"))
      << crossing;
  const std::string through = refusal(outer, {{.surface = ball(0.9, 0.2)}});
  EXPECT_TRUE(has(through, "inner surface 1 touches or crosses the body's surface"))
      << through;
  // A corner exactly on the face x = 1 of the cube.
  SurfaceMesh touching = cube(0.25);
  touching.position_m.col(0).array() += 0.75;
  EXPECT_TRUE(has(refusal(outer, {{.surface = touching}}), "the body's surface"));
}

TEST(InnerSurfaces, OutsideOfTheBodyAreRefused) {
  const std::string text =
      refusal(cube(1.0), {{.surface = ball(2.0, 0.2), .name = "nodule"}});
  EXPECT_TRUE(has(text, "inner surface \"nodule\" is outside of the body")) << text;
  // Around the body, too.
  EXPECT_TRUE(has(refusal(cube(1.0), {{.surface = ball(0.0, 3.0)}}), "is outside"));
}

TEST(InnerSurfaces, InACavityAreRefused) {
  const std::string text =
      refusal(cube(1.0), {{.surface = ball(0.0, 0.5), .cavity = true, .name = "cyst"},
                          {.surface = ball(0.0, 0.2), .name = "stone"}});
  EXPECT_TRUE(has(text, "\"stone\" floats in the cavity of inner surface \"cyst\""))
      << text;
}

TEST(InnerSurfaces, ThatAreOpenAreRefused) {
  SurfaceMesh open = ball(0.0, 0.3);
  open.triangle.conservativeResize(open.triangle.rows() - 1, 3);
  EXPECT_TRUE(has(refusal(cube(1.0), {{.surface = open}}),
                  "inner surface 1: not a body: 3 border edges"));
}

TEST(SphereSurface, HasTheBallsVolumeAndTheWantedEdge) {
  for (const double edge_m : {0.4, 0.15, 0.08}) {
    const SurfaceMesh mesh = sphere_surface({1.0, 2.0, 3.0}, 0.5, edge_m);
    EXPECT_NEAR(enclosed_volume_m3(mesh) / ball_m3(0.5), 1.0, 1e-12);
    EXPECT_LE(mean_edge_m(mesh), edge_m);
    EXPECT_GT(mean_edge_m(mesh), 0.45 * edge_m);
    EXPECT_TRUE(bounding_box(mesh).center().isApprox(Eigen::Vector3d(1, 2, 3), 1e-12));
  }
  EXPECT_THROW((void)sphere_surface({0, 0, 0}, 1.0, 0.001), InputError);
}

TEST(SizeFunction, MakesTetsSmallWhereItAsks) {
  // Fine in the middle of a coarse cube, where no surface triangle is in the way.
  const auto wanted = [](const Eigen::Vector3d& p,
                         const std::array<double, 5>& parameter) {
    return parameter[0] + parameter[1] * p.norm();
  };
  const std::array<double, 5> parameter{0.08, 0.4};
  const TetMesh mesh =
      tetrahedralise(cube(1.0), {.size = wanted, .size_parameter = parameter});
  Eigen::Index near = 0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int j = 0; j < 4; ++j) {
      middle += 0.25 * mesh.position_m.row(mesh.tet(t, j)).transpose();
    }
    if (middle.norm() < 0.5) {
      ++near;
      const double edge_m = wanted(middle, parameter);
      // 1.3: the last swaps against slivers come after the sizes.
      EXPECT_LE(tet_volume_m3(mesh, t),
                1.3 * std::pow(edge_m, 3) / (6.0 * std::numbers::sqrt2));
    }
  }
  EXPECT_GT(near, 500);
  EXPECT_LT(tetrahedralise(cube(1.0)).tet.rows(), mesh.tet.rows() / 2);
}

TEST(SizeFunction, ThatAsksForTooMuchIsRefused) {
  try {
    (void)tetrahedralise(cube(1.0),
                         {.tets_max = 20'000, .size = [](const auto&, const auto&) {
                            return 0.005;
                          }});
    FAIL() << "made millions of tets";
  } catch (const InputError& error) {
    EXPECT_TRUE(has(error.what(), "more than the 20000 allowed")) << error.what();
  }
}

}  // namespace
}  // namespace palpate
