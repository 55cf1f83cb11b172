// Paths of which a few depths are solved nonlinear, beside the same solved at all.
#include "precompute/press/nonlinear_press.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/press/surface_displacement.h"
#include "tests/support/odd_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kBlockHalf = 0.02;
constexpr int kBlockCells = 8;
constexpr int kDepths = 12;

// The middle of a soft block's top, under a ball.
class PressedMiddle : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const ScratchFolder folder;
    write_obj(relief(kBlockHalf, -0.02, kBlockCells,
                     [](double, double) {
                       return 0.0;
                     }),
              folder / "block.obj", "");
    std::ofstream(folder / "scene.toml") << R"([body]
mesh = "block.obj"
length_unit = "m"
[[material]]
region = "body"
law = "neo-hookean"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.45
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.0199]]
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.006
[reach]
depth_max_m = 0.005
[accuracy]
force_relative = 0.1
depths = 12
verify = 0
)";
    scene_ = std::make_unique<Scene>(read_scene(folder / "scene.toml"));
    body_ = std::make_unique<BodySource>(read_body(*scene_));
    model_ = std::make_unique<BodyModel>(make_own_model(
        *scene_, *body_, std::span(&kMiddle, 1), contact_focus(*scene_, *body_)));
    few_ = press(options());
    all_ = press(options(), SolvedDepths::kEvery);
  }
  static void TearDownTestSuite() {
    model_.reset();
    body_.reset();
    scene_.reset();
  }

  static NonlinearOptions options() {
    NonlinearOptions some = nonlinear_options(*scene_, body_->tool.front());
    some.depth_error_max = 1.0;  // what a few depths tell is taken
    return some;
  }
  static PressedNode press(const NonlinearOptions& options,
                           SolvedDepths depths = SolvedDepths::kFew,
                           double force_max_n = 1e3) {
    Scene scene = *scene_;
    scene.reach.force_max_n = force_max_n;
    PressedNode node =
        press_on_model(scene, *body_, *model_, body_->tool.front(), {&kMiddle, 1},
                       {.nonlinear = true,
                        .recipe = {.depths = depths},
                        .options = options,
                        .keep_states = true})
            .front();
    EXPECT_EQ(node.failure, "");
    return node;
  }

  // As stated errors mean it, against all_.
  static double off(const PressedNode& node) {
    const auto& path = node.indentation.sample;
    const auto& better = all_.indentation.sample;
    EXPECT_EQ(path.size(), better.size());
    const double largest_n = better.back().force_n.norm();
    double error = 0.0;
    for (std::size_t k = 1; k < path.size(); ++k) {
      if (path[k].penetration_m > 0.1 * path.back().penetration_m) {
        error =
            std::max(error, (path[k].force_n - better[k].force_n).norm() /
                                std::max(better[k].force_n.norm(), 0.1 * largest_n));
      }
    }
    return error;
  }

  static constexpr std::int32_t kMiddle =
      kBlockCells / 2 * (kBlockCells + 1) + kBlockCells / 2;
  static std::unique_ptr<Scene> scene_;
  static std::unique_ptr<BodySource> body_;
  static std::unique_ptr<BodyModel> model_;
  static PressedNode few_;
  static PressedNode all_;
};
std::unique_ptr<Scene> PressedMiddle::scene_;
std::unique_ptr<BodySource> PressedMiddle::body_;
std::unique_ptr<BodyModel> PressedMiddle::model_;
PressedNode PressedMiddle::few_;
PressedNode PressedMiddle::all_;

// Between solved depths energy and contact are those of the nonlinear body, too.
TEST_F(PressedMiddle, DepthsThatAreNotSolvedKeepNothingOfTheLinearBody) {
  ASSERT_LT(few_.nonlinear->sample.size(), all_.nonlinear->sample.size());
  double made_off = 0.0;
  double linear_off = 0.0;
  for (std::size_t k = few_.nonlinear->sample.front().step + 1; k <= kDepths; ++k) {
    const double energy_j = all_.indentation.sample[k].energy_j;
    const auto off = [&](const Indentation& path) {
      return std::abs(path.sample[k].energy_j / energy_j - 1.0);
    };
    made_off = std::max(made_off, off(few_.indentation));
    linear_off = std::max(linear_off, off(few_.linear));
  }
  EXPECT_LT(made_off, 0.5 * linear_off);
}

