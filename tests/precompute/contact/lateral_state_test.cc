// The lateral stiffness by a strained body's tangent; the linear one against closed
// forms is in patch_state_test.cc.
#include "precompute/contact/lateral_state.h"

#include <memory>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "precompute/contact/equilibrium.h"
#include "precompute/contact/tangent_factor.h"
#include "tests/precompute/contact/soft_block.h"

namespace palpate {
namespace {

constexpr double kSunkM = 0.003;

// A ball in a block of which every tet is near.
class StrainedBlock : public testing::Test {
 protected:
  StrainedBlock() {
    std::vector<Eigen::Index> tets(static_cast<std::size_t>(block_.mesh.tet.rows()));
    std::iota(tets.begin(), tets.end(), 0);
    near_ =
        std::make_unique<NearField>(block_.mesh, block_.material, block_.supports, tets,
                                    contact_mesh_nodes(block_.surface, block_.patch));
    const auto n = static_cast<Eigen::Index>(block_.patch.size());
    multipliers_ = {.pressure_n = Eigen::VectorXd::Zero(n),
                    .spring_n_per_m = Eigen::VectorXd::Constant(n, 20.0),
                    .tie_n = Eigen::MatrixX3d::Zero(n, 3),
                    .anchor_m = Eigen::MatrixX3d::Zero(n, 3),
                    .tied = {}};
    rest_ = {Eigen::VectorXd::Zero(near_->size()),
             Eigen::VectorXd::Zero(near_->size())};
    pressed_ = rest_;
    ContactPotential contact(block_.surface, block_.mesh, block_.patch, *near_);
    Equilibrium equilibrium(*near_, contact, block_.solve, {});
    const EquilibriumReport report = equilibrium.find(
        place_on_path(*block_.ball, path_.vertex_m, path_.outward, kSunkM), pressed_,
        multipliers_, {});
    EXPECT_TRUE(report.converged) << report.failure;
  }

  // K_t / k_n at a state, K^-1 of the body by `solve`, over the linear one that is 1.
  double ratio(const NearState& state, const RestSolve& solve) {
    Indentation press;
    press.sample.resize(2);
    press.sample.back().penetration_m = kSunkM;
    press.contact = {{.penetration_m = kSunkM, .lateral = Eigen::Matrix2d::Identity()}};
    const SurfaceCompliance compliance(*block_.factor, block_.supports, block_.surface,
                                       block_.patch);
    correct_lateral_states({.near = *near_,
                            .state = state,
                            .pressure_n = multipliers_.pressure_n,
                            .penetration_m = kSunkM},
                           solve, block_.surface, compliance.among(block_.patch),
                           block_.patch, path_, press);
    return press.contact.front().lateral(0, 0);
  }

  const SoftBlock block_{neo_hookean(5e3, 0.45)};
  const IndentationPath path_{.vertex_m = Eigen::Vector3d::Zero(),
                              .outward = Eigen::Vector3d::UnitZ(),
                              .tool = block_.ball,
                              .depth_max_m = kSunkM};
  std::unique_ptr<NearField> near_;
  Multipliers multipliers_;
  NearState rest_;
  NearState pressed_;
};

// By gradients with the rest factor, and by the tangent's own factor.
TEST_F(StrainedBlock, IsThatOfTheFactoredTangent) {
  const double by_gradients = ratio(pressed_, block_.solve);
  Eigen::VectorXd force_n = Eigen::VectorXd::Zero(near_->size());
  near_->linearise(pressed_.displacement_m, force_n, false);
  TangentFactor tangent(*block_.factor, block_.stiffness, *near_);
  tangent.refresh();
  ASSERT_TRUE(tangent.ready());
  const RestSolve factored = [&](std::span<const std::int64_t> /*dof*/,
                                 const Eigen::VectorXd& source, SolveWith /*with*/) {
    return tangent.solve(source).displacement_m;
  };
  // At rest the near field changes nothing of what is factored.
  EXPECT_NEAR(by_gradients / ratio(rest_, factored), 1.0, 1e-3);
  EXPECT_GT(std::abs(by_gradients / ratio(rest_, block_.solve) - 1.0), 0.01);
}

TEST_F(StrainedBlock, WithoutALinearRatioNothingIsCorrected) {
  Indentation press;
  press.sample.resize(2);
  press.contact = {{.penetration_m = kSunkM}};
  take_tangent(press, kSunkM, 0.2);
  EXPECT_EQ(press.contact.front().lateral.norm(), 0.0);
}

TEST(LateralTangent, GrowsWithTheDepth) {
  Indentation press;
  press.sample = {{.penetration_m = 0.001}, {.penetration_m = 0.003}};
  for (const double at_m : {0.001, 0.0015, 0.003, 0.004}) {
    press.contact.push_back(
        {.penetration_m = at_m, .lateral = Eigen::Matrix2d::Identity()});
  }
  take_tangent(press, 0.003, 0.4);
  const double wanted[] = {1.0, 1.1, 1.4, 1.4};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(press.contact[k].lateral(1, 1), wanted[k], 1e-12) << k;
    EXPECT_EQ(press.contact[k].by_tangent, 0.4);
  }
}

}  // namespace
}  // namespace palpate
