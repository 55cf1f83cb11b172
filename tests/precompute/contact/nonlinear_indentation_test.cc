// A ball pressed into a soft block: what must hold whatever the law, the mesh and the
// solver's settings are.
#include "precompute/contact/nonlinear_indentation.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <memory>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "precompute/contact/linear_indentation.h"
#include "precompute/process/interrupt.h"
#include "tests/precompute/contact/soft_block.h"

namespace palpate {
namespace {

constexpr double kPressDepth = 0.0025;
constexpr int kSteps = 32;
// A sample at an eighth of the depth. At shallower ones hats are wider than the
// contact, and it matters that their gaps are averaged along the press in the linear
// solution, along the tool's normals in the other.
constexpr std::size_t kShallow = 10;

class PressedBlock {
 public:
  explicit PressedBlock(const Material& law) : block_(law) {
    const SurfaceCompliance columns(*block_.factor, block_.supports, block_.surface,
                                    block_.patch);
    compliance_ = columns.among(block_.patch);
    path_ = {.vertex_m = Eigen::Vector3d::Zero(),
             .outward = Eigen::Vector3d::UnitZ(),
             .tool = block_.ball,
             .depth_max_m = kPressDepth,
             .force_max_n = 1e3,
             .samples = kSteps};
    linear_ = indent(block_.surface, columns, block_.patch, path_);
    for (std::size_t k = 1; k < linear_.sample.size(); ++k) {
      const IndentationSample& sample = linear_.sample[k];
      steps_.push_back({sample.penetration_m, tool_at(path_, sample.penetration_m),
                        sample.pressure_n});
    }
  }

  // @param solves whole solutions with the factor, as a press begins with one.
  [[nodiscard]] NonlinearIndentation press(const NonlinearOptions& options,
                                           int* solves = nullptr) const {
    const RestSolve counted = [&](std::span<const std::int64_t> dof,
                                  const Eigen::VectorXd& source, SolveWith with) {
      if (solves != nullptr && dof.size() == block_.supports.free_index.size()) {
        ++*solves;
      }
      return block_.solve(dof, source, with);
    };
    return indent_nonlinear(
        {block_.mesh, block_.material, block_.supports, block_.surface}, block_.patch,
        compliance_, linear_.sample.front().penetration_m, steps_,
        [&](double penetration_m) {
          return tool_at(path_, penetration_m);
        },
        counted, options);
  }
  [[nodiscard]] const Indentation& linear() const { return linear_; }
  [[nodiscard]] const SoftBlock& block() const { return block_; }
  void keep_last_step() { steps_.erase(steps_.begin(), steps_.end() - 1); }
  // All but every eighth, and the last.
  void pass_over_steps() {
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      steps_[i].only_if_hard = i % 8 != 7;
    }
  }

 private:
  SoftBlock block_;
  Eigen::MatrixXd compliance_;
  IndentationPath path_;
  Indentation linear_;
  std::vector<PressStep> steps_;
};

// Everything near, multipliers to the end.
NonlinearOptions exact() {
  NonlinearOptions options;
  options.near_gradient = 0.0;
  options.equilibrium.multiplier_relative = 1e-4;
  return options;
}

class PressIntoGel : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    gel_ = std::make_unique<PressedBlock>(neo_hookean(5e3, 0.45));
    exact_ = gel_->press(exact());
    usual_ = gel_->press({});
  }
  static void TearDownTestSuite() { gel_.reset(); }

  static double off(const NonlinearIndentation& result) {
    double largest = 0.0;
    for (std::size_t k = 0; k < result.sample.size(); ++k) {
      const Eigen::Vector3d& expected = exact_.sample[k].force_n;
      largest = std::max(
          largest, (result.sample[k].force_n - expected).norm() / expected.norm());
    }
    return largest;
  }

  static double ratio_to_linear(const NonlinearIndentation& result, std::size_t k) {
    return result.sample[k].force_n.z() / gel_->linear().sample[k + 1].force_n.z();
  }

  static std::unique_ptr<PressedBlock> gel_;
  static NonlinearIndentation exact_;
  static NonlinearIndentation usual_;
};
std::unique_ptr<PressedBlock> PressIntoGel::gel_;
NonlinearIndentation PressIntoGel::exact_;
NonlinearIndentation PressIntoGel::usual_;

