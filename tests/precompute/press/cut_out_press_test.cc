#include "precompute/press/cut_out_press.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/press/surface_displacement.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/study_bodies.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kContact_m = 1e-3;
constexpr double kEdge_m = 0.7e-3;
constexpr double kBall_m = 10e-3;
constexpr double kDepth_m = kContact_m * kContact_m / kBall_m;

// A slab of equal triangles on a table, pressed in the middle of its top, vertex 0.
class Slab : public testing::Test {
 protected:
  Slab() {
    constexpr int kCells = 20;
    body_.surface = graded_block(0.5 * kCells * kEdge_m, 5.0 * kContact_m,
                                 (0.5 * kCells - 1.0) * kEdge_m, kCells - 2);
    body_.normal = vertex_normals(body_.surface);
    body_.material = {linear(10e3, 0.45)};
    body_.tool = {std::make_shared<const ToolSurface>(sphere(kBall_m))};
    scene_.support.resize(1);
    scene_.support[0].box_m = Eigen::AlignedBox3d(
        Eigen::Vector3d::Constant(-1), Eigen::Vector3d(1, 1, -4.999 * kContact_m));
    scene_.tool = {sphere(kBall_m)};
    scene_.reach.depth_max_m = kDepth_m;
    scene_.accuracy.depths = 3;
  }

  [[nodiscard]] BodyModel whole() const {
    BodyModel model = make_body_model(scene_, body_, body_.surface);
    model.contact_spacing_m = 0.5 * kEdge_m;
    return model;
  }
  [[nodiscard]] double whole_force_n() const {
    const std::int32_t vertex = 0;
    return force_n(
        press_on_model(scene_, body_, whole(), body_.tool[0], std::span(&vertex, 1), {})
            .front());
  }
  [[nodiscard]] PressedNode cut(double radius_m, const std::string& exterior) {
    scene_.cutout = SceneCutout{radius_m, exterior, 0.5 * radius_m};
    const std::int32_t vertex = 0;
    const CutOutSolver solver(scene_, body_, body_.surface, 0.5 * kEdge_m,
                              std::span(&vertex, 1));
    return solver.press(body_.tool[0], std::span(&vertex, 1)).front();
  }
  static double force_n(const PressedNode& node) {
    return node.indentation.sample.back().force_n.norm();
  }

  Scene scene_;
  BodySource body_;
};

// Contact nodes in the order of their places: every mesh has its own.
std::vector<Eigen::Index> by_place(const BodyModel& model,
                                   const std::vector<std::int32_t>& nodes) {
  std::vector<Eigen::Index> order(nodes.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto at = [&](Eigen::Index i) {
    const Eigen::Vector3d& p =
        model.contact.node[static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)])]
            .position_m;
    return std::array{p.x(), p.y(), p.z()};
  };
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return at(a) < at(b);
  });
  return order;
}

TEST_F(Slab, AClampedPartAndTheBodysOwnAnswerAtTheCutAreTheWholeBody) {
  scene_.cutout = SceneCutout{5.0 * kContact_m, "clamped", 0.0};
  const std::int32_t vertex = 0;
  const CutOutSolver solver(scene_, body_, body_.surface, 0.5 * kEdge_m,
                            std::span(&vertex, 1));
  const ClampedPart part = solver.part(std::span(&vertex, 1), 5.0 * kContact_m);
  ASSERT_FALSE(part.cut.empty());
  const CoarseBody same(whole());
  const auto placed = [&](const BodyModel& model) {
    return std::vector{placed_node(scene_, body_, model, body_.tool[0], vertex)};
  };
  const auto of_whole = placed(same.model());
  const auto of_part = placed(part.model);
  const auto& patch = of_part[0].patch;
  ASSERT_EQ(patch.size(), of_whole[0].patch.size());
  const Eigen::MatrixXd clamped =
      compliance_of(part.model, of_part, {}, nullptr).among(patch);
  const Eigen::MatrixXd together = clamped + same.exterior_compliance(part, patch);
  const auto in_part = by_place(part.model, patch);
  const auto in_whole = by_place(same.model(), of_whole[0].patch);
  const Eigen::MatrixXd wanted = compliance_of(same.model(), of_whole, {}, nullptr)
                                     .among(of_whole[0].patch)(in_whole, in_whole);
  // Rounding: of solves with condition numbers of about 1e6.
  EXPECT_LT((together(in_part, in_part) - wanted).norm(), 1e-9 * wanted.norm());
  EXPECT_GT((clamped(in_part, in_part) - wanted).norm(), 1e-3 * wanted.norm());
}

