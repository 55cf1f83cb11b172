#include "precompute/contact/linear_indentation.h"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>

#include <gtest/gtest.h>

#include "precompute/contact/indentation_response.h"
#include "tests/precompute/contact/soft_block.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.02;
constexpr double kDepth = 1e-4;
constexpr double kYoung = 10e3;
constexpr double kPoisson = 0.3;
constexpr double kHalf = 0.12;
const std::array<Material, 1> kGel{linear(kYoung, kPoisson)};

IndentationPath straight_down(int samples = 10) {
  return {.vertex_m = Eigen::Vector3d::Zero(),
          .outward = Eigen::Vector3d::UnitZ(),
          .tool = std::make_shared<const ToolSurface>(sphere(kRadius)),
          .depth_max_m = kDepth,
          .force_max_n = 1e9,
          .samples = samples};
}

// A block held at its floor, fine around the middle of its top, which is the origin.
struct Block : HeldBlock {
  explicit Block(double fine_m, double growth = 2.2)
      : HeldBlock(kHalf, 0.0016, fine_m, growth) {
    factor = std::make_unique<CholeskyFactor>(
        reduce(assemble_stiffness(mesh, kGel), supports));
    for (std::size_t i = 0; i < surface.node.size(); ++i) {
      if (surface.node[i].position_m.norm() < 1e-12) {
        centre = static_cast<std::int32_t>(i);
      }
    }
    patch = contact_patch(surface, supports, centre, Eigen::Vector3d::UnitZ(),
                          patch_radius_m(straight_down(), fine_m / 2));
    compliance = std::make_unique<SurfaceCompliance>(*factor, supports, surface, patch);
  }
  [[nodiscard]] Indentation press(const IndentationPath& path) const {
    return indent(surface, *compliance, patch, path);
  }

  std::unique_ptr<CholeskyFactor> factor;
  std::int32_t centre = -1;
  std::vector<std::int32_t> patch;
  std::unique_ptr<SurfaceCompliance> compliance;
};

// A press of 30 samples on a block of such edges, made once for all tests.
const Indentation& pressed_on_edges(double edge_m) {
  static std::map<double, Indentation> made;
  if (!made.contains(edge_m)) {
    made[edge_m] = Block(edge_m).press(straight_down(30));
  }
  return made.at(edge_m);
}

double hertz_force_n(double depth_m) {
  const double E_star = kYoung / (1 - kPoisson * kPoisson);
  return 4.0 / 3.0 * E_star * std::sqrt(kRadius) * std::pow(depth_m, 1.5);
}

// The floor at 0.12 m: +1.1 % at the largest depth, a/h = 0.012, from the bonded
// layer's table (kappa_s and chi_s at a/h = 0.2, linear in a/h).
double layer_stiffening(double depth_m) {
  return 1.0 + 0.93 * std::sqrt(kRadius * depth_m) / kHalf;
}