TEST_F(PressIntoGel, WorkOfTheForceIsTheStoredEnergy) {
  ASSERT_TRUE(exact_.converged()) << exact_.failure;
  ASSERT_EQ(exact_.sample.size(), std::size_t{kSteps});
  // By the trapezoidal rule: exact to 1e-4 where no node comes into contact within the
  // interval, as it is in most; slopes jump where one does.
  double work_j = 0.0;
  int exact = 0;
  for (std::size_t k = 3; k < exact_.sample.size(); ++k) {
    const NonlinearSample& before = exact_.sample[k - 1];
    const NonlinearSample& sample = exact_.sample[k];
    const double interval_j = 0.5 * (before.force_n.z() + sample.force_n.z()) *
                              (sample.penetration_m - before.penetration_m);
    const double ratio = interval_j / (sample.energy_j - before.energy_j);
    EXPECT_NEAR(ratio, 1.0, 0.015) << k;
    exact += std::abs(ratio - 1.0) < 1e-4 ? 1 : 0;
    work_j += interval_j;
  }
  EXPECT_GE(exact, kSteps / 2);
  EXPECT_NEAR(work_j / (exact_.sample.back().energy_j - exact_.sample[2].energy_j), 1.0,
              1e-3);
}

TEST_F(PressIntoGel, ForceIsAlongThePressAndGrowsFasterThanTheLinearBodys) {
  for (std::size_t k = 0; k < exact_.sample.size(); ++k) {
    const NonlinearSample& sample = exact_.sample[k];
    EXPECT_LT(sample.force_n.head<2>().norm(), 0.02 * sample.force_n.z());
    if (k == kShallow) {
      EXPECT_NEAR(ratio_to_linear(exact_, k), 1.0, 0.08);
    } else if (k > kShallow) {
      EXPECT_NEAR(ratio_to_linear(exact_, k), 1.0, 0.35) << k;
    }
    EXPECT_GT(sample.smallest_jacobian, 0.3);
    EXPECT_LE(sample.smallest_jacobian, 1.0);
    if (k > kSteps / 2) {  // Hertz: pi R d, within what hats resolve
      EXPECT_NEAR(sample.contact_area_m2,
                  std::numbers::pi * SoftBlock::kRadius * sample.penetration_m,
                  0.4 * sample.contact_area_m2);
    }
    if (k > 0) {
      EXPECT_GE(sample.contact_area_m2, exact_.sample[k - 1].contact_area_m2);
      EXPECT_GT(sample.energy_j, exact_.sample[k - 1].energy_j);
    }
  }
}

TEST_F(PressIntoGel, TheMomentIsThatOfTheForceAtTheContact) {
  // By symmetry the force's line goes through the middle.
  for (const NonlinearSample& sample : exact_.sample) {
    EXPECT_LT(sample.moment_nm.norm(), 1e-4 * sample.force_n.norm());
  }
}

TEST_F(PressIntoGel, MultipliersCarryThePressureAndNothingSinksIn) {
  for (const NonlinearSample& sample : exact_.sample) {
    EXPECT_LE(sample.multiplier_relative, 1e-4);
    EXPECT_LT(sample.give_m, 1e-3 * kPressDepth);
    EXPECT_LT(sample.largest_overlap_m, 1e-2 * kPressDepth);
  }
  double give_m = 0.0;
  for (const NonlinearSample& sample : usual_.sample) {
    EXPECT_LE(sample.multiplier_relative,
              NonlinearOptions{}.equilibrium.multiplier_relative);
    give_m = std::max(give_m, sample.give_m);
  }
  EXPECT_GT(give_m, 0.0) << "what springs carry is told";
}

