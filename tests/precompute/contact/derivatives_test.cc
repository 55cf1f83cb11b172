// Forces are the gradients of energies, and stiffnesses of forces: of an element of
// every law, of the near field and of the contact, by central differences.
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <tuple>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "precompute/contact/contact_gap.h"
#include "precompute/contact/contact_potential.h"
#include "precompute/contact/near_field.h"
#include "precompute/fem/linear_elasticity.h"
#include "tests/support/box_tets.h"
#include "tests/support/every_law.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kTetEdge = 0.01;
constexpr double kStep = 1e-5 * kTetEdge;

double largest(const Eigen::MatrixXd& m) {
  return m.cwiseAbs().maxCoeff();
}

ElementGeometry tet() {
  Eigen::Matrix<double, 4, 3> corner;
  corner << 0, 0, 0, kTetEdge, 0, 0, 0.2 * kTetEdge, 0.9 * kTetEdge, 0, 0.1 * kTetEdge,
      0.3 * kTetEdge, kTetEdge;
  return element_geometry(corner, 0);
}

// u = stretch x e_x at the ten nodes: corners, then edges 01 12 02 03 13 23.
ElementVector pulled_along_x(double stretch) {
  const std::array<double, 4> x{0.0, kTetEdge, 0.2 * kTetEdge, 0.1 * kTetEdge};
  constexpr std::array<std::array<std::size_t, 2>, 6> kEnds{
      {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};
  ElementVector u = ElementVector::Zero();
  for (std::size_t a = 0; a < 4; ++a) {
    u[static_cast<Eigen::Index>(3 * a)] = stretch * x[a];
  }
  for (std::size_t e = 0; e < 6; ++e) {
    u[static_cast<Eigen::Index>(3 * (4 + e))] =
        0.5 * stretch * (x[kEnds[e][0]] + x[kEnds[e][1]]);
  }
  return u;
}

// Displacements of a share of the edge, each time the same.
Eigen::VectorXd random_vector(Eigen::Index n, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> entry(-size, size);
  return Eigen::VectorXd::NullaryExpr(n, [&] {
    return entry(random);
  });
}

class ElementOfLaw : public testing::TestWithParam<NamedLaw> {};
INSTANTIATE_TEST_SUITE_P(Laws, ElementOfLaw, testing::ValuesIn(every_law()),
                         [](const auto& law) {
                           return law.param.name;
                         });

TEST_P(ElementOfLaw, ForceAndStiffnessAreDerivativesOfTheEnergy) {
  const ElementGeometry geometry = tet();
  const Material& law = GetParam().law;
  for (const double share : {0.005, 0.05}) {
    // Pulled along x as well, so that fibres there are engaged at every point.
    ElementVector u =
        pulled_along_x(5.0 * share) + random_vector(30, share * kTetEdge, 7);
    const ElementLinearisation at = element_response(geometry, law, u);
    EXPECT_NEAR(at.energy_j, element_energy(geometry, law, u), 1e-12 * at.energy_j);
    ElementVector force;
    ElementMatrix stiffness;
    for (Eigen::Index i = 0; i < 30; ++i) {
      ElementVector up = u;
      ElementVector down = u;
      up[i] += kStep;
      down[i] -= kStep;
      force[i] =
          (element_energy(geometry, law, up) - element_energy(geometry, law, down)) /
          (2.0 * kStep);
      stiffness.col(i) = (element_response(geometry, law, up).force_n -
                          element_response(geometry, law, down).force_n) /
                         (2.0 * kStep);
    }
    EXPECT_LT(largest(force - at.force_n), 1e-5 * largest(at.force_n)) << share;
    EXPECT_LT(largest(stiffness - at.stiffness), 1e-6 * largest(at.stiffness)) << share;
    EXPECT_LT(largest(at.stiffness - at.stiffness.transpose()),
              1e-12 * largest(at.stiffness));
    const ElementMatrix convex = element_response(geometry, law, u, true).stiffness;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<ElementMatrix>(convex).eigenvalues()[0],
              -1e-9 * largest(convex));
  }
}

// A block on a floor, half of it near; its contact nodes are those of the top.
struct SmallBlock {
  explicit SmallBlock(const Material& material) : law{material} {
    const std::vector<double> x{-kTetEdge, 0.0, kTetEdge};
    const BoxTets box = box_tets(x, x, {-kTetEdge, -0.5 * kTetEdge, 0.0});
    mesh = make_quadratic(box.tets, box.surface);
    const Eigen::AlignedBox3d floor(Eigen::Vector3d::Constant(-1),
                                    Eigen::Vector3d(1, 1, -kTetEdge + 1e-9));
    supports = hold_boxes(mesh, std::span(&floor, 1));
    surface = make_contact_surface(mesh);
    std::vector<std::int32_t> nodes;
    for (std::size_t v = 0; v < surface.node.size(); ++v) {
      if (surface.node[v].normal.z() > 0.9) {
        patch.push_back(static_cast<std::int32_t>(v));
        for (const NodalForce& entry : surface.node[v].load) {
          nodes.push_back(entry.node);
        }
      }
    }
    std::vector<Eigen::Index> tets(static_cast<std::size_t>(mesh.tet.rows()) / 2);
    std::iota(tets.begin(), tets.end(), Eigen::Index{0});
    near = std::make_unique<NearField>(mesh, law, supports, tets, nodes);
  }
  SmallBlock(const SmallBlock&) = delete;
  SmallBlock& operator=(const SmallBlock&) = delete;

