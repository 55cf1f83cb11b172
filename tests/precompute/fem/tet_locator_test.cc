#include "precompute/fem/tet_locator.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/box_tets.h"

namespace palpate {
namespace {

double quadratic_field(const Eigen::Vector3d& p) {
  return 0.3 + p.x() - 2.0 * p.y() + p.x() * p.z() - 0.7 * p.y() * p.y() +
         p.z() * p.z();
}

TEST(TetLocator, ReproducesAQuadraticFieldInsideAndJustOutside) {
  const BoxTets box = box_tets({0.0, 0.1, 0.5, 1.0}, {0.0, 0.4, 0.5}, {0.0, 0.2, 0.3});
  const QuadraticMesh mesh = make_quadratic(box.tets, box.surface);
  const TetLocator locator(mesh);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(-0.02, 1.02);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p(anywhere(random), 0.5 * anywhere(random),
                            0.3 * anywhere(random));
    const TetLocator::Place place = locator.place(p);
    double value = 0.0;
    for (std::size_t a = 0; a < 10; ++a) {
      value += place.shape[static_cast<Eigen::Index>(a)] *
               quadratic_field(mesh.position_m.row(place.node[a]).transpose());
    }
    EXPECT_NEAR(value, quadratic_field(p), 1e-12);
    EXPECT_NEAR(place.shape.sum(), 1.0, 1e-13);
    // A tet that the point is far outside of has large shape functions.
    EXPECT_LT(place.shape.cwiseAbs().maxCoeff(), 2.0);
  }
}

}  // namespace
}  // namespace palpate
