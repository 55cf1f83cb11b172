// How contacts couple through a body: against closed forms, exact compliances, joint
// presses.
#include "precompute/press/contact_coupling.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "formats/response/response_curve.h"
#include "precompute/build/plan_coupling.h"
#include "precompute/press/contact_spot.h"
#include "precompute/press/coupling_modes.h"
#include "precompute/press/joint_presses.h"
#include "precompute/process/machine_memory.h"
#include "precompute/process/peak_memory.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kStiffness_pa = 6000.0 / (1.0 - 0.3 * 0.3);  // E*

// A deep block on a table, pressed in the middle of its top by balls.
class ContactCoupling : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const ScratchFolder folder;
    write_obj(graded_block(0.06, 0.06, 0.04, 8), folder / "block.obj", "a test");
    std::ofstream(folder / "scene.toml")
        << "[body]\nmesh = \"block.obj\"\nlength_unit = \"m\"\n"
           "[[material]]\nregion = \"body\"\nlaw = \"linear\"\n"
           "youngs_modulus_pa = 6000.0\npoissons_ratio = 0.3\n"
           "[[support]]\nbox_m = [[-1, -1, -1], [1, 1, -0.0599]]\nkind = \"fixed\"\n"
           "[[tool]]\nname = \"pads\"\nshape = \"spheres\"\nradius_m = 0.018\n"
           "centre_m = [[0, 0, 0], [0.02, 0, 0]]\n"
           "[reach]\ndepth_max_m = 0.003\n"
           "box_m = [[-0.021, -0.021, -0.001], [0.021, 0.021, 0.001]]\n"
           "[accuracy]\nforce_relative = 0.05\ndepths = 8\n";
    scene_ = new Scene(read_scene(folder / "scene.toml"));
    body_ = new BodySource(read_body(*scene_));
    vertices_ = reachable_vertices(*scene_, *body_);
    Progress silent(nullptr);
    table_ =
        new ComplianceTable(make_coupling_table(*scene_, *body_, vertices_, silent));
  }
  static void TearDownTestSuite() {
    delete table_;
    delete body_;
    delete scene_;
  }

  static Scene* scene_;
  static BodySource* body_;
  static ComplianceTable* table_;
  static std::vector<std::int32_t> vertices_;
};
Scene* ContactCoupling::scene_ = nullptr;
BodySource* ContactCoupling::body_ = nullptr;
ComplianceTable* ContactCoupling::table_ = nullptr;
std::vector<std::int32_t> ContactCoupling::vertices_;

TEST_F(ContactCoupling, NearbyIsThatOfAHalfSpace) {
  // The block's bottom and sides move a place by what hardly varies nearby: it cancels
  // between two distances. 1 / (pi E* r) of Boussinesq; spread over a spot of Hertz's
  // pressure, by <rho^2> / (4 r^2) = a^2 / (10 r^2) more.
  const ComplianceKnots knots = knots_of(*table_);
  const auto c = [&](double r) {
    return node_coupling_m_per_n(*table_, knots, 0, 0, r);
  };
  const double near_m = table_->distance_m[2];
  const double far_m = 2.0 * near_m;
  EXPECT_LT(far_m, 0.022);
  const double a_m = std::sqrt(0.018 * 0.0015);
  const auto spread = [&](double r) {
    return (1.0 + a_m * a_m / (10.0 * r * r)) / r;
  };
  const double expected =
      (spread(near_m) - spread(far_m)) / (std::numbers::pi * kStiffness_pa);
  EXPECT_NEAR((c(near_m) - c(far_m)) / expected, 1.0, 0.01);
  // Of the whole it is what a bottom at depth D holds back, about 1 / D.
  EXPECT_NEAR(c(near_m) * std::numbers::pi * kStiffness_pa * near_m, 1.0,
              1.5 * near_m / 0.06);
}

TEST_F(ContactCoupling, HeldPlacesDoNotMove) {
  for (Eigen::Index v = 0; v < body_->surface.position_m.rows(); ++v) {
    if (body_->surface.position_m(v, 2) < -0.0599) {
      EXPECT_EQ(table_->value.row(v).cwiseAbs().maxCoeff(), 0.0F);
    }
  }
  EXPECT_GT(table_->value.row(0).minCoeff(), -1e-3F);
  EXPECT_TRUE(table_->value.allFinite());
}

