// Rest states of a soft block under a ball: the same from wherever they are sought, and
// sooner found where tangents are known.
#include "precompute/contact/equilibrium.h"

#include <memory>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/precompute/contact/soft_block.h"

namespace palpate {
namespace {

// All of it near.
struct AllNearBlock : SoftBlock {
  AllNearBlock() : SoftBlock(neo_hookean(5e3, 0.48)) {
    std::vector<std::int32_t> nodes;
    for (const std::int32_t v : patch) {
      for (const NodalForce& entry : surface.node[static_cast<std::size_t>(v)].load) {
        nodes.push_back(entry.node);
      }
    }
    std::vector<Eigen::Index> tets(static_cast<std::size_t>(mesh.tet.rows()));
    std::iota(tets.begin(), tets.end(), Eigen::Index{0});
    near = std::make_unique<NearField>(mesh, material, supports, tets, nodes);
    contact = std::make_unique<ContactPotential>(surface, mesh, patch, *near);
  }

  // The state at rest, and no pressure.
  struct Start {
    NearState state;
    Multipliers multipliers;
  };
  Start rest() const {
    const auto n = static_cast<Eigen::Index>(patch.size());
    return {{Eigen::VectorXd::Zero(near->size()), Eigen::VectorXd::Zero(near->size())},
            {.pressure_n = Eigen::VectorXd::Zero(n),
             .spring_n_per_m = Eigen::VectorXd::Constant(n, 20.0),
             .tie_n = Eigen::MatrixX3d::Zero(n, 3),
             .anchor_m = Eigen::MatrixX3d::Zero(n, 3),
             .tied = {}}};
  }

  // To a ball so deep in the block.
  EquilibriumReport press(Equilibrium& equilibrium, double depth_m,
                          Start& start) const {
    return equilibrium.find(place_on_path(*ball, Eigen::Vector3d::Zero(),
                                          Eigen::Vector3d::UnitZ(), depth_m),
                            start.state, start.multipliers, {});
  }

  std::unique_ptr<NearField> near;
  std::unique_ptr<ContactPotential> contact;
};

class Equilibria : public testing::Test {
 protected:
  Equilibrium fresh() const {
    return {*block_.near, *block_.contact, block_.solve, {}};
  }
  // At 2.5 mm, and then at another depth by one that has seen the first, or has not.
  EquilibriumReport from_there(double depth_m, bool has_seen) const {
    Equilibrium before = fresh();
    AllNearBlock::Start at = block_.rest();
    EXPECT_TRUE(block_.press(before, 0.0025, at).converged);
    Equilibrium other = fresh();
    return block_.press(has_seen ? before : other, depth_m, at);
  }

  const AllNearBlock block_;
};

TEST(SpringGive, IsTheMeanOfGapsAndSlipsWeightedByForces) {
  ContactState contact;
  contact.pressure_n = Eigen::Vector3d(3.0, 1.0, 0.0);
  contact.gap_m = Eigen::Vector3d(-0.001, 0.002, 0.5);  // the last one is not touched
  contact.tie_n = Eigen::Matrix3d::Zero();
  Multipliers multipliers{.pressure_n = Eigen::Vector3d::Zero(),
                          .spring_n_per_m = Eigen::Vector3d(100.0, 200.0, 100.0),
                          .tie_n = Eigen::Matrix3d::Zero(),
                          .anchor_m = Eigen::Matrix3d::Zero(),
                          .tied = {}};
  EXPECT_DOUBLE_EQ(spring_give_m(contact, multipliers), 0.005 / 4.0);
  contact.tie_n(1, 0) = 2.0;  // 1 N of which the spring carries
  multipliers.tie_n(1, 0) = 1.0;
  EXPECT_DOUBLE_EQ(spring_give_m(contact, multipliers), (0.005 + 2.0 / 200.0) / 4.0);
  contact.pressure_n.setZero();
  EXPECT_EQ(spring_give_m(contact, multipliers), 0.0);
}

// Where the promised energy is asked for far too little.
TEST_F(Equilibria, EndWhereForcesAreInBalanceWhateverStepsPromise) {
  EquilibriumOptions loose{
      .decrement_relative = 0.9, .update_relative = 0.9, .multiplier_relative = 100.0};
  const auto imbalance = [&](const EquilibriumOptions& options) {
    Equilibrium equilibrium(*block_.near, *block_.contact, block_.solve, options);
    AllNearBlock::Start at = block_.rest();
    const EquilibriumReport report = block_.press(equilibrium, 0.0025, at);
    EXPECT_TRUE(report.converged);
    return report.imbalance_n / report.contact.force_n.norm();
  };
  EXPECT_LE(imbalance(loose), loose.imbalance_relative);
  loose.imbalance_relative = std::numeric_limits<double>::infinity();
  EXPECT_GT(imbalance(loose), 0.05);
}

TEST_F(Equilibria, TangentsOfADepthSaveGradientsAtTheNext) {
  // Over many depths: at one of them rounding decides on one in three.
  int gradients = 0;
  int without = 0;
  for (int i = 28; i <= 36; ++i) {
    gradients += from_there(1e-4 * i, true).gradients;
    without += from_there(1e-4 * i, false).gradients;
  }
  EXPECT_LT(gradients, 0.9 * without);
  const EquilibriumReport expected = from_there(0.003, false);
  const EquilibriumReport found = from_there(0.003, true);
  ASSERT_TRUE(expected.converged) << expected.failure;
  ASSERT_TRUE(found.converged) << found.failure;
  EXPECT_GT(found.contact.force_n.z(), 0.0);
  EXPECT_LT((found.contact.force_n - expected.contact.force_n).norm(),
            1e-3 * expected.contact.force_n.norm());
}

TEST_F(Equilibria, TangentsOfADeepPressDoNotMisleadAShallowOne) {
  const EquilibriumReport expected = from_there(0.0005, false);
  const EquilibriumReport found = from_there(0.0005, true);
  ASSERT_TRUE(found.converged) << found.failure;
  EXPECT_LT((found.contact.force_n - expected.contact.force_n).norm(),
            1e-3 * expected.contact.force_n.norm());
}

}  // namespace
}  // namespace palpate
