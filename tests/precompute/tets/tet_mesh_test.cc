// Measures of single tets.
#include "precompute/tets/tet_mesh.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(TetShape, IsOneForARegularTetAndFallsWithItsHeight) {
  TetMesh mesh;
  mesh.position_m.resize(4, 3);
  mesh.position_m << 1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0, -1.0, -1.0, 1.0;
  mesh.tet.resize(1, 4);
  mesh.tet << 0, 1, 2, 3;
  EXPECT_NEAR(tet_shape(mesh, 0), 1.0, 1e-14);
  // Its last corner on the way to the middle of the opposite face: the edges there stay
  // the longest.
  const Eigen::RowVector3d foot = mesh.position_m.topRows<3>().colwise().mean();
  const Eigen::RowVector3d top = mesh.position_m.row(3);
  for (const double height : {0.5, 1e-3}) {
    mesh.position_m.row(3) = foot + height * (top - foot);
    EXPECT_NEAR(tet_shape(mesh, 0), height, 1e-14);
  }
}

}  // namespace
}  // namespace palpate
