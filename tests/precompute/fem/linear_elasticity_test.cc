#include "precompute/fem/linear_elasticity.h"

#include <array>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/cholesky_factor.h"
#include "tests/support/box_tets.h"

namespace palpate {
namespace {

constexpr double kYoung = 5000.0;
constexpr double kPoisson = 0.3;
const std::array<Material, 1> kGel{linear(kYoung, kPoisson)};

// A skewed block, so that no element is special.
QuadraticMesh skewed_block() {
  BoxTets box = box_tets({0.0, 0.3, 1.0, 1.4}, {0.0, 0.5, 0.9}, {0.0, 0.2, 0.7, 1.0});
  for (Eigen::Index v = 0; v < box.tets.position_m.rows(); ++v) {
    const Eigen::Vector3d p = box.tets.position_m.row(v).transpose();
    box.tets.position_m.row(v) << p.x() + 0.2 * p.y(), p.y() - 0.1 * p.z(),
        p.z() + 0.15 * p.x();
  }
  return make_quadratic(box.tets, box.surface);
}

Eigen::VectorXd linear_field(const QuadraticMesh& mesh, const Eigen::Matrix3d& gradient,
                             const Eigen::Vector3d& shift) {
  Eigen::VectorXd u(3 * mesh.position_m.rows());
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    u.segment<3>(3 * v) = gradient * mesh.position_m.row(v).transpose() + shift;
  }
  return u;
}

Eigen::VectorXd apply(const Stiffness& lower, const Eigen::VectorXd& u) {
  return lower.selfadjointView<Eigen::Lower>() * u;
}

TEST(LinearElasticity, RigidMotionsCostNothing) {
  const QuadraticMesh mesh = skewed_block();
  const Stiffness K = assemble_stiffness(mesh, kGel);
  Eigen::Matrix3d spin;
  spin << 0, -0.3, 0.7, 0.3, 0, -0.2, -0.7, 0.2, 0;
  const Eigen::VectorXd motion = linear_field(mesh, spin, {0.4, -1.0, 2.0});
  // Rounding of sums of terms of the size of the largest entry of K.
  const double scale = K.coeffs().cwiseAbs().maxCoeff() * motion.cwiseAbs().maxCoeff();
  EXPECT_LT(apply(K, motion).cwiseAbs().maxCoeff(), 1e-12 * scale);
}

TEST(LinearElasticity, EnergyOfAConstantStrainIsTheClosedForm) {
  const QuadraticMesh mesh = skewed_block();
  const Stiffness K = assemble_stiffness(mesh, kGel);
  Eigen::Matrix3d H;
  H << 0.01, 0.02, -0.005, 0.003, -0.02, 0.01, 0.0, 0.007, 0.015;
  const Eigen::Matrix3d strain = 0.5 * (H + H.transpose());
  const double E = kYoung;
  const double nu = kPoisson;
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  const double G = E / (2 * (1 + nu));
  double volume = 0.0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    Eigen::Matrix3d edges;
    for (int j = 0; j < 3; ++j) {
      edges.col(j) = (mesh.position_m.row(mesh.tet(t, j + 1)) -
                      mesh.position_m.row(mesh.tet(t, 0)))
                         .transpose();
    }
    volume += edges.determinant() / 6.0;
  }
  const double expected = volume * (0.5 * lambda * strain.trace() * strain.trace() +
                                    G * strain.squaredNorm());
  const Eigen::VectorXd u = linear_field(mesh, H, Eigen::Vector3d::Zero());
  EXPECT_NEAR(0.5 * u.dot(apply(K, u)), expected, 1e-12 * expected);
}

// Displacements of a constant strain on the whole surface: inside, the same field
// solves.
TEST(LinearElasticity, PatchTest) {
  const QuadraticMesh mesh = skewed_block();
  const Stiffness K = assemble_stiffness(mesh, kGel);
  Eigen::Matrix3d H;
  H << 0.01, 0.02, -0.005, 0.003, -0.02, 0.01, 0.0, 0.007, 0.015;
  const Eigen::VectorXd exact = linear_field(mesh, H, {0.1, 0.2, -0.3});
  const Eigen::AlignedBox3d everything(Eigen::Vector3d::Constant(-9),
                                       Eigen::Vector3d::Constant(9));
  const Supports supports = hold_boxes(mesh, std::span(&everything, 1));
  ASSERT_GT(supports.free, 0);
  Eigen::VectorXd held = exact;
  for (Eigen::Index i = 0; i < held.size(); ++i) {
    if (supports.free_index[static_cast<std::size_t>(i)] >= 0) {
      held[i] = 0.0;
    }
  }
  const Eigen::VectorXd reaction = apply(K, held);
  Eigen::MatrixXd b(supports.free, 1);
  for (Eigen::Index i = 0; i < held.size(); ++i) {
    if (supports.free_index[static_cast<std::size_t>(i)] >= 0) {
      b(supports.free_index[static_cast<std::size_t>(i)], 0) = -reaction[i];
    }
  }
  const Eigen::MatrixXd u = CholeskyFactor(reduce(K, supports)).solve(b);
  for (Eigen::Index i = 0; i < held.size(); ++i) {
    const std::int64_t at = supports.free_index[static_cast<std::size_t>(i)];
    if (at >= 0) {
      EXPECT_NEAR(u(at, 0), exact[i], 1e-10);
    }
  }
}

TEST(LinearElasticity, AnUnsupportedBodyIsRefusedAsSingular) {
  const QuadraticMesh mesh = skewed_block();
  EXPECT_THROW(CholeskyFactor{assemble_stiffness(mesh, kGel)}, NumericalError);
}

TEST(LinearElasticity, ABodyHeldAlongALineIsRefusedAsSingular) {
  const QuadraticMesh mesh = skewed_block();
  const Eigen::AlignedBox3d edge(Eigen::Vector3d(-9, -9, -9),
                                 Eigen::Vector3d(9, 9, 0.01));
  const Supports supports = hold_boxes(mesh, std::span(&edge, 1));
  EXPECT_THROW(CholeskyFactor{reduce(assemble_stiffness(mesh, kGel), supports)},
               NumericalError);
}

TEST(LinearElasticity, StiffnessOfMaterialsFromOnePascalToATerapascalIsFactorised) {
  const QuadraticMesh mesh = skewed_block();
  const Eigen::AlignedBox3d floor(Eigen::Vector3d(-9, -9, -9),
                                  Eigen::Vector3d(9, 9, 0.16));
  const Supports supports = hold_boxes(mesh, std::span(&floor, 1));
  for (const double E : {1.0, 1e12}) {
    for (const double nu : {-0.9, 0.0, 0.4999}) {
      const CholeskyFactor factor(reduce(
          assemble_stiffness(mesh, std::array<Material, 1>{linear(E, nu)}), supports));
      const Eigen::MatrixXd u = factor.solve(Eigen::MatrixXd::Ones(supports.free, 1));
      EXPECT_TRUE(u.allFinite()) << "E " << E << " nu " << nu;
    }
  }
}

TEST(LinearElasticity, AnInvertedTetIsNamed) {
  BoxTets box = box_tets({0, 1}, {0, 1}, {0, 1});
  std::swap(box.tets.tet(2, 0), box.tets.tet(2, 1));
  const QuadraticMesh mesh = make_quadratic(box.tets, box.surface);
  try {
    (void)assemble_stiffness(mesh, kGel);
    FAIL() << "accepted an inverted tetrahedron";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("tetrahedron 2 has volume"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace palpate
