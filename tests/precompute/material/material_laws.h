// What every constitutive law must satisfy, written once; each law's test names the
// laws that apply to it.
//
// Deformations are drawn from a fixed seed. Derivative checks leave out the pressure of
// the volume term: the distortion would drown in a large bulk modulus. The volume
// measures have checks of their own.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "precompute/material/material.h"
#include "precompute/material/strain_invariants.h"

namespace palpate::material_laws {

using Eigen::Matrix3d;

inline Matrix3d random_tensor(std::mt19937_64& random) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  return Matrix3d::NullaryExpr([&] {
    return entry(random);
  });
}

inline Matrix3d random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> part;
  return Eigen::Quaterniond(part(random), part(random), part(random), part(random))
      .normalized()
      .toRotationMatrix();
}

/// Large and small strains, rotated, sheared, with equal and nearly equal stretches;
/// 0.3 <= det F.
inline std::vector<Matrix3d> sample_deformations() {
  std::mt19937_64 random(20240611);
  std::vector<Matrix3d> sample;
  for (const double size : {1e-6, 1e-3, 0.05, 0.3, 0.6}) {
    for (int drawn = 0; drawn < 20;) {
      const Matrix3d F = Matrix3d::Identity() + size * random_tensor(random);
      if (F.determinant() >= 0.3) {
        sample.push_back(drawn % 2 == 0 ? F : random_rotation(random) * F);
        ++drawn;
      }
    }
  }
  for (const double gap : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
    const Eigen::Vector3d two_equal(1.3 + gap, 1.3, 0.7);
    const Eigen::Vector3d all_equal(1.2, 1.2 - gap, 1.2 + gap);
    for (const Eigen::Vector3d& stretch : {two_equal, all_equal}) {
      sample.push_back(random_rotation(random) * stretch.asDiagonal() *
                       random_rotation(random));
    }
  }
  return sample;
}

inline void expect_zero_stress_at_rest(const Material& law) {
  const LocalResponse rest = response(law, Matrix3d::Identity());
  EXPECT_EQ(rest.energy_density, 0.0);
  // Rounding of the sums of nine entries.
  EXPECT_LE(rest.stress.cwiseAbs().maxCoeff(), 1e-15 * rest.tangent.norm());
}

// Central differences with step h = 1e-5. Truncation is h^2/6 times the third
// derivative, which is below 1e3 times the tangent's size for these laws and samples:
// 2e-8. Rounding is 1e-16/h = 1e-11. Entries are compared with the size of the whole
// tangent.
constexpr double kStep = 1e-5;
constexpr double kDifferenceTolerance = 2e-8;

inline void expect_stress_is_the_gradient_of_energy(
    const Material& law, const std::vector<Matrix3d>& sample = sample_deformations()) {
  for (const Matrix3d& F : sample) {
    const LocalResponse local = distortion_response(law, F);
    ASSERT_NEAR(local.energy_density, distortion_energy(law, F),
                1e-14 * local.energy_density + 1e-16 * local.tangent.norm());
    for (int i = 0; i < 9; ++i) {
      Matrix3d above = F;
      Matrix3d below = F;
      above.data()[i] += kStep;
      below.data()[i] -= kStep;
      const double slope =
          (distortion_energy(law, above) - distortion_energy(law, below)) / (2 * kStep);
      ASSERT_NEAR(local.stress.data()[i], slope,
                  kDifferenceTolerance * local.tangent.norm())
          << "entry " << i << " at F =\n"
          << F;
    }
  }
}

inline void expect_tangent_is_the_gradient_of_stress(
    const Material& law, const std::vector<Matrix3d>& sample = sample_deformations()) {
  for (const Matrix3d& F : sample) {
    const Tangent tangent = distortion_response(law, F).tangent;
    ASSERT_LE((tangent - tangent.transpose()).norm(), 1e-14 * tangent.norm());
    for (int i = 0; i < 9; ++i) {
      Matrix3d above = F;
      Matrix3d below = F;
      above.data()[i] += kStep;
      below.data()[i] -= kStep;
      const Matrix3d slope = (distortion_response(law, above).stress -
                              distortion_response(law, below).stress) /
                             (2 * kStep);
      ASSERT_LE((tangent.col(i) - as_vector(slope)).norm(),
                kDifferenceTolerance * tangent.norm())
          << "column " << i << " at F =\n"
          << F;
    }
  }
}

// Psi(A F B) = Psi(F) and P(A F B) = A P(F) B for rotations A, B. Rounding: some twenty
// operations on entries of the tangent's size.
inline void expect_same_up_to_rotation(const Material& law, const Matrix3d& F,
                                       const Matrix3d& A, const Matrix3d& B) {
  const LocalResponse before = distortion_response(law, F);
  const LocalResponse after = distortion_response(law, A * F * B);
  const double size = before.tangent.norm();
  ASSERT_NEAR(after.energy_density, before.energy_density, 1e-14 * size);
  ASSERT_LE((after.stress - A * before.stress * B).norm(), 1e-13 * size) << F;
}

inline void expect_objective(const Material& law) {
  std::mt19937_64 random(7);
  for (const Matrix3d& F : sample_deformations()) {
    expect_same_up_to_rotation(law, F, random_rotation(random), Matrix3d::Identity());
  }
}