// Root mean square deviation from Hertz where the contact spans 1.5 nodes or more.
double deviation_from_hertz(const Indentation& indentation, double spacing_m) {
  double sum = 0.0;
  int count = 0;
  for (const IndentationSample& sample : indentation.sample) {
    if (std::sqrt(kRadius * sample.penetration_m) > 1.5 * spacing_m) {
      const double ratio = sample.force_n.z() / hertz_force_n(sample.penetration_m);
      const double layer = layer_stiffening(sample.penetration_m);
      sum += (ratio / layer - 1.0) * (ratio / layer - 1.0);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

TEST(Indentation, SphereOnALargeBlockMeetsHertzWithinThreePercentAndConverges) {
  const Indentation& coarse = pressed_on_edges(0.0016);
  const Indentation& middle = pressed_on_edges(0.0008);
  const Indentation& fine = pressed_on_edges(0.0005333);
  const double fine_ratio =
      fine.sample.back().force_n.z() / hertz_force_n(fine.sample.back().penetration_m);
  EXPECT_NEAR(fine_ratio, 1.0, 0.03);
  const double error_coarse = deviation_from_hertz(coarse, 0.0008);
  const double error_middle = deviation_from_hertz(middle, 0.0004);
  const double error_fine = deviation_from_hertz(fine, 0.00026667);
  RecordProperty("deviation_coarse", std::to_string(error_coarse));
  RecordProperty("deviation_middle", std::to_string(error_middle));
  RecordProperty("deviation_fine", std::to_string(error_fine));
  std::printf(
      "rms deviation from Hertz: %.4f %.4f %.4f at node spacings 0.8 0.4 0.27 mm\n",
      error_coarse, error_middle, error_fine);
  // The edge of the contact is found to a node spacing: first order.
  EXPECT_LT(error_middle, 0.6 * error_coarse);
  EXPECT_LT(error_fine, 0.75 * error_middle);
}

// Largest error of force from a tenth of the depth on: what an estimate is of.
double largest_error(const Indentation& indentation) {
  const double last_n = hertz_force_n(kDepth);
  double largest = 0.0;
  for (const IndentationSample& sample : indentation.sample) {
    if (sample.penetration_m >= 0.1 * kDepth) {
      const double truth_n =
          hertz_force_n(sample.penetration_m) * layer_stiffening(sample.penetration_m);
      largest = std::max(largest, std::abs(sample.force_n.z() - truth_n) /
                                      std::max(truth_n, 0.1 * last_n));
    }
  }
  return largest;
}

// The estimate is of the pressure's mesh alone; on a flat block of even tets there is
// little else. On edges of 1.6 mm a contact node is alone where errors begin to count:
// twice as coarse a mesh has none there, and the estimate is all of the difference.
TEST(Indentation, TheEstimateIsOfTheOrderOfTheErrorOnHertzsProblem) {
  for (const double edge_m : {0.0008, 0.0005333}) {
    const Indentation& indentation = pressed_on_edges(edge_m);
    const double error = largest_error(indentation);
    const double estimate = pressure_mesh_error(indentation);
    std::printf("edges of %.1f mm: error %.4f, estimate %.4f\n", edge_m * 1e3, error,
                estimate);
    EXPECT_GT(estimate, 0.8 * error);
    EXPECT_LT(estimate, 4.0 * error);
  }
}

class IndentationOnBlock : public testing::Test {
 protected:
  static void SetUpTestSuite() { block_ = std::make_unique<Block>(0.0016); }
  static void TearDownTestSuite() { block_.reset(); }
  static std::unique_ptr<Block> block_;
};
std::unique_ptr<Block> IndentationOnBlock::block_;

TEST_F(IndentationOnBlock, WorkAlongThePathIsTheStoredEnergy) {
  const Indentation indentation = block_->press(straight_down(400));
  double work = 0.0;
  for (std::size_t k = 1; k < indentation.sample.size(); ++k) {
    const auto& a = indentation.sample[k - 1];
    const auto& b = indentation.sample[k];
    work += 0.5 * (a.force_n.z() + b.force_n.z()) * (b.penetration_m - a.penetration_m);
  }
  // Trapezoids on a curve of bounded curvature, 400 steps.
  EXPECT_NEAR(work, indentation.sample.back().energy_j,
              1e-4 * indentation.sample.back().energy_j);
}

TEST_F(IndentationOnBlock, ComplianceIsReciprocalToRounding) {
  // Solved one by one, without the symmetric storage.
  const CholeskyFactor factor(
      reduce(assemble_stiffness(block_->mesh, kGel), block_->supports));
  const auto pair = [&](std::int32_t v, std::int32_t w) {
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(factor.size(), 2);
    const std::int32_t of[2] = {v, w};
    for (int k = 0; k < 2; ++k) {
      for (const NodalForce& entry :
           block_->surface.node[static_cast<std::size_t>(of[k])].load) {
        for (int axis = 0; axis < 3; ++axis) {
          b(block_->supports
                .free_index[static_cast<std::size_t>(3 * entry.node + axis)],
            k) += entry.force[axis];
        }
      }
    }
    const Eigen::MatrixXd x = factor.solve(b);
    return std::pair(b.col(0).dot(x.col(1)), b.col(1).dot(x.col(0)));
  };
  const auto [vw, wv] = pair(block_->patch.front(), block_->patch.back());
  EXPECT_NEAR(vw, wv, 1e-10 * std::abs(vw));
  const Eigen::MatrixXd A = block_->compliance->among(block_->patch);
  EXPECT_NEAR(A(0, A.cols() - 1), vw, 1e-10 * std::abs(vw));
}

TEST_F(IndentationOnBlock, ColumnsKeepWhatIsNearOfTheComplianceOfAllPairs) {
  constexpr double kNear = 0.003;
  const auto& [patch, surface] = std::tie(block_->patch, block_->surface);
  const SurfaceCompliance columns(*block_->factor, block_->supports, surface, patch,
                                  kNear, {}, nullptr);
  const Eigen::MatrixXd near = columns.among(patch);
  const Eigen::MatrixXd all = block_->compliance->among(patch);
  for (std::size_t j = 0; j < patch.size(); ++j) {
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const auto& at = [&](std::size_t k) {
        return surface.node[static_cast<std::size_t>(patch[k])].position_m;
      };
      const auto row = static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(j);
      const bool kept = (at(i) - at(j)).norm() <= kNear;
      EXPECT_NEAR(near(row, column), kept ? all(row, column) : 0.0,
                  1e-12 * all.maxCoeff());
    }
  }
  const std::span some(patch.data() + 3, 5);
  EXPECT_EQ(block_->compliance->between(patch, some), all.middleCols(3, 5));
}

TEST_F(IndentationOnBlock, ForceScalesWithTheModulusAndEndsAtTheLargestForce) {
  IndentationPath path = straight_down();
  const Indentation free = block_->press(path);
  path.force_max_n = 0.5 * free.sample.back().force_n.norm();
  const Indentation capped = block_->press(path);
  EXPECT_TRUE(capped.force_capped);
  EXPECT_LT(capped.sample.size(), free.sample.size());
  EXPECT_GT(capped.sample.back().force_n.norm(), path.force_max_n);
  EXPECT_LE(capped.sample[capped.sample.size() - 2].force_n.norm(), path.force_max_n);
}

TEST_F(IndentationOnBlock, ResponseCarriesMagnitudeDirectionAndWork) {
  const IndentationPath path = straight_down();
  const Indentation indentation = block_->press(path);
  const NodeResponse response = to_response(indentation, path, 0.05);
  EXPECT_EQ(response.origin, ResponseOrigin::kSimulated);
  EXPECT_GT(response.direction.z(), 0.999);
  EXPECT_LT(response.direction_spread_rad, 0.02);
  EXPECT_EQ(response.depth_m.front(), 0.0);
  EXPECT_EQ(response.force_n.front(), 0.0);
  EXPECT_DOUBLE_EQ(response.force_n.back(), indentation.sample.back().force_n.norm());
  EXPECT_GT(response.error_relative, 0.0);
}

TEST_F(IndentationOnBlock, AToolThatNeverTouchesGivesNoResponse) {
  IndentationPath path = straight_down();
  path.depth_max_m = 1e-9;  // less than the first touch
  const Indentation indentation = block_->press(path);
  EXPECT_EQ(indentation.sample.size(), 1U);
  EXPECT_EQ(to_response(indentation, path, 0.05).origin, ResponseOrigin::kNone);
}

TEST_F(IndentationOnBlock, HeldNodesTakeNoPartInTheContact) {
  for (const std::int32_t v :
       contact_patch(block_->surface, block_->supports, block_->centre,
                     Eigen::Vector3d::UnitZ(), 1.0)) {
    EXPECT_GT(block_->surface.node[static_cast<std::size_t>(v)].position_m.z(), -kHalf);
  }
}

// A force of 1 N, then 4 N, that leans by `turn` more at the end than at the start.
Indentation leaning_by(double turn) {
  Indentation indentation;
  for (const double k : {0.0, 1.0, 2.0}) {
    const double angle = turn * (k - 1.0);
    indentation.sample.push_back(
        {.penetration_m = 1e-3 * k,
         .force_n = k * k * Eigen::Vector3d(std::sin(angle), 0.0, std::cos(angle))});
  }
  return indentation;
}

TEST(Response, OfTwoWaysToTellTheMeshesErrorTheLargerCounts) {
  Indentation finer = leaning_by(0.0);
  for (IndentationSample& sample : finer.sample) {
    sample.coarse_force_n = 0.98 * sample.force_n.norm();
  }
  Indentation coarse = finer;
  const auto response = [](const Indentation& of) {
    return to_response(of, straight_down(), 0.05);
  };
  for (const double off : {0.01, 0.04}) {
    for (std::size_t k = 0; k < coarse.sample.size(); ++k) {
      coarse.sample[k].force_n = (1.0 + off) * finer.sample[k].force_n;
    }
    finer.mesh_error = 0.0;
    finer.mesh_error =
        mesh_error(response(coarse), response(finer), Eigen::Vector3d::UnitZ());
    EXPECT_NEAR(finer.mesh_error, 0.55 * off, 1e-12);
    EXPECT_NEAR(response(finer).error_relative,
                std::hypot(0.55 * std::max(off, 0.02), 0.2 * 0.05), 1e-12);
  }
}

// Of forces that lean by a tangent which grows with depth the tilt is kept exactly; the
// mean direction is its value where the work's middle is.
TEST(Response, KeepsTheTiltThatGrowsWithDepth) {
  Indentation indentation;
  for (int k = 0; k <= 10; ++k) {
    const double past_touch_m = 1e-4 * k;
    indentation.sample.push_back(
        {.penetration_m = 2e-4 + past_touch_m,
         .force_n =
             k * std::sqrt(k) * Eigen::Vector3d(0.1 + 200.0 * past_touch_m, 0.0, 1.0)});
  }
  const NodeResponse response = to_response(indentation, straight_down(), 0.5);
  ASSERT_TRUE(response.tilt);
  EXPECT_NEAR(response.tilt->tilt.x(), 0.1, 1e-12);
  EXPECT_NEAR(response.tilt->by_depth_per_m.x(), 200.0, 1e-9);
  EXPECT_NEAR(response.tilt->tilt.z(), 0.0, 1e-15);
  IndentationPath stuck = straight_down();
  ToolShape shape = sphere(kRadius);
  shape.sticking = true;
  stuck.tool = std::make_shared<const ToolSurface>(shape);
  const NodeResponse sticking = to_response(indentation, stuck, 0.5);
  EXPECT_NEAR(sticking.tilt->tilt.x(), sticking.direction.x() / sticking.direction.z(),
              1e-12);
  EXPECT_EQ(sticking.tilt->by_depth_per_m, Eigen::Vector3d::Zero());
  // The constant tilt misses what the line has.
  EXPECT_GT(sticking.error_relative, response.error_relative);
}

// At 1, 4 and 9 N the force leans to one side, not, and to it again: a line cannot.
TEST(Response, CountsWhatTheTiltsLineMisses) {
  const auto error_of = [](double lean) {
    Indentation indentation;
    for (int k = 0; k <= 3; ++k) {
      indentation.sample.push_back(
          {.penetration_m = 1e-3 * k,
           .force_n = k * k * Eigen::Vector3d(k == 2 ? 0.0 : lean, 0.0, 1.0)});
    }
    for (IndentationSample& sample : indentation.sample) {
      sample.coarse_force_n = sample.force_n.norm();
    }
    return to_response(indentation, straight_down(), 0.5).error_relative;
  };
  const double least = error_of(0.0);
  EXPECT_NEAR(least, 0.2 * 0.5, 1e-12);
  EXPECT_GT(std::sqrt(std::pow(error_of(0.04), 2) - least * least), 0.01);
  EXPECT_LT(std::sqrt(std::pow(error_of(0.04), 2) - least * least), 0.04);
}

TEST(Response, KeepsDirectionsPerDepthWhereOneCostsMoreThanTheBudget) {
  const NodeResponse straight = to_response(leaning_by(0.04), straight_down(), 0.05);
  EXPECT_TRUE(straight.sample_direction.empty());
  const NodeResponse leaning = to_response(leaning_by(0.4), straight_down(), 0.05);
  ASSERT_EQ(leaning.sample_direction.size(), 3U);
  EXPECT_NEAR(leaning.sample_direction[1].x(), 0.0, 1e-15);
  EXPECT_NEAR(leaning.sample_direction[2].x(), std::sin(0.4), 1e-15);
  for (const Eigen::Vector3d& direction : leaning.sample_direction) {
    EXPECT_NEAR(direction.norm(), 1.0, 1e-15);
  }
  const ResponseTable table = make_table(straight_down().tool->shape(),
                                         {straight, leaning, NodeResponse{}, leaning});
  EXPECT_EQ(table.direction_begin, (std::vector<std::int64_t>{0, 0, 3, 3, 6}));
  EXPECT_NEAR(table.sample_direction(5, 0), std::sin(0.4), 1e-15);
}

}  // namespace
}  // namespace palpate
