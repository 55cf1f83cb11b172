// The factor at a strained state: an inverse, and what it saves near incompressibility.
#include "precompute/contact/tangent_factor.h"

#include <memory>
#include <numeric>

#include <gtest/gtest.h>

#include "precompute/contact/equilibrium.h"
#include "tests/precompute/contact/soft_block.h"

namespace palpate {
namespace {

constexpr double kDeep = 0.003;  // [m]

class TangentFactors : public testing::Test {
 protected:
  TangentFactors() {
    std::vector<std::int32_t> nodes;
    for (const std::int32_t v : block_.patch) {
      for (const NodalForce& entry :
           block_.surface.node[static_cast<std::size_t>(v)].load) {
        nodes.push_back(entry.node);
      }
    }
    // Half of the body is far.
    std::vector<Eigen::Index> tets;
    for (Eigen::Index t = 0; t < block_.mesh.tet.rows(); ++t) {
      if (block_.mesh.position_m.row(block_.mesh.tet(t, 0)).norm() < 0.015) {
        tets.push_back(t);
      }
    }
    near_ = std::make_unique<NearField>(block_.mesh, block_.material, block_.supports,
                                        tets, nodes);
    contact_ = std::make_unique<ContactPotential>(block_.surface, block_.mesh,
                                                  block_.patch, *near_);
    const auto n = static_cast<Eigen::Index>(block_.patch.size());
    multipliers_ = {.pressure_n = Eigen::VectorXd::Zero(n),
                    .spring_n_per_m = Eigen::VectorXd::Constant(n, 20.0),
                    .tie_n = Eigen::MatrixX3d::Zero(n, 3),
                    .anchor_m = Eigen::MatrixX3d::Zero(n, 3),
                    .tied = {}};
    state_ = {Eigen::VectorXd::Zero(near_->size()),
              Eigen::VectorXd::Zero(near_->size())};
  }

  EquilibriumReport press(TangentFactor* tangent) {
    const EquilibriumOptions defaults;
    Equilibrium equilibrium(*near_, *contact_, block_.solve,
                            {.decrement_relative = 1e-2 * defaults.decrement_relative,
                             .multiplier_relative = 1e-2 * defaults.multiplier_relative,
                             .newton_max = 100,
                             .gradients_total = 10000},
                            tangent);
    Multipliers multipliers = multipliers_;
    NearState state = state_;
    EquilibriumReport report =
        equilibrium.find(place_on_path(*block_.ball, Eigen::Vector3d::Zero(),
                                       Eigen::Vector3d::UnitZ(), kDeep),
                         state, multipliers, {});
    EXPECT_TRUE(report.converged) << report.failure;
    found_ = std::move(state);
    return report;
  }

  const SoftBlock block_{neo_hookean(5e3, 0.4995)};
  std::unique_ptr<NearField> near_;
  std::unique_ptr<ContactPotential> contact_;
  Multipliers multipliers_;
  NearState state_;
  NearState found_;  // of the last press()
};

TEST_F(TangentFactors, SolveStrainedBodiesWithTheirFarFieldInBalance) {
  press(nullptr);
  TangentFactor tangent(*block_.factor, block_.stiffness, *near_);
  EXPECT_FALSE(tangent.ready());
  Eigen::VectorXd force = Eigen::VectorXd::Zero(near_->size());
  near_->linearise(found_.displacement_m, force, true);
  tangent.refresh();
  ASSERT_TRUE(tangent.ready());
  Eigen::VectorXd load = Eigen::VectorXd::Random(near_->size());
  near_->mask(load);
  const NearState z = tangent.solve(load);
  // (K + change) u = load on near nodes, and u is what the source does to the body.
  Eigen::VectorXd rest = z.source_n - load;
  near_->add_change(z.displacement_m, rest);
  near_->mask(rest);
  EXPECT_LT(rest.norm(), 1e-12 * load.norm());
  const Eigen::VectorXd expected =
      block_.solve(near_->dof(), z.source_n, SolveWith::kFactor);
  EXPECT_LT((z.displacement_m - expected).norm(), 1e-8 * expected.norm());
  const Eigen::VectorXd at_rest = block_.solve(near_->dof(), load, SolveWith::kFactor);
  EXPECT_GT((z.displacement_m - at_rest).norm(), 0.01 * at_rest.norm());
}

TEST_F(TangentFactors, SaveGradientsNearIncompressibilityAndChangeNoForce) {
  const EquilibriumReport without = press(nullptr);
  TangentFactor tangent(*block_.factor, block_.stiffness, *near_);
  const EquilibriumReport with = press(&tangent);
  EXPECT_TRUE(tangent.ready());
  EXPECT_LT(2 * with.gradients, without.gradients);
  EXPECT_LT((with.contact.force_n - without.contact.force_n).norm(),
            1e-3 * without.contact.force_n.norm());
}

}  // namespace
}  // namespace palpate
