// Springs under a part of the surface: as much of them as there is surface in it,
// however it is meshed.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/quadratic_mesh.h"
#include "tests/support/box_tets.h"

namespace palpate {
namespace {

// A box of 40 mm by 40 mm, its top at z = 0, of so many cells across.
QuadraticMesh box(int cells) {
  std::vector<double> across_m;
  for (int i = 0; i <= cells; ++i) {
    across_m.push_back(-0.02 + 0.04 * i / cells);
  }
  const BoxTets tets = box_tets(across_m, across_m, {-0.02, 0.0});
  return make_quadratic(tets.tets, tets.surface);
}

// What it takes to move the whole mesh by 1 m along x [N/m].
double sideways_n_per_m(const QuadraticMesh& mesh, double k_pa_per_m,
                        const Where& where) {
  const Eigen::Index n = 3 * mesh.position_m.rows();
  Stiffness K(n, n);
  add_foundation(K, mesh, k_pa_per_m, where);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; i += 3) {
    u[i] = 1.0;
  }
  return u.dot(K.selfadjointView<Eigen::Lower>() * u);
}

TEST(Foundation, OfAWholeSideIsItsAreaTimesTheStiffness) {
  const Where top = [](const Eigen::Vector3d& p) {
    return p.z() >= 0.0;
  };
  EXPECT_NEAR(sideways_n_per_m(box(4), 1e6, top), 1e6 * 0.04 * 0.04, 1e-6);
}

// A disc that contains few faces wholly, or none.
TEST(Foundation, OfADiscIsItsAreaWhateverTheMesh) {
  for (const double radius_m : {0.006, 0.009, 0.012}) {
    const Where disc = [&](const Eigen::Vector3d& p) {
      return p.z() >= 0.0 && std::hypot(p.x(), p.y()) <= radius_m;
    };
    const double expected = 1e9 * std::numbers::pi * radius_m * radius_m;
    for (const int cells : {2, 5, 8}) {
      // 24 points a face; of a disc smaller than a face few lie in it.
      const double points = 24 * expected / 1e9 / (0.5 * std::pow(0.04 / cells, 2));
      EXPECT_NEAR(sideways_n_per_m(box(cells), 1e9, disc) / expected, 1.0,
                  2.0 / std::sqrt(points))
          << radius_m << " m, " << cells << " cells";
    }
  }
}

}  // namespace
}  // namespace palpate