/// For laws linear in F: an infinitesimal rotation stores nothing.
inline void expect_blind_to_small_rotation(const Material& law) {
  std::mt19937_64 random(7);
  for (const Matrix3d& F : sample_deformations()) {
    const Matrix3d A = random_tensor(random);
    const LocalResponse before = response(law, F);
    const LocalResponse after = response(law, F + A - A.transpose());
    const double size = before.tangent.norm();
    ASSERT_NEAR(after.energy_density, before.energy_density, 1e-14 * size);
    ASSERT_LE((after.stress - before.stress).norm(), 1e-14 * size);
  }
}

/// For finite-strain laws.
inline void expect_isotropic(const Material& law) {
  std::mt19937_64 random(11);
  for (const Matrix3d& F : sample_deformations()) {
    expect_same_up_to_rotation(law, F, Matrix3d::Identity(), random_rotation(random));
  }
}

/// For laws linear in F: Psi(QFQ') = Psi(F).
inline void expect_isotropic_under_both_rotations(const Material& law) {
  std::mt19937_64 random(11);
  for (const Matrix3d& F : sample_deformations()) {
    const Matrix3d Q = random_rotation(random);
    expect_same_up_to_rotation(law, F, Q, Q.transpose());
  }
}

inline void expect_symmetric_about(const Eigen::Vector3d& fibre, const Material& law) {
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> angle(0.0, 6.28);
  for (const Matrix3d& F : sample_deformations()) {
    const Matrix3d Q =
        Eigen::AngleAxisd(angle(random), fibre.normalized()).toRotationMatrix();
    const Matrix3d left =
        is_linear(law) ? Matrix3d(Q.transpose()) : Matrix3d(Matrix3d::Identity());
    expect_same_up_to_rotation(law, F, left, Q);
  }
}

/// The tangent at rest is the linear law's of the same constants.
inline void expect_small_strain_limit(const Material& law, const Material& linear_law) {
  const Tangent at_rest = response(law, Matrix3d::Identity()).tangent;
  const Tangent expected = response(linear_law, Matrix3d::Identity()).tangent;
  EXPECT_LE((at_rest - expected).norm(), 1e-14 * expected.norm());
  EXPECT_NEAR(small_shear_modulus_pa(law), small_shear_modulus_pa(linear_law),
              1e-12 * small_shear_modulus_pa(linear_law));
  EXPECT_NEAR(small_youngs_modulus_pa(law), small_youngs_modulus_pa(linear_law),
              1e-12 * small_youngs_modulus_pa(linear_law));
}

/// Psi(1 + e H) = e^2/2 H:A:H (1 + O(e)), A the tangent there, down to e = 1e-7. There
/// an energy formed as a difference of numbers of size 1 would be off by 1e-16/e^2, 1
/// %.
inline void expect_energy_keeps_its_digits_at_small_strain(const Material& law) {
  std::mt19937_64 random(17);
  for (int drawn = 0; drawn < 20; ++drawn) {
    const Matrix3d H = random_tensor(random);
    for (const double e : {1e-4, 1e-5, 1e-6, 1e-7}) {
      const Matrix3d F = Matrix3d::Identity() + e * H;
      const double energy = distortion_energy(law, F);
      const Tangent tangent = distortion_response(law, F).tangent;
      const double expected = 0.5 * as_vector(H).dot(tangent * as_vector(H));
      // Third derivative below 30 tangents; rounding of F itself 1e-16/e.
      EXPECT_NEAR(energy / (e * e), expected, (30 * e + 4e-15 / e) * tangent.norm());
    }
  }
}

inline void expect_infinite_energy_without_volume(const Material& law) {
  const Matrix3d mirrored = Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
  const Matrix3d flat = Eigen::Vector3d(1.0, 0.0, 1.0).asDiagonal();
  for (const Matrix3d& F : {mirrored, flat, Matrix3d(-Matrix3d::Identity()),
                            Matrix3d(Matrix3d::Zero()), Matrix3d(1e-160 * mirrored)}) {
    EXPECT_EQ(distortion_energy(law, F), INFINITY);
    EXPECT_EQ(distortion_response(law, F).energy_density, INFINITY);
    EXPECT_TRUE(std::isnan(distortion_response(law, F).stress.sum()));
  }
  for (const double size : {1e-150, 1e-100, 1e100, 1e150}) {
    const Matrix3d F = size * Matrix3d(Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal());
    EXPECT_FALSE(std::isnan(distortion_energy(law, F))) << size;
  }
}

/// What finite-strain laws of any symmetry share. @param smooth where differences
/// across the step do not meet a jump of the tangent.
inline void expect_hyperelastic(
    const Material& law, const std::vector<Matrix3d>& smooth = sample_deformations()) {
  expect_zero_stress_at_rest(law);
  expect_stress_is_the_gradient_of_energy(law, smooth);
  expect_tangent_is_the_gradient_of_stress(law, smooth);
  expect_objective(law);
  expect_energy_keeps_its_digits_at_small_strain(law);
  EXPECT_FALSE(is_linear(law));
}

/// Stretch along x with free sides: nominal stress P11. For isotropic laws.
inline double uniaxial_stress_pa(const Material& law, double stretch) {
  double side = 1.0 / std::sqrt(stretch);
  LocalResponse local;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Matrix3d F = Eigen::Vector3d(stretch, side, side).asDiagonal();
    local = response(law, F);
    const double step =
        local.stress(1, 1) / (local.tangent(4, 4) + local.tangent(4, 8));
    side -= step;
    if (std::abs(step) < 1e-15) {
      break;
    }
  }
  return local.stress(0, 0);
}

}  // namespace palpate::material_laws
