#include "precompute/fem/quadratic_element.h"

#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

using TetCorners = Eigen::Matrix<double, 4, 3>;

TetCorners oblique_corners() {
  TetCorners corners;
  corners << 0.0, 0.0, 0.0, 2.0, 0.3, -0.1, 0.2, 1.5, 0.4, -0.3, 0.5, 1.8;
  return 1e-2 * corners;
}

// Corners, then the middles of edges.
Eigen::Matrix<double, 10, 3> ten_nodes() {
  const TetCorners corners = oblique_corners();
  Eigen::Matrix<double, 10, 3> nodes;
  nodes.topRows<4>() = corners;
  for (Eigen::Index e = 0; e < 6; ++e) {
    const auto [i, j] = kTetEdges[static_cast<std::size_t>(e)];
    nodes.row(4 + e) = 0.5 * (corners.row(i) + corners.row(j));
  }
  return nodes;
}

// u = G X of every node.
ElementVector affine_field(const Eigen::Matrix3d& G) {
  ElementVector u;
  for (Eigen::Index j = 0; j < 10; ++j) {
    u.segment<3>(3 * j) = G * ten_nodes().row(j).transpose();
  }
  return u;
}

ElementVector field_by_chance(double size_m) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-size_m, size_m);
  ElementVector u;
  for (double& value : u) {
    value = unit(random);
  }
  return u;
}

std::vector<Material> element_laws() {
  return {linear(5000.0, 0.45), st_venant_kirchhoff(5000.0, 0.3),
          neo_hookean(5000.0, 0.49), mooney_rivlin(700.0, 300.0, 0.45)};
}

const ElementGeometry kElement = element_geometry(oblique_corners(), 0);

TEST(QuadraticElement, VolumeAndGradientsAreThoseOfItsPolynomials) {
  TetCorners unit = TetCorners::Zero();
  unit.bottomRows<3>().setIdentity();
  EXPECT_DOUBLE_EQ(element_geometry(unit, 0).volume_m3, 1.0 / 6.0);
  for (const auto& gradient : kElement.gradient) {
    // Of 1, and of every coordinate.
    EXPECT_NEAR(gradient.colwise().sum().norm(), 0.0, 1e-11);
    EXPECT_NEAR(
        (ten_nodes().transpose() * gradient - Eigen::Matrix3d::Identity()).norm(), 0.0,
        1e-13);
  }
}

// Of x^2 in the mean: 2 x at the centroid.
TEST(QuadraticElement, GradientsAreExactForQuadratics) {
  const Eigen::Matrix<double, 10, 1> squared = ten_nodes().col(0).array().square();
  Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
  for (const auto& gradient : kElement.gradient) {
    mean += 0.25 * squared.transpose() * gradient;
  }
  const double wanted = 2.0 * oblique_corners().col(0).mean();
  EXPECT_NEAR((mean - Eigen::RowVector3d(wanted, 0.0, 0.0)).norm(), 0.0, 1e-15);
}

TEST(QuadraticElement, ATetWithoutVolumeOrInsideOutIsRefused) {
  TetCorners turned = oblique_corners();
  turned.row(0).swap(turned.row(1));
  EXPECT_THROW((void)element_geometry(turned, 7), NumericalError);
  expect_says(refusal([&] {
                (void)element_geometry(turned, 7);
              }),
              "tetrahedron 7 has volume -");
  TetCorners flat = oblique_corners();
  flat.row(3) = 0.5 * (flat.row(1) + flat.row(2));
  flat.row(0).setZero();
  EXPECT_THROW((void)element_geometry(TetCorners::Zero(), 7), NumericalError);
}

// V (mu eps:eps + lambda/2 tr(eps)^2).
TEST(QuadraticElement, AConstantStrainHasTheLawsEnergy) {
  Eigen::Matrix3d G;
  G << 1e-3, 2e-3, 0.0, -1e-3, 3e-3, 5e-4, 0.0, 1e-3, -2e-3;
  const Eigen::Matrix3d strain = 0.5 * (G + G.transpose());
  const double youngs = 5000.0, poisson = 0.45;
  const double mu = youngs / (2.0 * (1.0 + poisson));
  const double lambda = 2.0 * mu * poisson / (1.0 - 2.0 * poisson);
  const double wanted =
      kElement.volume_m3 *
      (mu * strain.squaredNorm() + 0.5 * lambda * strain.trace() * strain.trace());
  const Material law = linear(youngs, poisson);
  EXPECT_NEAR(element_energy(kElement, law, affine_field(G)) / wanted, 1.0, 1e-12);
}