TEST_F(PressIntoGel, ThePressureIsWhatTheToolFeels) {
  const ContactSurface& surface = gel_->block().surface;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < gel_->block().patch.size(); ++i) {
    const auto& node = surface.node[static_cast<std::size_t>(gel_->block().patch[i])];
    sum += exact_.pressure_n[static_cast<Eigen::Index>(i)] * node.normal;
  }
  // Pressures are along the tool's normals, so their sum along the press is somewhat
  // larger than the force: no more than the steepest contact allows.
  const double force_n = exact_.sample.back().force_n.z();
  EXPECT_GT(sum.z(), force_n);
  EXPECT_LT(sum.z(), 1.25 * force_n);
}

TEST_F(PressIntoGel, AFarFieldThatKeepsItsRestStiffnessChangesLittle) {
  ASSERT_TRUE(usual_.converged()) << usual_.failure;
  EXPECT_LT(usual_.near_tets, exact_.near_tets);
  EXPECT_EQ(exact_.near_tets, gel_->block().mesh.tet.rows());
  EXPECT_EQ(exact_.near_nodes, gel_->block().mesh.position_m.rows());
  EXPECT_LT(usual_.near_nodes, exact_.near_nodes);
  EXPECT_EQ(static_cast<Eigen::Index>(usual_.near_tet.size()), usual_.near_tets);
  EXPECT_EQ(exact_.far_excess_relative, 0.0);
  EXPECT_GT(usual_.far_excess_relative, 0.0);
  EXPECT_LE(usual_.far_excess_relative, NonlinearOptions{}.far_excess_max);
  EXPECT_LT(off(usual_), 0.02);
  NonlinearOptions narrow;
  narrow.near_gradient = 0.5;
  narrow.far_excess_max = 1.0;
  const NonlinearIndentation rough = gel_->press(narrow);
  EXPECT_LT(rough.near_tets, usual_.near_tets);
  EXPECT_GT(rough.far_excess_relative, usual_.far_excess_relative);
  EXPECT_GT(off(rough), off(usual_));
  narrow.far_excess_max = 0.005;
  const NonlinearIndentation widened = gel_->press(narrow);
  EXPECT_GT(widened.near_tets, rough.near_tets) << "its energy asks for more";
  EXPECT_LE(widened.far_excess_relative, 0.005);
}

TEST_F(PressIntoGel, TheLinearSolutionTellsHowLargeTheNearFieldMustBe) {
  NonlinearOptions narrow;
  narrow.near_gradient = 0.5;
  int solves = 0;
  const NonlinearIndentation result = gel_->press(narrow, &solves);
  ASSERT_TRUE(result.converged()) << result.failure;
  EXPECT_LT(result.near_gradient, narrow.near_gradient);
  EXPECT_LE(result.far_excess_relative, narrow.far_excess_max);
  EXPECT_EQ(solves, 2) << "one at the beginning, one at the end: it was not done again";
}

TEST_F(PressIntoGel, AnEasyPathPassesOverSteps) {
  PressedBlock few(neo_hookean(5e3, 0.45));
  few.pass_over_steps();
  NonlinearOptions patient = exact();
  patient.newton_easy = patient.equilibrium.newton_max;
  const NonlinearIndentation result = few.press(patient);
  ASSERT_TRUE(result.converged()) << result.failure;
  EXPECT_FALSE(result.near_singular);
  ASSERT_EQ(result.sample.size(), std::size_t{kSteps / 8});
  for (std::size_t k = 0; k < result.sample.size(); ++k) {
    ASSERT_EQ(result.sample[k].step, 8 * k + 7);
    const Eigen::Vector3d& expected = exact_.sample[8 * k + 7].force_n;
    EXPECT_LT((result.sample[k].force_n - expected).norm(), 1e-3 * expected.norm());
  }
}

TEST_F(PressIntoGel, AHardPathTakesTheStepsItWouldPassOver) {
  PressedBlock few(neo_hookean(5e3, 0.45));
  few.pass_over_steps();
  NonlinearOptions hasty = exact();
  hasty.newton_easy = 1;  // nothing is easy
  const NonlinearIndentation result = few.press(hasty);
  ASSERT_TRUE(result.converged()) << result.failure;
  EXPECT_TRUE(result.near_singular);
  ASSERT_EQ(result.sample.size(), std::size_t{kSteps});
  NonlinearOptions stiff = exact();
  stiff.stiff = true;
  const NonlinearIndentation expected = gel_->press(stiff);
  for (std::size_t k = 0; k < result.sample.size(); ++k) {
    EXPECT_EQ(result.sample[k].step, k);
    const Eigen::Vector3d& force_n = expected.sample[k].force_n;
    EXPECT_LT((result.sample[k].force_n - force_n).norm(), 1e-3 * force_n.norm());
  }
}

