#include "precompute/material/material.h"

#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/precompute/material/material_laws.h"
#include "tests/support/every_law.h"

namespace palpate {
namespace {

using namespace material_laws;

constexpr double kYoung = 5000.0;

double lateral_contraction(const Material& law) {
  const double small = 1e-6;
  Matrix3d stress = Matrix3d::Zero();
  stress(0, 0) = small;
  // A twist has no stiffness at rest: give it some, so that the tangent can be
  // inverted.
  Tangent regular = response(law, Matrix3d::Identity()).tangent;
  const double scale = regular.norm();
  for (const auto& [i, j] :
       std::array<std::array<int, 2>, 3>{{{1, 3}, {2, 6}, {5, 7}}}) {
    Vector9 twist = Vector9::Zero();
    twist[i] = 1.0;
    twist[j] = -1.0;
    regular += scale * twist * twist.transpose();
  }
  const Vector9 strain = regular.fullPivLu().solve(as_vector(stress));
  return -strain[4] / strain[0];
}

TEST(SmallModuli, AreTheVoigtMeansOfTheTangentAtRest) {
  for (const NamedLaw& named : every_law()) {
    Matrix3d F = Matrix3d::Identity();
    F(0, 0) += 1e-9;  // fibres along x bear something
    const Tangent C = response(named.law, F).tangent;
    double iijj = 0.0;
    double ijij = 0.0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        iijj += C(4 * i, 4 * j);
        ijij += C(i + 3 * j, i + 3 * j);
      }
    }
    const double shear = (3.0 * ijij - iijj) / 30.0;
    const double bulk = iijj / 9.0;
    const double youngs = 9.0 * bulk * shear / (3.0 * bulk + shear);
    EXPECT_NEAR(small_shear_modulus_pa(named.law), shear, 1e-6 * shear) << named.name;
    EXPECT_NEAR(small_youngs_modulus_pa(named.law), youngs, 1e-6 * youngs)
        << named.name;
  }
}

TEST(VolumeMeasure, DerivativesAreThoseOfTheta) {
  for (const VolumeMeasure measure :
       {VolumeMeasure::kNone, VolumeMeasure::kSmallTrace, VolumeMeasure::kGreenTrace,
        VolumeMeasure::kJacobian}) {
    EXPECT_EQ(volume_theta(measure, Matrix3d::Identity()), 0.0);
    for (const Matrix3d& F : sample_deformations()) {
      const VolumeResponse local = volume_response(measure, F);
      ASSERT_EQ(local.theta, volume_theta(measure, F));
      ASSERT_EQ(local.curvature, local.curvature.transpose());
      for (int i = 0; i < 9; ++i) {
        Matrix3d above = F;
        Matrix3d below = F;
        above.data()[i] += kStep;
        below.data()[i] -= kStep;
        // theta is at most quadratic in one entry, its gradient linear: the difference
        // is exact but for rounding, 1e-16/kStep.
        ASSERT_NEAR(
            local.gradient.data()[i],
            (volume_theta(measure, above) - volume_theta(measure, below)) / (2 * kStep),
            1e-9);
        const Matrix3d slope = (volume_response(measure, above).gradient -
                                volume_response(measure, below).gradient) /
                               (2 * kStep);
        ASSERT_LE((local.curvature.col(i) - as_vector(slope)).norm(), 1e-9);
      }
    }
  }
}

TEST(VolumeMeasure, EveryLawMeasuresWhatItsFormulaSays) {
  EXPECT_EQ(volume_measure(linear(kYoung, 0.3)), VolumeMeasure::kSmallTrace);
  EXPECT_EQ(volume_measure(st_venant_kirchhoff(kYoung, 0.3)),
            VolumeMeasure::kGreenTrace);
  EXPECT_EQ(volume_measure(neo_hookean(kYoung, -0.3)), VolumeMeasure::kJacobian);
  for (const double nu : {0.0, -0.3}) {
    EXPECT_EQ(volume_measure(linear(kYoung, nu)), VolumeMeasure::kNone);
    EXPECT_EQ(volume_measure(st_venant_kirchhoff(kYoung, nu)), VolumeMeasure::kNone);
    EXPECT_EQ(volume_modulus_pa(linear(kYoung, nu)), 0.0);
  }
}

TEST(Material, ResponseIsDistortionAndVolumeTermTogether) {
  const Material law = neo_hookean(kYoung, 0.45);
  const double K = volume_modulus_pa(law);
  EXPECT_NEAR(K, kYoung / (3 * (1 - 2 * 0.45)), 1e-9 * K);
  for (const Matrix3d& F : sample_deformations()) {
    const double theta = F.determinant() - 1.0;
    const LocalResponse whole = response(law, F);
    EXPECT_NEAR(whole.energy_density,
                distortion_energy(law, F) + 0.5 * K * theta * theta,
                1e-14 * whole.energy_density);
    const Matrix3d stress = distortion_response(law, F).stress +
                            K * theta * F.determinant() * F.inverse().transpose();
    EXPECT_LE((whole.stress - stress).norm(), 1e-13 * whole.tangent.norm());
  }
}