TEST_F(ContactCoupling, TwoPadsPressAsTheyDoTogether) {
  Progress silent(nullptr);
  const CouplingStudy study =
      coupling_errors(*scene_, *body_, body_->tool[0], vertices_, *table_,
                      {.sets = 4, .contacts = {2, 3}}, silent);
  ASSERT_EQ(study.by_count.size(), 2U);
  ASSERT_EQ(study.worst_by_table.size(), 4U);
  EXPECT_EQ(study.worst_by_table.back(), std::max(study.by_count[0].by_table.back(),
                                                  study.by_count[1].by_table.back()));
  for (const CouplingErrors& of : study.by_count) {
    ASSERT_EQ(of.sets, 4U);
    ASSERT_EQ(of.by_table.size(), 4 * of.contacts);
    EXPECT_LT(of.by_table.back(), 0.04);
    EXPECT_LT(of.by_spot.back(), 0.02);
    EXPECT_GT(of.alone.back(), 2.0 * of.by_table.back());
  }
}

TEST_F(ContactCoupling, SpotsAreHertz) {
  const BodyModel model =
      coupling_model(*scene_, *body_, 0.75 * table_->distance_m.front());
  const PressedNode placed =
      placed_node(*scene_, *body_, model, body_->tool[0], vertices_.front());
  const SurfaceCompliance compliance = compliance_of(model, {&placed, 1}, {}, nullptr);
  const PressureForces spot = contact_spot(model, compliance, placed);
  const Eigen::Vector3d centre_m =
      body_->surface.position_m.row(vertices_.front()).transpose();
  double force_n = 0.0;
  double moment = 0.0;
  for (std::size_t j = 0; j < spot.node.size(); ++j) {
    const auto& node = model.contact.node[static_cast<std::size_t>(spot.node[j])];
    force_n += spot.force_n[j];
    moment += spot.force_n[j] * (node.position_m - centre_m).squaredNorm();
  }
  EXPECT_NEAR(force_n, 1.0, 0.02);
  // 2 a^2 / 5; the body gives way, so that a is no larger than on a half-space.
  const double a_m = std::sqrt(0.018 * 0.0015);
  EXPECT_NEAR(moment / (0.4 * a_m * a_m), 1.0, 0.1);
  // 4 delta / 5 and delta = 3 / (4 E* a), less what a bottom at depth D holds back.
  const double self = between_spots(compliance, {&spot, 1})(0, 0);
  EXPECT_NEAR(self * kStiffness_pa * a_m / 0.6, 1.0, 0.1);
}

TEST_F(ContactCoupling, SetsKeepTheirDistances) {
  std::mt19937_64 random(3);
  const Points& position_m = body_->surface.position_m;
  const auto set = set_of_contacts(vertices_, position_m, {0.01, 0.03}, 4, random);
  ASSERT_EQ(set.size(), 4U);
  for (std::size_t i = 0; i < set.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((position_m.row(set[i]) - position_m.row(set[j])).norm(), 0.01);
    }
    EXPECT_LE((position_m.row(set[i]) - position_m.row(set[0])).norm(), 0.03);
  }
}

TEST_F(ContactCoupling, APlanCountsIt) {
  Progress silent(nullptr);
  Scene scene = *scene_;
  scene.accuracy.verify = 24;
  PlanReport report;
  plan_coupling(scene, *body_, vertices_, 2, silent, report);
  ASSERT_EQ(report.cost.size(), 2U);
  EXPECT_EQ(report.cost[0].count, 1);
  EXPECT_EQ(report.cost[1].count, 48);
  EXPECT_EQ(report.cost[1].timed, 2);
  EXPECT_GT(report.cost[1].seconds, 20.0 * report.cost[1].timed_seconds);
  // The factor of the table's mesh comes on top of what is there.
  const double first_m = coupling_distances(scene, *body_, vertices_).front();
  const double factor_bytes =
      expected_memory_bytes(coupling_surface(*body_, first_m).surface.triangle.rows());
  EXPECT_GT(static_cast<double>(report.peak_memory_bytes), factor_bytes + 1e7);
  EXPECT_LT(static_cast<double>(report.peak_memory_bytes - peak_memory_bytes()),
            factor_bytes + 1e7);
  scene.accuracy.verify = 9;  // 18 sets cannot tell what 95 % are within
  report = {};
  plan_coupling(scene, *body_, vertices_, 2, silent, report);
  EXPECT_EQ(report.cost.size(), 1U);
  scene.tool_couples = {false};
  report = {};
  plan_coupling(scene, *body_, vertices_, 2, silent, report);
  EXPECT_TRUE(report.cost.empty());
  EXPECT_EQ(report.peak_memory_bytes, 0);
}