TEST_F(PressIntoGel, AUsualPressTakesFewStepsAndIsNotHard) {
  int newton = 0;
  int gradients = 0;
  int lagrange = 0;
  for (const NonlinearSample& sample : usual_.sample) {
    newton += sample.newton;
    gradients += sample.gradients;
    lagrange += sample.lagrange;
  }
  EXPECT_FALSE(usual_.near_singular);
  EXPECT_LE(newton, 10 * kSteps);
  EXPECT_LE(gradients, 60 * kSteps);
  EXPECT_LE(lagrange, 8 * kSteps);
  EXPECT_GE(newton, 2 * kSteps);
}

TEST_F(PressIntoGel, ForcesDoNotDependOnHowThePathIsWalkedNorOnTheSprings) {
  NonlinearOptions stiff = exact();
  stiff.spring_factor = 10.0;
  EXPECT_LT(off(gel_->press(stiff)), 1e-3);
  PressedBlock one(neo_hookean(5e3, 0.45));
  one.keep_last_step();
  const NonlinearIndentation jumped = one.press(exact());
  ASSERT_EQ(jumped.sample.size(), 1U) << jumped.failure;
  const Eigen::Vector3d expected = exact_.sample.back().force_n;
  EXPECT_LT((jumped.sample.back().force_n - expected).norm(), 1e-3 * expected.norm());
}

TEST_F(PressIntoGel, AStickingToolIsHeldFasterThanASlidingOne) {
  NonlinearOptions sticking = exact();
  sticking.sticking = true;
  const NonlinearIndentation held = gel_->press(sticking);
  ASSERT_TRUE(held.converged()) << held.failure;
  const double ratio =
      held.sample.back().force_n.z() / exact_.sample.back().force_n.z();
  // An incompressible half-space does not tell them apart; nu = 0.45 and large depths
  // do, by some percent (Spence 1975).
  EXPECT_GT(ratio, 1.003);
  EXPECT_LT(ratio, 1.15);
}

TEST_F(PressIntoGel, WhatDoesNotConvergeSaysSoAndKeepsWhatItHas) {
  NonlinearOptions hasty = exact();
  hasty.equilibrium.newton_max = 1;
  hasty.bisections_max = 0;
  const NonlinearIndentation failed = gel_->press(hasty);
  EXPECT_FALSE(failed.converged());
  EXPECT_LT(failed.sample.size(), std::size_t{kSteps});
  EXPECT_TRUE(failed.near_singular);
  EXPECT_NE(failed.failure.find("Newton steps"), std::string::npos) << failed.failure;
  EXPECT_NE(failed.failure.find("mm: "), std::string::npos) << failed.failure;
}

TEST(PressIntoALinearLaw, IsThatOfTheLinearBodyAtSmallDepths) {
  const PressedBlock block(linear(5e3, 0.45));
  const NonlinearIndentation result = block.press(exact());
  ASSERT_TRUE(result.converged()) << result.failure;
  EXPECT_EQ(result.far_excess_relative, 0.0);
  EXPECT_NEAR(result.sample[kShallow].force_n.z() /
                  block.linear().sample[kShallow + 1].force_n.z(),
              1.0, 0.05);
}

// A press may take minutes.
TEST(NonlinearIndentation, EndsBetweenItsStepsWhenInterrupted) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  constexpr int kInterrupted = 7;
  EXPECT_EXIT(
      {
        note_interrupts();
        const PressedBlock block(neo_hookean(5e3, 0.45));
        kill(getpid(), SIGTERM);
        try {
          for (int i = 0; i < 20; ++i) {
            (void)block.press({});
          }
          _exit(0);
        } catch (const Interrupted&) {
          _exit(kInterrupted);
        }
      },
      testing::ExitedWithCode(kInterrupted), "");
}

}  // namespace
}  // namespace palpate