TEST(QuadraticElement, RigidMotionsCostNothing) {
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized())
          .toRotationMatrix();
  ElementVector u = affine_field(turned - Eigen::Matrix3d::Identity());
  u += Eigen::Vector3d(0.3, -0.2, 0.1).replicate<10, 1>();
  for (const Material& law : element_laws()) {
    if (std::holds_alternative<Linear>(law)) {
      continue;  // of small strains
    }
    const ElementLinearisation response = element_response(kElement, law, u);
    // Of 5000 Pa over about 1e-6 m^3 and 1e-4 m^2.
    EXPECT_NEAR(response.energy_j, 0.0, 1e-15);
    EXPECT_NEAR(response.force_n.norm(), 0.0, 1e-12);
  }
}

TEST(QuadraticElement, ForcesAreTheEnergysSlopesAndStiffnessTheirs) {
  const ElementVector u = field_by_chance(3e-4);
  constexpr double kStep = 1e-7;
  for (const Material& law : element_laws()) {
    const ElementLinearisation at = element_response(kElement, law, u);
    EXPECT_NEAR(at.energy_j / element_energy(kElement, law, u), 1.0, 1e-12);
    const double force = at.force_n.norm(), stiffness = at.stiffness.norm();
    for (Eigen::Index k = 0; k < 30; ++k) {
      const ElementVector step = kStep * ElementVector::Unit(k);
      const double slope = (element_energy(kElement, law, u + step) -
                            element_energy(kElement, law, u - step)) /
                           (2.0 * kStep);
      EXPECT_NEAR(at.force_n(k), slope, 1e-7 * force);
      const ElementVector change = (element_response(kElement, law, u + step).force_n -
                                    element_response(kElement, law, u - step).force_n) /
                                   (2.0 * kStep);
      EXPECT_NEAR((at.stiffness.col(k) - change).norm(), 0.0, 1e-7 * stiffness);
    }
    EXPECT_NEAR((at.stiffness - at.stiffness.transpose()).norm(), 0.0,
                1e-14 * stiffness);
    EXPECT_NEAR(at.force_n.reshaped(3, 10).rowwise().sum().norm(), 0.0, 1e-13 * force);
  }
}

TEST(QuadraticElement, AConvexStiffnessHasNoNegativeEigenvalues) {
  // Pressed together, where a tangent loses its definiteness.
  const ElementVector u =
      affine_field(-0.6 * Eigen::Vector3d(0.0, 0.0, 1.0).asDiagonal().toDenseMatrix());
  const Material law = st_venant_kirchhoff(5000.0, 0.3);
  const auto lowest = [&](bool convex) {
    const ElementMatrix K = element_response(kElement, law, u, convex).stiffness;
    return Eigen::SelfAdjointEigenSolver<ElementMatrix>(K).eigenvalues().minCoeff() /
           K.norm();
  };
  EXPECT_LT(lowest(false), -1e-3);
  EXPECT_GT(lowest(true), -1e-13);
  EXPECT_EQ(element_response(kElement, law, u, true).force_n,
            element_response(kElement, law, u, false).force_n);
}

TEST(QuadraticElement, InsideOutANeoHookeanElementIsNotAdmitted) {
  const ElementVector u =
      affine_field(-2.0 * Eigen::Vector3d(1.0, 0.0, 0.0).asDiagonal().toDenseMatrix());
  EXPECT_TRUE(std::isinf(element_energy(kElement, neo_hookean(5000.0, 0.4), u)));
  EXPECT_NEAR(smallest_jacobian(kElement, u), -1.0, 1e-12);
  EXPECT_NEAR(largest_gradient(kElement, u), 2.0, 1e-12);
}

TEST(QuadraticElement, TheWorstOfItsPointsCounts) {
  ElementVector u = ElementVector::Zero();
  u(3) = 2e-3;  // one corner alone
  double largest = 0.0, smallest = 9.0;
  for (const auto& gradient : kElement.gradient) {
    const Eigen::Matrix3d G = Eigen::Vector3d(2e-3, 0.0, 0.0) * gradient.row(1);
    largest = std::max(largest, G.norm());
    smallest = std::min(smallest, (Eigen::Matrix3d::Identity() + G).determinant());
  }
  EXPECT_NEAR(largest_gradient(kElement, u), largest, 1e-15);
  EXPECT_NEAR(smallest_jacobian(kElement, u), smallest, 1e-15);
}

TEST(QuadraticElement, NodalValuesAreOfTheTetsOwnNodes) {
  QuadraticMesh mesh;
  mesh.tet.resize(2, 10);
  mesh.tet << 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 3, 0, 10, 1, 9, 2, 8, 4, 7;
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(36, 0.0, 35.0);
  const ElementVector values = nodal_values(mesh, 1, u);
  for (Eigen::Index j = 0; j < 10; ++j) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(values(3 * j + axis), 3.0 * mesh.tet(1, j) + static_cast<double>(axis));
    }
  }
}

}  // namespace
}  // namespace palpate
