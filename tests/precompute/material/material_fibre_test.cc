#include "precompute/material/material_fibre.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/precompute/material/material_laws.h"

namespace palpate {
namespace {

using namespace material_laws;

const Eigen::Vector3d kFibre(1.0, 2.0, -0.5);
constexpr TransverseModuli kMuscle{30e3, 8e3, 5e3, 0.4, 0.45};

// Small strain under `stress`, of a law with no stiffness against twists.
Matrix3d strain_under(const Matrix3d& stress, const Material& law) {
  Tangent regular = response(law, Matrix3d::Identity()).tangent;
  const double scale = regular.norm();
  for (const auto& [i, j] :
       std::array<std::array<int, 2>, 3>{{{1, 3}, {2, 6}, {5, 7}}}) {
    Vector9 twist = Vector9::Zero();
    twist[i] = 1.0;
    twist[j] = -1.0;
    regular += scale * twist * twist.transpose();
  }
  Matrix3d strain;
  Eigen::Map<Vector9>(strain.data()) = regular.fullPivLu().solve(as_vector(stress));
  return strain;
}

TEST(TransverselyIsotropic, ObeysTheLaws) {
  const Material law = transversely_isotropic(kMuscle, kFibre, false);
  expect_zero_stress_at_rest(law);
  expect_stress_is_the_gradient_of_energy(law);
  expect_tangent_is_the_gradient_of_stress(law);
  expect_blind_to_small_rotation(law);
  expect_symmetric_about(kFibre, law);
  EXPECT_TRUE(is_linear(law));
  EXPECT_EQ(volume_measure(law), VolumeMeasure::kNone);
}

TEST(TransverselyIsotropic, ObeysTheLawsOnGreenStrain) {
  const Material law = transversely_isotropic(kMuscle, kFibre, true);
  expect_hyperelastic(law);
  expect_symmetric_about(kFibre, law);
  expect_small_strain_limit(law, transversely_isotropic(kMuscle, kFibre, false));
}

TEST(TransverselyIsotropic, FiveConstantsComeBackFromUniaxialStressAndShear) {
  const Eigen::Vector3d l = kFibre.normalized();
  const Eigen::Vector3d t = l.unitOrthogonal();
  const Eigen::Vector3d s = l.cross(t);
  for (const bool finite_strain : {false, true}) {
    const Material law = transversely_isotropic(kMuscle, 3.0 * kFibre, finite_strain);
    const Matrix3d along = strain_under(l * l.transpose(), law);
    EXPECT_NEAR(l.dot(along * l), 1.0 / 30e3, 1e-15);
    EXPECT_NEAR(t.dot(along * t), -0.4 / 30e3, 1e-15);
    EXPECT_NEAR(s.dot(along * s), -0.4 / 30e3, 1e-15);
    const Matrix3d across = strain_under(t * t.transpose(), law);
    EXPECT_NEAR(t.dot(across * t), 1.0 / 8e3, 1e-15);
    EXPECT_NEAR(s.dot(across * s), -0.45 / 8e3, 1e-15);
    EXPECT_NEAR(l.dot(across * l), -0.4 / 30e3, 1e-15);
    const Matrix3d shear = strain_under(l * t.transpose() + t * l.transpose(), law);
    EXPECT_NEAR(2.0 * l.dot(shear * t), 1.0 / 5e3, 1e-15);
    const Matrix3d plane = strain_under(s * t.transpose() + t * s.transpose(), law);
    EXPECT_NEAR(2.0 * s.dot(plane * t), 2.0 * 1.45 / 8e3, 1e-15);
  }
}

TEST(TransverselyIsotropic, WithEqualConstantsIsTheIsotropicLaw) {
  const double nu = 0.3;
  const TransverseModuli equal{5e3, 5e3, 5e3 / (2 * (1 + nu)), nu, nu};
  expect_small_strain_limit(transversely_isotropic(equal, kFibre, false),
                            linear(5e3, nu));
}

TEST(FibreExponential, ObeysTheLaws) {
  const Material law = fibre_exponential(5e3, 0.45, 2e3, 0.8, kFibre);
  // Away from Ibar4 = 1, where the tangent jumps; both sides are among the sample.
  std::vector<Matrix3d> smooth = sample_deformations();
  const auto before = smooth.size();
  std::erase_if(smooth, [](const Matrix3d& F) {
    const double stretch = (F * kFibre.normalized()).norm();
    return std::abs(stretch / std::cbrt(F.determinant()) - 1.0) < 10 * kStep;
  });
  ASSERT_GT(smooth.size(), before / 2);
  expect_hyperelastic(law, smooth);
  expect_symmetric_about(kFibre, law);
  expect_infinite_energy_without_volume(law);
}

TEST(FibreExponential, WithoutFibreModulusIsNeoHookean) {
  const Material law = fibre_exponential(5e3, 0.45, 0.0, 0.8, kFibre);
  expect_small_strain_limit(law, linear(5e3, 0.45));
  const Material neo = neo_hookean(5e3, 0.45);
  for (const Matrix3d& F : sample_deformations()) {
    const LocalResponse a = response(law, F);
    const LocalResponse b = response(neo, F);
    ASSERT_EQ(a.energy_density, b.energy_density);
    ASSERT_EQ(a.stress, b.stress);
    ASSERT_EQ(a.tangent, b.tangent);
  }
}

// Volume kept: Ibar4 = stretch^2 along the fibre. P11 - P22 F22/F11 is free of
// pressure.
TEST(FibreExponential, FibresAddTheClosedFormInTensionAndNothingInCompression) {
  constexpr double kMu = 5e3 / (2 * 1.45);
  constexpr double kK1 = 2e3;
  constexpr double kK2 = 0.8;
  const Material law = fibre_exponential(5e3, 0.45, kK1, kK2, Eigen::Vector3d::UnitX());
  for (const double l : {0.6, 0.9, 1.1, 1.4}) {
    const double side = 1.0 / std::sqrt(l);
    const Matrix3d F = Eigen::Vector3d(l, side, side).asDiagonal();
    const LocalResponse local = response(law, F);
    const double x = std::max(l * l - 1.0, 0.0);
    const double fibre = 2.0 * kK1 * l * x * std::exp(kK2 * x * x);
    const double nominal = local.stress(0, 0) - local.stress(1, 1) * side / l;
    EXPECT_NEAR(nominal, kMu * (l - 1.0 / (l * l)) + fibre, 1e-9);
  }
}

// A tangent that jumps makes the stress Lipschitz, not smooth: across the switch the
// stress changes by no more than the tangent in tension allows.
TEST(FibreExponential, StressIsContinuousWhereTheFibresComeUnderLoad) {
  const Material law = fibre_exponential(5e3, 0.45, 2e3, 0.8, Eigen::Vector3d::UnitX());
  const double gap = 1e-9;
  const Matrix3d slack = Eigen::Vector3d(1.0 - gap, 1.0, 1.0).asDiagonal();
  const Matrix3d taut = Eigen::Vector3d(1.0 + gap, 1.0, 1.0).asDiagonal();
  const LocalResponse above = response(law, taut);
  const LocalResponse below = response(law, slack);
  EXPECT_LE((above.stress - below.stress).norm(), 2 * gap * above.tangent.norm());
  // The jump at rest: 4 k1 (d Ibar4/dF)^2/4 = 4 k1 (2/3)^2 in the entry of the fibre.
  EXPECT_NEAR(above.tangent(0, 0) - below.tangent(0, 0), 4 * 2e3 * 4.0 / 9.0, 1e-3);
}

TEST(FibreExponential, EnergyPastTheLargestDoubleIsInfinite) {
  const Material law =
      fibre_exponential(5e3, 0.45, 2e3, 100.0, Eigen::Vector3d::UnitX());
  for (const double l : {3.0, 30.0, 1e10, 1e100}) {
    const double side = 1.0 / std::sqrt(l);
    const Matrix3d F = Eigen::Vector3d(l, side, side).asDiagonal();
    EXPECT_EQ(distortion_energy(law, F), INFINITY) << l;
    EXPECT_EQ(response(law, F).energy_density, INFINITY) << l;
  }
}

}  // namespace
}  // namespace palpate
