#include "precompute/surface/glued_parts.h"

#include <array>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "precompute/surface/repair.h"
#include "precompute/surface/surface_check.h"

namespace palpate {
namespace {

// Blocks of a grid of unit cubes, each a closed surface; equal corners are one vertex,
// and a face that two of them share is there `shared` times.
SurfaceMesh blocks(const std::vector<std::array<int, 3>>& cells, int shared) {
  std::map<std::array<int, 3>, std::int32_t> number;
  std::map<std::array<std::int32_t, 4>, int> times;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (const std::array<int, 3>& cell : cells) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        std::array<std::int32_t, 4> quad{};
        for (int k = 0; k < 4; ++k) {
          const int u = k == 1 || k == 2 ? 1 : 0;
          const int v = k >= 2 ? 1 : 0;
          std::array<int, 3> p = cell;
          p[static_cast<std::size_t>(axis)] += side;
          p[static_cast<std::size_t>((axis + 1) % 3)] += u;
          p[static_cast<std::size_t>((axis + 2) % 3)] += v;
          quad[static_cast<std::size_t>(k)] =
              number.try_emplace(p, static_cast<std::int32_t>(number.size()))
                  .first->second;
        }
        std::array<std::int32_t, 4> key = quad;
        std::sort(key.begin(), key.end());
        if (++times[key] > shared) {
          continue;
        }
        // Counter-clockwise from outside; the diagonal is the same from both sides.
        if (side == 1) {
          triangles.push_back({quad[0], quad[1], quad[2]});
          triangles.push_back({quad[0], quad[2], quad[3]});
        } else {
          triangles.push_back({quad[0], quad[2], quad[1]});
          triangles.push_back({quad[0], quad[3], quad[2]});
        }
      }
    }
  }
  SurfaceMesh mesh;
  mesh.position_m.resize(std::ssize(number), 3);
  for (const auto& [p, v] : number) {
    mesh.position_m.row(v) << p[0], p[1], p[2];
  }
  mesh.triangle.resize(std::ssize(triangles), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::copy_n(triangles[t].data(), 3,
                mesh.triangle.row(static_cast<Eigen::Index>(t)).data());
  }
  return mesh;
}

SurfaceMesh turned(SurfaceMesh mesh) {
  mesh.triangle.col(1).swap(mesh.triangle.col(2));
  return mesh;
}

bool has_step(const RepairReport& report, const std::string& what) {
  return std::any_of(report.changed.begin(), report.changed.end(),
                     [&](const RepairStep& step) {
                       return step.what.find(what) != std::string::npos;
                     });
}

TEST(GluedParts, ThatShareAFaceBecomeOne) {
  for (const int times : {1, 2}) {
    const SurfaceMesh mesh =
        blocks({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, times);
    EXPECT_GT(check_surface(mesh).report.non_manifold_edges.count, 0U);
    const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
    EXPECT_EQ(repaired.report.refusal, "");
    EXPECT_EQ(repaired.report.after.components, 1);
    EXPECT_NEAR(repaired.report.after.volume_m3, 4.0, 1e-12);
    EXPECT_NEAR(repaired.report.after.area_m2, 18.0, 1e-12);
    EXPECT_EQ(repaired.mesh.position_m, mesh.position_m);
    EXPECT_TRUE(has_step(repaired.report, "inside the body taken out"));
  }
}

TEST(GluedParts, ThatTouchInAnEdgeOrAVertexArePartedByAHair) {
  for (const SurfaceMesh& mesh :
       {blocks({{0, 0, 0}, {1, 1, 0}}, 1), blocks({{0, 0, 0}, {1, 1, 1}}, 1),
        turned(blocks({{0, 0, 0}, {1, 1, 0}}, 1)),
        blocks({{0, 0, 0}, {1, 1, 0}, {2, 2, 1}}, 1)}) {
    const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
    EXPECT_EQ(repaired.report.refusal, "");
    const auto blocks_there = static_cast<double>(mesh.triangle.rows()) / 12.0;
    EXPECT_EQ(repaired.report.after.components, blocks_there);
    EXPECT_EQ(repaired.mesh.triangle.rows(), mesh.triangle.rows());
    EXPECT_GT(repaired.report.displaced_m, 5e-4);  // a thousandth, aslant
    EXPECT_LT(repaired.report.displaced_m, 2e-3);
    EXPECT_NEAR(repaired.report.after.volume_m3, blocks_there, 6e-3);
    EXPECT_LT(repaired.report.after.volume_m3, blocks_there);
    EXPECT_EQ(repaired.mesh.position_m.topRows(mesh.position_m.rows()),
              mesh.position_m);
    EXPECT_TRUE(has_step(repaired.report, "part sheets that touched"));
  }
}

TEST(GluedParts, ABodyThatTouchesItselfStaysOne) {
  // A ring of blocks that share faces, and closes in an edge.
  const SurfaceMesh mesh = blocks(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {0, 2, 0}, {1, 2, 0}}, 2);
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.report.after.components, 1);
  EXPECT_EQ(repaired.mesh.position_m.rows(), mesh.position_m.rows() + 2);
  EXPECT_NEAR(repaired.report.after.volume_m3, 7.0, 4e-3);
  EXPECT_LT(repaired.report.displaced_m, 2e-3);
}

TEST(GluedParts, WholeBodiesAreLeftAlone) {
  const SurfaceMesh mesh = blocks({{0, 0, 0}, {3, 0, 0}}, 1);
  std::size_t walls = 0;
  std::size_t added = 0;
  const SurfaceMesh same = part_touching(without_inner_walls(mesh, walls), added);
  EXPECT_EQ(walls + added, 0U);
  EXPECT_EQ(same.triangle, mesh.triangle);
  EXPECT_EQ(same.position_m, mesh.position_m);
}

}  // namespace
}  // namespace palpate
