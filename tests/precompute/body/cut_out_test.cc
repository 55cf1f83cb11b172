#include "precompute/body/cut_out.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/box_tets.h"

namespace palpate {
namespace {

constexpr int kCells = 8;

std::vector<double> steps() {
  std::vector<double> at;
  for (int i = 0; i <= kCells; ++i) {
    at.push_back(0.1 * i);
  }
  return at;
}

TetMesh box() {
  TetMesh mesh = box_tets(steps(), steps(), steps()).tets;
  mesh.surface_vertices = mesh.position_m.rows();
  return mesh;
}

std::int32_t corner_at(const TetMesh& mesh, const Eigen::Vector3d& p) {
  Eigen::Index nearest = 0;
  (mesh.position_m.rowwise() - p.transpose()).rowwise().norm().minCoeff(&nearest);
  return static_cast<std::int32_t>(nearest);
}

double volume_m3(const TetMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    EXPECT_GT(tet_volume_m3(mesh, t), 0.0);
    sum += tet_volume_m3(mesh, t);
  }
  return sum;
}

TEST(CutOut, OfAnEndlessRadiusIsTheBodyWithoutACut) {
  const ConnectedTets body = connect(box());
  const std::int32_t vertex = corner_at(body.mesh, {0.4, 0.4, 0.8});
  const CutOut all =
      cut_out(body, std::span(&vertex, 1), std::numeric_limits<double>::infinity());
  EXPECT_EQ(all.tets.tet, body.mesh.tet);
  EXPECT_EQ(all.tets.position_m, body.mesh.position_m);
  EXPECT_EQ(all.cut.rows(), 0);
  EXPECT_EQ(all.surface.rows(), 6 * kCells * kCells * 2);
}

TEST(CutOut, TakesEveryTetNearTheVertexAndCutsFartherAway) {
  constexpr double kRadius = 0.28;
  const ConnectedTets body = connect(box());
  const std::int32_t vertex = corner_at(body.mesh, {0.4, 0.4, 0.8});
  const Eigen::RowVector3d centre = body.mesh.position_m.row(vertex);
  const CutOut part = cut_out(body, std::span(&vertex, 1), kRadius);
  Eigen::Index near = 0;
  for (Eigen::Index t = 0; t < body.mesh.tet.rows(); ++t) {
    double least = std::numeric_limits<double>::infinity();
    for (int j = 0; j < 4; ++j) {
      least = std::min(least,
                       (body.mesh.position_m.row(body.mesh.tet(t, j)) - centre).norm());
    }
    near += least <= kRadius ? 1 : 0;
  }
  EXPECT_EQ(part.tets.tet.rows(), near);
  ASSERT_GT(part.cut.rows(), 0);
  for (const std::int32_t corner : part.cut.reshaped()) {
    EXPECT_GT((part.tets.position_m.row(corner) - centre).norm(), kRadius);
  }
  for (const std::int32_t corner : part.surface.reshaped()) {
    EXPECT_NEAR(part.tets.position_m(corner, 2), 0.8, 1e-12);
  }
}

TEST(CutOut, SurfaceAndCutEncloseItsTets) {
  const ConnectedTets body = connect(box());
  const std::int32_t vertex = corner_at(body.mesh, {0.0, 0.1, 0.8});
  const CutOut part = cut_out(body, std::span(&vertex, 1), 0.25);
  SurfaceMesh around{.position_m = part.tets.position_m, .triangle = {}};
  around.triangle.resize(part.surface.rows() + part.cut.rows(), 3);
  around.triangle << part.surface, part.cut;
  // Rounding of sums of a few hundred terms.
  EXPECT_NEAR(enclosed_volume_m3(around), volume_m3(part.tets), 1e-14);
}

TEST(CutOut, DoesNotCrossASlot) {
  TetMesh mesh = box();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (int j = 0; j < 4; ++j) {
      middle += 0.25 * mesh.position_m.row(mesh.tet(t, j));
    }
    const bool in_slot = middle.x() > 0.4 && middle.x() < 0.5 && middle.z() > 0.2;
    if (!in_slot) {
      kept.push_back(t);
    }
  }
  mesh.tet = mesh.tet(kept, Eigen::all).eval();
  const ConnectedTets body = connect(mesh);
  const std::int32_t vertex = corner_at(body.mesh, {0.3, 0.4, 0.8});
  const CutOut part = cut_out(body, std::span(&vertex, 1), 0.35);
  EXPECT_LE(part.tets.position_m.col(0).maxCoeff(), 0.4 + 1e-12);
}

}  // namespace
}  // namespace palpate