TEST_F(PressedMiddle, CountsTheWorkOfEveryAttempt) {
  std::int64_t of_samples = 0;
  for (const NonlinearSample& sample : all_.nonlinear->sample) {
    of_samples += sample.gradients;
  }
  EXPECT_GE(all_.checks.gradients, of_samples);
  EXPECT_EQ(all_.checks.gradients, all_.nonlinear->gradients);
}

TEST_F(PressedMiddle, EveryDepthTakesTheForceThatWasSolvedThere) {
  ASSERT_EQ(all_.indentation.sample.size(), std::size_t{kDepths + 1});
  ASSERT_EQ(all_.nonlinear->sample.size(), std::size_t{kDepths});
  for (std::size_t k = 0; k < all_.nonlinear->sample.size(); ++k) {
    EXPECT_EQ(all_.nonlinear->sample[k].force_n,
              all_.indentation.sample[k + 1].force_n);
    EXPECT_EQ(all_.nonlinear->sample[k].energy_j,
              all_.indentation.sample[k + 1].energy_j);
  }
}

TEST_F(PressedMiddle, ItsFieldIsTheSolvedDisplacement) {
  const Eigen::Index vertices = body_->surface.position_m.rows();
  const PressFields solved = press_fields(*model_, vertices, {&few_, 1});
  ASSERT_EQ(solved.node, std::vector<std::int32_t>{kMiddle});
  EXPECT_EQ(solved.depth_m.front(), few_.nonlinear->sample.back().penetration_m);
  const NonlinearIndentation& press = *few_.nonlinear;
  const double largest_m = solved.field_m.cwiseAbs().maxCoeff();
  int compared = 0;
  for (Eigen::Index i = 0; i < 3 * vertices; ++i) {
    const std::int64_t dof = model_->supports.free_index[static_cast<std::size_t>(i)];
    const auto near = std::find(press.near_dof.begin(), press.near_dof.end(), dof);
    if (dof >= 0 && near != press.near_dof.end()) {
      const double u_m = press.state.displacement_m[near - press.near_dof.begin()];
      EXPECT_NEAR(solved.field_m(i, 0), u_m, 1e-9 * largest_m);
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
  PressedNode linear = few_;
  linear.nonlinear.reset();
  const PressFields rough = press_fields(*model_, vertices, {&linear, 1});
  EXPECT_GT((rough.field_m - solved.field_m).norm(), 0.01 * solved.field_m.norm());
}

TEST_F(PressedMiddle, AFewDepthsAreSolvedAndTellThoseBetweenThem) {
  const auto& solved = few_.nonlinear->sample;
  ASSERT_EQ(static_cast<int>(solved.size()), nonlinear_depths(scene_->accuracy));
  EXPECT_EQ(solved.size(), 4U);
  EXPECT_EQ(solved.back().force_n, few_.indentation.sample.back().force_n);
  EXPECT_LT(off(few_), 0.02);
  EXPECT_GT(off(few_), 1e-6);
  // The linear press alone is farther off, and what is stated covers what is found.
  PressedNode linear = few_;
  linear.indentation = few_.linear;
  EXPECT_GT(off(linear), 1.5 * off(few_));
  EXPECT_GT(few_.indentation.path_error, 0.5 * off(few_));
  EXPECT_LT(few_.indentation.path_error, 0.05);
}

TEST_F(PressedMiddle, DepthsBetweenTheFewAreSolvedAndTheLast) {
  const PressedNode between = press(options(), SolvedDepths::kBetween);
  const auto& solved = between.nonlinear->sample;
  const auto& few = few_.nonlinear->sample;
  ASSERT_EQ(solved.size(), few.size() + 1);
  EXPECT_EQ(solved.back().penetration_m, few.back().penetration_m);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_LT(solved[i].penetration_m, few[i].penetration_m);
    EXPECT_LE(few[i].penetration_m, solved[i + 1].penetration_m);
  }
  // What was solved does not depend on the depths that were solved before it, but for
  // how far springs may give way.
  const double by_springs = 2.0 * 1.5 * options().give_relative;
  std::size_t compared = 0;
  for (std::size_t k = kDepths / 3; k <= kDepths; ++k) {
    const IndentationSample& every = all_.indentation.sample[k];
    for (const NonlinearSample& sample : solved) {
      if (sample.penetration_m == every.penetration_m) {
        EXPECT_LT((sample.force_n - every.force_n).norm(),
                  (2e-3 + by_springs) * every.force_n.norm());
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 5U);
}

// As many Newton steps as make some of the few depths easy, not all.
TEST_F(PressedMiddle, DepthsOnTheWayToAHardOneAreSolvedAndTheOthersAreToldAsBefore) {
  NonlinearOptions hasty = options();
  PressedNode node = few_;
  for (hasty.newton_easy = 30; node.nonlinear->sample.size() == 4U;
       --hasty.newton_easy) {
    node = press(hasty);
  }
  const auto& solved = node.nonlinear->sample;
  ASSERT_LT(solved.size(), std::size_t{kDepths});
  EXPECT_TRUE(node.indentation.near_singular);
  for (std::size_t i = 0; i < solved.size(); ++i) {
    EXPECT_EQ(node.indentation.sample[solved[i].step + 1].force_n, solved[i].force_n);
  }
  EXPECT_LT(off(node), 0.02) << "stiff contact is another discretisation";
  const std::size_t before = solved.front().step;  // interpolated
  const Eigen::Vector3d& expected_n = all_.indentation.sample[before].force_n;
  EXPECT_GT(node.indentation.path_error,
            0.5 * (node.indentation.sample[before].force_n - expected_n).norm() /
                expected_n.norm());
  EXPECT_LT(node.indentation.path_error, 0.05);
}

TEST_F(PressedMiddle, EveryDepthIsSolvedWhereAFewDoNotTellTheRest) {
  NonlinearOptions strict = options();
  strict.depth_error_max = 1e-9;
  const PressedNode node = press(strict);
  EXPECT_EQ(node.nonlinear->sample.size(), std::size_t{kDepths});
  EXPECT_EQ(off(node), 0.0);
}

TEST_F(PressedMiddle, EveryDepthIsSolvedWhereTheSceneSaysSo) {
  Scene scene = *scene_;
  scene.accuracy.solve_depths = "all";
  const PressedNode node = press(nonlinear_options(scene, body_->tool.front()));
  EXPECT_EQ(node.nonlinear->sample.size(), std::size_t{kDepths});
  EXPECT_EQ(off(node), 0.0);
  EXPECT_EQ(nonlinear_depths(scene.accuracy), kDepths);
}

TEST_F(PressedMiddle, CoarseForcesAreScaledAsForcesAre) {
  for (std::size_t k = 4; k < all_.indentation.sample.size(); ++k) {
    const IndentationSample& sample = all_.indentation.sample[k];
    const IndentationSample& linear = all_.linear.sample[k];
    EXPECT_NEAR(sample.coarse_force_n / sample.force_n.norm(),
                linear.coarse_force_n / linear.force_n.norm(), 1e-9);
  }
}

TEST_F(PressedMiddle, PressuresThatSpringsCarryAreAnErrorThatIsTold) {
  NonlinearOptions soft = options();
  soft.equilibrium.lagrange_max = 0;  // springs carry all of it
  const PressedNode node = press(soft, SolvedDepths::kEvery);
  const double error = off(node);
  EXPECT_GT(error, 0.02);
  // Within a factor: it takes forces to grow with the depth as Hertz's do.
  EXPECT_GT(node.indentation.path_error, 0.5 * error);
  EXPECT_LT(node.indentation.path_error, 4.0 * error);
}

TEST_F(PressedMiddle, SpringsGiveWayAsFarAsTheyMayAndThatIsTold) {
  NonlinearOptions strict = options();
  strict.give_relative = 0.0;
  strict.equilibrium.multiplier_relative = 0.01;
  const PressedNode exact = press(strict, SolvedDepths::kEvery);
  NonlinearOptions loose = strict;
  loose.give_relative = 0.01;
  const PressedNode node = press(loose, SolvedDepths::kEvery);
  const double touch_m = node.linear.sample.front().penetration_m;
  double largest = 0.0;
  for (const NonlinearSample& sample : node.nonlinear->sample) {
    const double give = sample.give_m / (sample.penetration_m - touch_m);
    EXPECT_LE(give, loose.give_relative);
    largest = std::max(largest, give);
  }
  EXPECT_GT(largest, 0.3 * loose.give_relative);
  const Eigen::Vector3d exact_n = exact.indentation.sample.back().force_n;
  const double error = (node.indentation.sample.back().force_n - exact_n).norm();
  EXPECT_GT(error, 1e-4 * exact_n.norm());
  EXPECT_LT(error, node.indentation.path_error * exact_n.norm());
  EXPECT_LT(node.indentation.path_error, 0.02);
}

TEST_F(PressedMiddle, APathEndsWhereTheForcePassesTheLargestWanted) {
  const double half_n = 0.5 * all_.indentation.sample.back().force_n.norm();
  const PressedNode node = press(options(), SolvedDepths::kEvery, half_n);
  const auto& path = node.indentation.sample;
  EXPECT_TRUE(node.indentation.force_capped);
  EXPECT_FALSE(all_.indentation.force_capped);
  ASSERT_GT(path.size(), 2U);
  EXPECT_GT(path.back().force_n.norm(), half_n);
  EXPECT_LE(path[path.size() - 2].force_n.norm(), half_n);
}

TEST_F(PressedMiddle, TheProbeTellsHowNonlinearAPressIs) {
  PressedNode deep = all_;
  deep.indentation = all_.linear;
  probe_nonlinearity(*model_, deep);
  PressedNode shallow = deep;
  shallow.indentation.sample.resize(3);
  probe_nonlinearity(*model_, shallow);
  // Gel under a ball softens at first.
  EXPECT_LT(shallow.indentation.nonlinearity, 0.0);
  EXPECT_GT(std::abs(deep.indentation.nonlinearity),
            2.0 * std::abs(shallow.indentation.nonlinearity));
  EXPECT_LT(std::abs(deep.indentation.nonlinearity), 0.5);
  PressedNode failed = deep;
  failed.indentation.nonlinearity = 0.0;
  failed.failure = "why";
  probe_nonlinearity(*model_, failed);
  EXPECT_EQ(failed.indentation.nonlinearity, 0.0);
}

TEST_F(PressedMiddle, OptionsFollowTheBudgetWithinLimits) {
  const auto at = [](double budget) {
    Scene scene = *scene_;
    scene.force_relative = budget;
    return nonlinear_options(scene, body_->tool.front());
  };
  EXPECT_DOUBLE_EQ(at(0.05).near_gradient, 0.05);
  EXPECT_DOUBLE_EQ(at(0.4).near_gradient, 0.1);
  EXPECT_DOUBLE_EQ(at(0.001).near_gradient, 0.01);
  EXPECT_DOUBLE_EQ(at(0.02).far_excess_max, 0.002);
  EXPECT_DOUBLE_EQ(at(0.02).depth_error_max, 0.006);
  EXPECT_DOUBLE_EQ(at(0.03).give_relative, 0.001);
  EXPECT_DOUBLE_EQ(at(0.4).give_relative, 0.05 / 30.0);
  EXPECT_DOUBLE_EQ(at(0.4).equilibrium.multiplier_relative, 0.03)
      << "no looser than with 5 %";
  EXPECT_DOUBLE_EQ(at(0.025).equilibrium.multiplier_relative, 0.015);
  EXPECT_DOUBLE_EQ(at(0.001).equilibrium.multiplier_relative, 0.003);
  EXPECT_DOUBLE_EQ(at(0.4).equilibrium.decrement_relative, 1e-5);
  EXPECT_DOUBLE_EQ(at(0.025).equilibrium.decrement_relative, 2.5e-6);
  EXPECT_FALSE(at(0.05).sticking);
}

}  // namespace
}  // namespace palpate
