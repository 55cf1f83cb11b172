#include "precompute/tets/cut_regions.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/subdivide.h"
#include "precompute/tets/tet_regions.h"
#include "precompute/tets/tetrahedralise.h"

namespace palpate {
namespace {

SurfaceMesh block(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m,
                  int halvings) {
  SurfaceMesh mesh;
  mesh.position_m.resize(8, 3);
  for (int v = 0; v < 8; ++v) {
    mesh.position_m.row(v) << (v & 1 ? high_m : low_m).x(),
        (v & 2 ? high_m : low_m).y(), (v & 4 ? high_m : low_m).z();
  }
  mesh.triangle.resize(12, 3);
  mesh.triangle << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,  //
      2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
  for (int i = 0; i < halvings; ++i) {
    mesh = subdivide_midpoint(mesh);
  }
  return mesh;
}

SurfaceMesh unit_cube() {
  return block({0, 0, 0}, {1, 1, 1}, 3);
}

FilledBody filled(const SurfaceMesh& outer, std::vector<InnerSurface> inner) {
  mark_cut(outer, inner);
  return cut_regions(outer, inner, {outer, tetrahedralise(outer, {}, inner)});
}

double part_m3(const TetMesh& mesh, std::int32_t region) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    sum += mesh.region[static_cast<std::size_t>(t)] == region ? tet_volume_m3(mesh, t)
                                                              : 0.0;
  }
  return sum;
}

void expect_conforming(const FilledBody& body, const SurfaceMesh& outer) {
  const TetQuality quality = tet_quality(body.tets);
  EXPECT_GT(quality.smallest_volume_m3, 0.0);
  EXPECT_NEAR(quality.volume_m3 / enclosed_volume_m3(outer), 1.0, 1e-12);
  EXPECT_EQ(boundary_faces(body.tets.tet), sorted_faces(body.surface.triangle));
  EXPECT_EQ(body.tets.surface_vertices, body.surface.position_m.rows());
  EXPECT_EQ(body.surface.position_m.topRows(outer.position_m.rows()), outer.position_m);
  EXPECT_NEAR(surface_area_m2(body.surface) / surface_area_m2(outer), 1.0, 1e-12);
}

// Flush at five sides; its own triangles meet none of the cube's edges.
InnerSurface slab(double low_m, double high_m) {
  return {.surface = block({0, 0, low_m}, {1, 1, high_m}, 1), .name = "slab"};
}

TEST(CutRegions, ASlabSharesTheSidesOfTheBody) {
  const FilledBody body = filled(unit_cube(), {slab(0.83, 1.0)});
  expect_conforming(body, unit_cube());
  // A flat wall is where it is, but for a fiftieth of an edge (0.125) at the sides.
  EXPECT_NEAR(part_m3(body.tets, 1), 0.17, 5e-4);
}

TEST(CutRegions, PartsThatTouchShareTheirFace) {
  const FilledBody body = filled(unit_cube(), {slab(0.83, 1.0), slab(0.41, 0.83)});
  expect_conforming(body, unit_cube());
  EXPECT_NEAR(part_m3(body.tets, 1), 0.17, 5e-4);
  EXPECT_NEAR(part_m3(body.tets, 2), 0.42, 1e-3);
  EXPECT_NEAR(part_m3(body.tets, 0), 0.41, 5e-4);
}

// Flush at the top; the sides are off by less than 1/500 of the diagonal.
TEST(CutRegions, FacesThatNearlyCoincideAreShared) {
  for (const double off_m : {-1e-3, 1e-3}) {
    InnerSurface top{.surface =
                         block({-off_m, -off_m, 0.83}, {1 + off_m, 1 + off_m, 1.0}, 1)};
    const FilledBody body = filled(unit_cube(), {top});
    expect_conforming(body, unit_cube());
    EXPECT_NEAR(part_m3(body.tets, 1), 0.17, 1.5e-3);
  }
}

// Walls with edges are cut off there, by less the finer the tets are.
double largest_volume_error_m3(int halvings, bool deep_first) {
  std::vector<InnerSurface> layers{{.name = "skin", .cut = true, .under_m = 0.11},
                                   {.name = "fat", .cut = true, .under_m = 0.23}};
  if (deep_first) {
    std::swap(layers[0], layers[1]);
  }
  const SurfaceMesh outer = block({0, 0, 0}, {1, 1, 1}, halvings);
  const FilledBody body = filled(outer, layers);
  expect_conforming(body, outer);
  const double skin_m3 = part_m3(body.tets, deep_first ? 2 : 1);
  const double fat_m3 = part_m3(body.tets, deep_first ? 1 : 2);
  return std::max(std::abs(skin_m3 - (1.0 - std::pow(0.78, 3))),
                  std::abs(fat_m3 - (std::pow(0.78, 3) - std::pow(0.54, 3))));
}

TEST(CutRegions, LayersCountFromTheSurfaceInAnyOrder) {
  for (const bool deep_first : {false, true}) {
    const double coarse = largest_volume_error_m3(3, deep_first);
    const double fine = largest_volume_error_m3(5, deep_first);
    // Not a fourth of it: tets in the depth do not shrink as the surface's edges do.
    EXPECT_LT(fine, 0.5 * coarse) << coarse << " " << fine;
  }
}

TEST(CutRegions, APartInALayerIsLeftWhole) {
  const FilledBody body =
      filled(unit_cube(), {{.name = "skin", .cut = true, .under_m = 0.3},
                           {.surface = sphere_surface({0.5, 0.5, 0.78}, 0.1, 0.05)}});
  expect_conforming(body, unit_cube());
  const double ball_m3 =
      enclosed_volume_m3(sphere_surface({0.5, 0.5, 0.78}, 0.1, 0.05));
  EXPECT_NEAR(part_m3(body.tets, 2) / ball_m3, 1.0, 1e-12);
}

TEST(CutRegions, WhatReachesOutIsLeftOut) {
  const InnerSurface rod{.surface = block({0.4, 0.4, 0.6}, {0.6, 0.6, 1.2}, 2)};
  EXPECT_NEAR(share_left_out(unit_cube(), rod), 1.0 / 3.0, 0.06);
  double error_m3 = 0.016;
  for (const int halvings : {3, 5}) {
    const SurfaceMesh outer = block({0, 0, 0}, {1, 1, 1}, halvings);
    const FilledBody body = filled(outer, {rod});
    expect_conforming(body, outer);
    const double now_m3 = std::abs(part_m3(body.tets, 1) - 0.016);
    EXPECT_LT(now_m3, 0.6 * error_m3);
    error_m3 = now_m3;
  }
}

TEST(CutRegions, ACavityMayNotReachTheSurface) {
  InnerSurface hole{.surface = block({0.4, 0.4, 0.6}, {0.6, 0.6, 1.0}, 1),
                    .cavity = true,
                    .name = "hole"};
  EXPECT_THROW((void)filled(unit_cube(), {hole}), InputError);
}

TEST(CutRegions, APartThatNoTetLiesInIsNamed) {
  InnerSurface sheet{.surface = block({0.31, 0.31, 0.5001}, {0.32, 0.32, 0.5003}, 0),
                     .name = "sheet",
                     .cut = true};
  EXPECT_THROW((void)filled(unit_cube(), {sheet}), InputError);
}

}  // namespace
}  // namespace palpate