  Eigen::VectorXd free_vector(double size, unsigned seed) const {
    Eigen::VectorXd v = random_vector(near->size(), size, seed);
    near->mask(v);
    return v;
  }

  std::array<Material, 1> law;
  QuadraticMesh mesh;
  Supports supports;
  ContactSurface surface;
  std::vector<std::int32_t> patch;
  std::unique_ptr<NearField> near;
};

// The change of f along d, over its length.
template <typename Function>
auto slope(const Function& f, const Eigen::VectorXd& u, const Eigen::VectorXd& d)
    -> decltype(f(u)) {
  return (f(u + kStep * d) - f(u - kStep * d)) / (2.0 * kStep);
}

class NearFieldOfLaw : public testing::TestWithParam<NamedLaw> {};
INSTANTIATE_TEST_SUITE_P(Laws, NearFieldOfLaw, testing::ValuesIn(every_law()),
                         [](const auto& law) {
                           return law.param.name;
                         });

TEST_P(NearFieldOfLaw, ForceAndChangeAreDerivativesOfTheExcess) {
  const SmallBlock block(GetParam().law);
  NearField& near = *block.near;
  const Eigen::VectorXd u = block.free_vector(0.01 * kTetEdge, 3);
  const auto force = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(near.size());
    near.linearise(at, f, false);
    return f;
  };
  const Eigen::VectorXd gradient = force(u);
  if (is_linear(GetParam().law)) {
    EXPECT_EQ(gradient.norm(), 0.0);  // nothing beyond the rest stiffness
    return;
  }
  for (const unsigned seed : {11U, 12U, 13U}) {
    const Eigen::VectorXd d = block.free_vector(1.0, seed);
    const double found = slope(
        [&](const Eigen::VectorXd& at) {
          return near.excess(at).energy_j;
        },
        u, d);
    EXPECT_NEAR(found, gradient.dot(d), 1e-5 * gradient.norm() * d.norm());
    const Eigen::VectorXd differences = slope(force, u, d);
    (void)force(u);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(near.size());
    near.add_change(d, change);
    EXPECT_LT((differences - change).norm(), 1e-4 * change.norm());
  }
}

// The contact's potential does not know of laws.
class ContactDerivatives
    : public testing::TestWithParam<std::tuple<ToolShape, double>> {};
INSTANTIATE_TEST_SUITE_P(Tools, ContactDerivatives,
                         testing::Combine(testing::Values(sphere(1.3 * kTetEdge),
                                                          capsule(kTetEdge, kTetEdge),
                                                          cone(1.1, 0.4 * kTetEdge)),
                                          testing::Values(0.0, 0.7)));

TEST_P(ContactDerivatives, ForceIsTheGradientAndCurvatureItsDerivative) {
  const SmallBlock block(neo_hookean(5e3, 0.45));
  const ToolSurface tool{std::get<0>(GetParam())};
  const PlacedTool placed = place_on_path(tool, Eigen::Vector3d::Zero(),
                                          Eigen::Vector3d::UnitZ(), 0.15 * kTetEdge);
  ContactPotential contact(block.surface, block.mesh, block.patch, *block.near);
  const Eigen::Index n = contact.nodes();
  const Multipliers multipliers{
      .pressure_n = 1e-3 * random_vector(n, 1.0, 5).cwiseAbs(),
      .spring_n_per_m = Eigen::VectorXd::Constant(n, 20.0),
      .point_share = std::get<1>(GetParam()),
      .tie_n = Eigen::MatrixX3d::Zero(n, 3),
      .anchor_m = Eigen::MatrixX3d::Zero(n, 3),
      .tied = {}};
  const Eigen::VectorXd u = block.free_vector(0.01 * kTetEdge, 3);
  const auto force = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(block.near->size());
    contact.linearise(at, placed, multipliers, f);
    return f;
  };
  const Eigen::VectorXd gradient = force(u);
  ASSERT_GT(gradient.norm(), 0.0);
  for (const unsigned seed : {21U, 22U, 23U}) {
    const Eigen::VectorXd d = block.free_vector(1.0, seed);
    const double found = slope(
        [&](const Eigen::VectorXd& at) {
          return contact.evaluate(at, placed, multipliers).energy_j;
        },
        u, d);
    EXPECT_NEAR(found, gradient.dot(d), 1e-5 * gradient.norm() * d.norm());
    const Eigen::VectorXd differences = slope(force, u, d);
    (void)force(u);
    Eigen::VectorXd curvature = Eigen::VectorXd::Zero(block.near->size());
    contact.add_curvature(d, curvature);
    EXPECT_LT((differences - curvature).norm(), 1e-3 * curvature.norm());
  }
  // What bears on the tool is what bears on the body.
  const ContactState state = contact.evaluate(u, placed, multipliers);
  Eigen::Vector3d on_body = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < gradient.size(); i += 3) {
    on_body += gradient.segment<3>(i);
  }
  EXPECT_LT((on_body - state.force_n).norm(), 1e-9 * state.force_n.norm());
}

}  // namespace
}  // namespace palpate