TEST(Linear, ObeysTheLaws) {
  for (const double nu : {-0.9, -0.3, 0.0, 0.3, 0.45, 0.4999}) {
    const Material law = linear(kYoung, nu);
    expect_zero_stress_at_rest(law);
    expect_stress_is_the_gradient_of_energy(law);
    expect_tangent_is_the_gradient_of_stress(law);
    expect_blind_to_small_rotation(law);
    expect_isotropic_under_both_rotations(law);
    EXPECT_TRUE(is_linear(law));
  }
}

TEST(Linear, UniaxialStressIsYoungsModulusTimesStrain) {
  for (const double nu : {-0.9, -0.3, 0.0, 0.3, 0.45, 0.4999}) {
    const Material law = linear(kYoung, nu);
    // Rounding of the volume term, K/E = 1/(3 (1 - 2 nu)) times that of E.
    const double rounding = 1e-13 * (1.0 + 1.0 / (1.0 - 2.0 * nu));
    EXPECT_NEAR(uniaxial_stress_pa(law, 1.1), 0.1 * kYoung, kYoung * rounding);
    EXPECT_NEAR(lateral_contraction(law), nu, 10 * rounding);
    EXPECT_NEAR(small_youngs_modulus_pa(law), kYoung, 1e-12 * kYoung);
  }
}

TEST(StVenantKirchhoff, ObeysTheLaws) {
  for (const double nu : {-0.9, -0.3, 0.0, 0.3, 0.4999}) {
    const Material law = st_venant_kirchhoff(kYoung, nu);
    expect_hyperelastic(law);
    expect_isotropic(law);
    expect_small_strain_limit(law, linear(kYoung, nu));
  }
}

TEST(StVenantKirchhoff, ConfinedStretchIsTheClosedForm) {
  for (const double nu : {-0.3, 0.3}) {
    const double modulus = kYoung * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    for (const double stretch : {0.7, 1.4}) {
      const Matrix3d F = Eigen::Vector3d(stretch, 1.0, 1.0).asDiagonal();
      const double stress = 0.5 * modulus * stretch * (stretch * stretch - 1.0);
      EXPECT_NEAR(response(st_venant_kirchhoff(kYoung, nu), F).stress(0, 0), stress,
                  1e-13 * modulus);
    }
  }
}

TEST(NeoHookean, ObeysTheLaws) {
  for (const double nu : {-0.9, 0.0, 0.45, 0.4999}) {
    const Material law = neo_hookean(kYoung, nu);
    expect_hyperelastic(law);
    expect_isotropic(law);
    expect_small_strain_limit(law, linear(kYoung, nu));
    expect_infinite_energy_without_volume(law);
  }
}

TEST(MooneyRivlin, ObeysTheLaws) {
  for (const double nu : {-0.9, 0.0, 0.45, 0.4999}) {
    const double sum_pa = kYoung / (4.0 * (1.0 + nu));
    for (const double share : {0.0, 0.3, 1.0, 1.2}) {  // the last: c01 < 0
      const Material law = mooney_rivlin(share * sum_pa, (1 - share) * sum_pa, nu);
      expect_hyperelastic(law);
      expect_isotropic(law);
      expect_small_strain_limit(law, linear(kYoung, nu));
      expect_infinite_energy_without_volume(law);
    }
  }
}

TEST(Ogden, ObeysTheLaws) {
  // Rubber (Ogden 1972, Treloar's data) and a strongly stiffening tissue.
  const Material rubber =
      ogden(std::array{6.3e5, 1.2e3, -1e4}, std::array{1.3, 5.0, -2.0}, 0.49);
  const Material tissue = ogden(std::array{60.0, -150.0}, std::array{12.0, -9.0}, 0.45);
  for (const Material& law : {rubber, tissue}) {
    expect_hyperelastic(law);
    expect_isotropic(law);
    expect_infinite_energy_without_volume(law);
  }
  const double shear_pa = 0.5 * (6.3e5 * 1.3 + 1.2e3 * 5.0 + 1e4 * 2.0);
  expect_small_strain_limit(rubber, linear(2.0 * shear_pa * 1.49, 0.49));
}

void expect_same_law(const Material& law, const Material& other) {
  for (const Matrix3d& F : sample_deformations()) {
    const LocalResponse a = response(law, F);
    const LocalResponse b = response(other, F);
    const double size = b.tangent.norm();
    ASSERT_NEAR(a.energy_density, b.energy_density, 1e-14 * size);
    ASSERT_LE((a.stress - b.stress).norm(), 1e-14 * size);
    ASSERT_LE((a.tangent - b.tangent).norm(), 1e-13 * size) << F;
  }
}

