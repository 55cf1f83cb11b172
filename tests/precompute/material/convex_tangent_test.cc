#include "precompute/material/convex_tangent.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/precompute/material/material_laws.h"

namespace palpate {
namespace {

Tangent clipped_whole(const Tangent& tangent) {
  const Eigen::SelfAdjointEigenSolver<Tangent> eigen(tangent);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

// The law's tangent under a pressure, which makes it indefinite.
Tangent pressed(const Material& law, const Eigen::Matrix3d& F, double pressure_pa) {
  Tangent tangent = distortion_response(law, F).tangent;
  tangent -= pressure_pa * volume_response(VolumeMeasure::kJacobian, F).curvature;
  return tangent;
}

// How many were indefinite.
int expect_as_whole(const Material& law) {
  int indefinite = 0;
  for (const Eigen::Matrix3d& F : material_laws::sample_deformations()) {
    for (const double pressure_pa : {-3e4, 2e3, 5e4}) {
      const Tangent tangent = pressed(law, F, pressure_pa);
      const Tangent expected = clipped_whole(tangent);
      Tangent clipped = tangent;
      clip_negative(F, clipped);
      EXPECT_LT((clipped - expected).norm(), 1e-9 * tangent.norm());
      indefinite += (expected - tangent).norm() > 1e-6 * tangent.norm() ? 1 : 0;
    }
  }
  return indefinite;
}

TEST(ConvexTangent, OfIsotropicLawsIsThatOfTheWholeEigensystem) {
  EXPECT_GT(expect_as_whole(neo_hookean(6e3, 0.45)), 100);
  EXPECT_GT(expect_as_whole(MooneyRivlin{5e2, 4e2, 2e4}), 100);
}

TEST(ConvexTangent, OfOtherLawsToo) {
  // Not of any law, and of no isotropic one.
  std::mt19937_64 random(3);
  std::normal_distribution<double> entry;
  const Eigen::Matrix3d F = material_laws::sample_deformations()[60];
  for (int i = 0; i < 20; ++i) {
    const Tangent some = Tangent::NullaryExpr([&] {
      return entry(random);
    });
    const Tangent tangent = some + some.transpose();
    Tangent clipped = tangent;
    clip_negative(F, clipped);
    EXPECT_LT((clipped - clipped_whole(tangent)).norm(), 1e-12 * tangent.norm());
  }
}

TEST(ConvexTangent, OneThatIsDefiniteStaysAsItIs) {
  const Tangent tangent = Tangent::Identity() * 7.0;
  Tangent clipped = tangent;
  clip_negative(Eigen::Matrix3d::Zero(), clipped);
  EXPECT_EQ(clipped, tangent);
}

}  // namespace
}  // namespace palpate