TEST_F(ContactCoupling, CutOutsAreRefused) {
  Scene scene = *scene_;
  scene.cutout.emplace();
  EXPECT_THROW((void)coupling_model(scene, *body_, 0.005), InputError);
}

// Hertz's curve of a ball of 10 mm.
ResponseCurve ball() {
  std::vector<double> depth_m, force_n;
  for (int i = 0; i <= 20; ++i) {
    depth_m.push_back(2e-4 * i);
    force_n.push_back(800.0 * std::pow(2e-4 * i, 1.5));
  }
  return {depth_m, force_n};
}

TEST(CoupledForces, BringTheirPlacesToTheirDepths) {
  const ResponseCurve one = ball();
  const std::vector<CurveView> curves(3, one.view());
  const Eigen::Vector3d depth_m(0.003, 0.0035, 0.0002);
  Eigen::Matrix3d C;
  C << 9.0, 2e-3, 1e-2, 2e-3, 9.0, 5e-3, 1e-2, 5e-3, 9.0;
  const Eigen::VectorXd f = coupled_forces_n(curves, depth_m, C);
  C.diagonal().setZero();
  const Eigen::VectorXd delta_m = depth_m - C * f;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(one.view().at(delta_m[i]).force_n, f[i], 1e-9);
  }
  EXPECT_LT(delta_m[2], 0.0);  // lifted off by the others' dimple
  EXPECT_EQ(f[2], 0.0);
  const Eigen::VectorXd alone =
      coupled_forces_n(curves, depth_m, Eigen::Matrix3d::Zero());
  EXPECT_EQ(alone[1], one.view().at(0.0035).force_n);
}

TEST(CouplingModes, FindWhatDistanceDoesNotTell) {
  constexpr Eigen::Index kNodes = 40;
  std::srand(1);  // other tests may have drawn numbers
  const Points position_m = 0.05 * Points::Random(kNodes, 3);
  ComplianceTable table;
  table.distance_m = log_spaced(0.01, 0.2, 8);
  table.value = RowsOf<float>::Constant(kNodes, 8, 1e-5F);
  const Eigen::VectorXd tilt = Eigen::VectorXd::Random(kNodes);
  const Eigen::VectorXd other = Eigen::VectorXd::Random(kNodes);
  const ComplianceKnots knots = knots_of(table);
  std::vector<std::int32_t> nodes;
  Eigen::MatrixXd C(kNodes, kNodes);
  const auto apart_m = [&](Eigen::Index i, Eigen::Index j) {
    return (position_m.row(i) - position_m.row(j)).norm();
  };
  for (Eigen::Index i = 0; i < kNodes; ++i) {
    nodes.push_back(static_cast<std::int32_t>(i));
    for (Eigen::Index j = 0; j < kNodes; ++j) {
      C(i, j) = node_coupling_m_per_n(table, knots, i, j, apart_m(i, j)) +
                1e-3 * tilt[i] * tilt[j] - 5e-4 * other[i] * other[j];
    }
  }
  add_modes(C, nodes, position_m, table);
  EXPECT_EQ(table.modes(), kMostModes);
  double worst = 0.0;
  for (Eigen::Index i = 0; i < kNodes; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (apart_m(i, j) >= 0.01) {
        worst = std::max(
            worst, std::abs(node_coupling_m_per_n(table, knots, i, j, apart_m(i, j)) -
                            C(i, j)));
      }
    }
  }
  // Single precision of what is 1e-3 at most, by modes that differ.
  EXPECT_LT(worst, 1e-6);
}

}  // namespace
}  // namespace palpate