TEST(Ogden, WithExponentTwoIsNeoHookean) {
  const double mu = kYoung / (2 * 1.4);
  expect_same_law(ogden(std::array{mu}, std::array{2.0}, 0.4),
                  neo_hookean(kYoung, 0.4));
  expect_same_law(ogden(std::array{0.1 * mu, 0.2 * mu, 0.3 * mu, 0.4 * mu},
                        std::array{2.0, 2.0, 2.0, 2.0}, 0.4),
                  neo_hookean(kYoung, 0.4));
}

TEST(Ogden, WithExponentsTwoAndMinusTwoIsMooneyRivlin) {
  expect_same_law(ogden(std::array{2 * 700.0, -2 * 300.0}, std::array{2.0, -2.0}, 0.4),
                  mooney_rivlin(700.0, 300.0, 0.4));
}

TEST(MooneyRivlin, WithoutSecondConstantIsNeoHookean) {
  expect_same_law(mooney_rivlin(kYoung / (4 * 1.4), 0.0, 0.4),
                  neo_hookean(kYoung, 0.4));
}

TEST(Hyperelastic, SimpleShearIsTheClosedForm) {
  for (const double shear : {0.1, 1.0, 3.0}) {
    Matrix3d F = Matrix3d::Identity();
    F(0, 1) = shear;
    const Material neo = neo_hookean(3000.0, 0.45);
    EXPECT_NEAR(response(neo, F).stress(0, 1), small_shear_modulus_pa(neo) * shear,
                1e-9);
    EXPECT_NEAR(response(mooney_rivlin(700.0, 300.0, 0.45), F).stress(0, 1),
                2000.0 * shear, 1e-9);
  }
}

TEST(Hyperelastic, UniformSwellingMeetsTheBulkModulusAlone) {
  const std::array<Material, 3> laws{
      neo_hookean(3000.0, 0.3), mooney_rivlin(700.0, 300.0, 0.3),
      ogden(std::array{100.0, -200.0}, std::array{8.0, -3.0}, 0.3)};
  for (const Material& law : laws) {
    for (const double stretch : {0.5, 1.5}) {
      const double J = stretch * stretch * stretch;
      const double stress = volume_modulus_pa(law) * (J - 1.0) * stretch * stretch;
      const LocalResponse local = response(law, stretch * Matrix3d::Identity());
      EXPECT_LE((local.stress - stress * Matrix3d::Identity()).norm(),
                1e-13 * local.tangent.norm());
    }
  }
}

// The nominal stress departs from the incompressible closed form by about mu/K of it:
// mu/K = 2e-4 at nu = 0.4999, and ten times less at 0.49999.
void expect_uniaxial_limit(const std::function<Material(double)>& law_of_poisson,
                           const std::function<double(double)>& closed_form_pa) {
  for (const double stretch : {0.5, 0.8, 1.25, 2.0}) {
    const double limit_pa = closed_form_pa(stretch);
    const double far = uniaxial_stress_pa(law_of_poisson(0.4999), stretch) - limit_pa;
    const double near = uniaxial_stress_pa(law_of_poisson(0.49999), stretch) - limit_pa;
    EXPECT_LE(std::abs(far), 2e-3 * std::abs(limit_pa)) << stretch;
    EXPECT_NEAR(near / far, 0.1, 0.01) << stretch;
  }
}

TEST(NeoHookean, UniaxialStressTendsToTheIncompressibleClosedForm) {
  expect_uniaxial_limit(
      [](double nu) {
        return neo_hookean(2000.0 * (1 + nu), nu);
      },
      [](double l) {
        return 1000.0 * (l - 1 / (l * l));
      });
}

TEST(MooneyRivlin, UniaxialStressTendsToTheIncompressibleClosedForm) {
  expect_uniaxial_limit(
      [](double nu) {
        return mooney_rivlin(700.0, 300.0, nu);
      },
      [](double l) {
        return 2.0 * (700.0 + 300.0 / l) * (l - 1 / (l * l));
      });
}

TEST(Ogden, UniaxialStressTendsToTheIncompressibleClosedForm) {
  constexpr std::array<double, 2> kMu{400.0, -200.0};
  constexpr std::array<double, 2> kAlpha{5.0, -3.0};
  expect_uniaxial_limit(
      [&](double nu) {
        return ogden(kMu, kAlpha, nu);
      },
      [&](double l) {
        double stress = 0.0;
        for (std::size_t i = 0; i < 2; ++i) {
          stress +=
              kMu[i] * (std::pow(l, kAlpha[i] - 1) - std::pow(l, -kAlpha[i] / 2 - 1));
        }
        return stress;
      });
}

}  // namespace
}  // namespace palpate
