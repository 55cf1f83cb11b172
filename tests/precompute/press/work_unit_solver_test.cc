// Where a build checks itself.
#include "precompute/press/work_unit_solver.h"

#include <algorithm>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/organ_scene.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class Checks : public testing::Test {
 protected:
  Checks() { write_obj(organ(3), folder_ / "organ.obj", ""); }

  void read(const std::string& more) {
    std::ofstream(folder_ / "scene.toml")
        << organ_on_table("linear") << kBallOnTop << more;
    scene_ = read_scene(folder_ / "scene.toml");
    body_ = read_body(scene_);
    reachable_ = reachable_vertices(scene_, body_);
  }

  [[nodiscard]] std::vector<WorkUnit> checks() const {
    std::vector<WorkUnit> checks = units_of(scene_, body_, reachable_);
    std::erase_if(checks, [](const WorkUnit& unit) {
      return !unit.is_check;
    });
    return checks;
  }

  ScratchFolder folder_;
  Scene scene_;
  BodySource body_;
  std::vector<std::int32_t> reachable_;
};

TEST_F(Checks, AreDrawnByAreaOverWhatIsReachable) {
  read("verify = 4000\n");
  double area_beyond_m2 = 0.0;
  double area_m2 = 0.0;
  const auto middle_y = [&](std::int32_t t) {
    double y = 0.0;
    for (int j = 0; j < 3; ++j) {
      y += body_.surface.position_m(body_.surface.triangle(t, j), 1) / 3.0;
    }
    return y;
  };
  constexpr double kBeyond_m = 0.004;
  for (std::int32_t t = 0; t < body_.surface.triangle.rows(); ++t) {
    const auto corner = body_.surface.triangle.row(t);
    const bool open = std::all_of(corner.begin(), corner.end(), [&](std::int32_t v) {
      return std::binary_search(reachable_.begin(), reachable_.end(), v);
    });
    if (open) {
      const double area = surface_area_m2({body_.surface.position_m, corner});
      area_m2 += area;
      area_beyond_m2 += middle_y(t) > kBeyond_m ? area : 0.0;
    }
  }
  const double share = area_beyond_m2 / area_m2;
  ASSERT_GT(share, 0.2);
  ASSERT_LT(share, 0.8);
  double beyond = 0.0;
  double between = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const WorkUnit& check : checks()) {
    ASSERT_EQ(check.vertex.size(), 1U);
    EXPECT_TRUE(
        std::binary_search(reachable_.begin(), reachable_.end(), check.vertex.front()));
    ASSERT_GE(check.place.triangle, 0);
    const Eigen::Vector3d& b = check.place.area_coordinate;
    EXPECT_NEAR(b.sum(), 1.0, 1e-15);
    for (int j = 0; j < 3; ++j) {
      EXPECT_TRUE(b(j) == 0.0 || (b(j) >= 0.1 && b(j) <= 0.9)) << b.transpose();
      const std::int32_t v = body_.surface.triangle(check.place.triangle, j);
      EXPECT_TRUE(std::binary_search(reachable_.begin(), reachable_.end(), v));
      EXPECT_TRUE(b(j) < b.maxCoeff() || v == check.vertex.front());
    }
    between += 1.0;
    beyond += middle_y(check.place.triangle) > kBeyond_m ? 1.0 : 0.0;
    mean += b;
  }
  // Four standard deviations.
  EXPECT_NEAR(beyond / between, share, 4.0 * std::sqrt(0.25 / between));
  EXPECT_LT((mean / between - Eigen::Vector3d::Constant(1.0 / 3.0)).norm(), 0.03);
}

TEST_F(Checks, AreTheSameEachTimeAndTheFirstOfMore) {
  read("verify = 5\n");
  const std::vector<WorkUnit> few = checks();
  read("verify = 9\n");
  const std::vector<WorkUnit> more = checks();
  ASSERT_EQ(few.size(), 5U);
  ASSERT_EQ(more.size(), 9U);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].place.triangle, more[i].place.triangle);
    EXPECT_EQ(few[i].place.area_coordinate, more[i].place.area_coordinate);
  }
}

TEST_F(Checks, AreAtVerticesWhereNoTriangleIsReachable) {
  read("verify = 3\n");
  const double top_m = body_.surface.position_m.col(2).maxCoeff();
  std::erase_if(reachable_, [&](std::int32_t v) {
    return body_.surface.position_m(v, 2) < top_m;
  });
  ASSERT_FALSE(reachable_.empty());
  const std::vector<WorkUnit> found = checks();
  EXPECT_EQ(found.size(), std::min<std::size_t>(3, reachable_.size()));
  for (const WorkUnit& check : found) {
    EXPECT_EQ(check.place.triangle, -1);
  }
}

// At a vertex a mesh as fine as the build's would be the build's own.
TEST(CheckMeshes, AreFinerWhereTheBuildMayHavePressedTheSame) {
  const SurfacePoint between{.triangle = 0, .area_coordinate = {0.2, 0.3, 0.5}};
  PressStrategy strategy;
  EXPECT_EQ(check_times_finer(strategy, between), kLinearCheckTimesFiner);
  EXPECT_EQ(check_times_finer(strategy, {}), kLinearCheckTimesFiner);
  strategy.nonlinear = true;
  EXPECT_EQ(check_times_finer(strategy, between), 1.0);
  EXPECT_EQ(check_times_finer(strategy, {}), kNonlinearCheckTimesFiner);
}

// A place is pressed where it is: the same force as at a vertex there, of a body that
// has one.
TEST_F(Checks, PressThePlaceAsAVertexThere) {
  read("verify = 1\n");
  const WorkUnit check = checks().front();
  ASSERT_GE(check.place.triangle, 0);
  const BodySource more = with_vertex_at(body_, check.place);
  EXPECT_NEAR(more.normal.row(more.normal.rows() - 1).norm(), 1.0, 1e-15);
  const PressStrategy strategy = choose_strategy(scene_, body_, reachable_);
  Progress quiet(nullptr);
  const SceneSolver solver(scene_, body_, strategy, reachable_, reachable_, quiet);
  const WorkUnitOutcome outcome =
      solve_unit(scene_, body_, strategy, solver, check, false);
  ASSERT_EQ(outcome.node.size(), 1U);
  EXPECT_EQ(outcome.node.front().vertex, check.vertex.front());
  EXPECT_EQ(outcome.place.triangle, check.place.triangle);
  ASSERT_GT(outcome.node.front().response.depth_m.size(), 2U)
      << outcome.node.front().failure;
  const auto added = static_cast<std::int32_t>(body_.surface.position_m.rows());
  const SceneSolver other(scene_, more, strategy, {&added, 1}, {&added, 1}, quiet);
  const PressedNode there =
      other.reference(more.tool.front(), added, {}, kLinearCheckTimesFiner);
  EXPECT_EQ(there.indentation.sample.back().force_n.norm(),
            solver
                .reference(body_.tool.front(), check.vertex.front(), check.place,
                           kLinearCheckTimesFiner)
                .indentation.sample.back()
                .force_n.norm());
}

}  // namespace
}  // namespace palpate