TEST_F(Slab, APartsFieldBeforeTheBodyItselfIsTheBodysField) {
  scene_.cutout = SceneCutout{5.0 * kContact_m, "clamped", 0.0};
  const std::int32_t vertex = 0;
  const CutOutSolver solver(scene_, body_, body_.surface, 0.5 * kEdge_m,
                            std::span(&vertex, 1));
  const ClampedPart part = solver.part(std::span(&vertex, 1), 5.0 * kContact_m);
  ASSERT_FALSE(part.cut.empty());
  const CoarseBody same(whole());
  const std::vector<PressedNode> of_part =
      solver.press_on(part, body_.tool[0], std::span(&vertex, 1));
  std::vector<PressedNode> of_whole{
      placed_node(scene_, body_, same.model(), body_.tool[0], vertex)};
  // The same pressures on the whole.
  of_whole[0].indentation = of_part[0].indentation;
  Eigen::VectorXd& pressure_n = of_whole[0].indentation.sample.back().pressure_n;
  const auto in_part = by_place(part.model, of_part[0].patch);
  const auto in_whole = by_place(same.model(), of_whole[0].patch);
  for (std::size_t i = 0; i < in_part.size(); ++i) {
    pressure_n[in_whole[i]] =
        of_part[0].indentation.sample.back().pressure_n[in_part[i]];
  }
  const Eigen::Index vertices = body_.surface.position_m.rows();
  std::vector<TetLocator::Place> place;
  for (Eigen::Index v = 0; v < vertices; ++v) {
    place.push_back(same.place(body_.surface.position_m.row(v).transpose()));
  }
  const PressFields wanted = press_fields(same.model(), vertices, of_whole);
  const PressFields together = part_fields(part, &same, place, vertices, of_part);
  const PressFields clamped = part_fields(part, nullptr, {}, vertices, of_part);
  ASSERT_GT(wanted.field_m.norm(), 0.0);
  EXPECT_EQ(together.node, wanted.node);
  EXPECT_EQ(together.depth_m, wanted.depth_m);
  EXPECT_LT((together.field_m - wanted.field_m).norm(), 1e-9 * wanted.field_m.norm());
  EXPECT_GT((clamped.field_m - wanted.field_m).norm(), 1e-2 * wanted.field_m.norm());
}

TEST_F(Slab, AClampedPartIsStifferAndTheCoarseBodyTakesMostOfThatAway) {
  const double whole_n = whole_force_n();
  const double clamped = force_n(cut(5.0 * kContact_m, "clamped")) / whole_n - 1.0;
  const double coarse = force_n(cut(5.0 * kContact_m, "coarse")) / whole_n - 1.0;
  EXPECT_GT(clamped, 0.01);
  EXPECT_LT(std::abs(coarse), 0.25 * clamped);
}

TEST_F(Slab, TheEstimateBoundsWhatTheCutCosts) {
  const double whole_n = whole_force_n();
  for (const char* exterior : {"clamped", "coarse"}) {
    const PressedNode node = cut(5.0 * kContact_m, exterior);
    EXPECT_GT(node.indentation.exterior_error_relative,
              std::abs(force_n(node) / whole_n - 1.0))
        << exterior;
  }
}

// A stone whose top lies a contact's radius under the tool.
TEST_F(Slab, AnInclusionIsCutWithTheBody) {
  const double soft_n = whole_force_n();
  body_.inner = {{.surface = sphere_surface({0.0, 0.0, -2.5 * kContact_m},
                                            1.5 * kContact_m, kEdge_m)}};
  body_.material.push_back(linear(100e3, 0.45));
  const double whole_n = whole_force_n();
  EXPECT_GT(whole_n, 1.1 * soft_n);
  for (const char* exterior : {"clamped", "coarse"}) {
    const PressedNode node = cut(5.0 * kContact_m, exterior);
    EXPECT_LT(std::abs(force_n(node) / whole_n - 1.0),
              node.indentation.exterior_error_relative)
        << exterior;
  }
}

TEST_F(Slab, APartThatIsTheBodyIsExact) {
  const PressedNode node = cut(1.0, "coarse");
  EXPECT_EQ(node.indentation.exterior_error_relative, 0.0);
  // The same tets in another order of nodes.
  EXPECT_NEAR(force_n(node) / whole_force_n(), 1.0, 1e-9);
}

TEST_F(Slab, ARadiusThatTheToolFillsIsRefused) {
  try {
    (void)cut(2.0 * kContact_m, "clamped");
    FAIL() << "was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("[cutout] radius_m is 0.002 m, must be at "
                        "least"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace palpate
