// One node in detail: what it must be in balance with, and the file for viewers.
#include "precompute/press/node_detail.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/press/vtu_file.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr const char* kFixed =
    "[[support]]\nbox_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.02]]\n";
constexpr const char* kBottom =
    "[[support]]\nbox_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1e-9]]\n";
constexpr const char* kFoundation =
    "[[support]]\nkind = \"foundation\"\nstiffness_pa_per_m = 1e6\nbox_m = "
    "[[-1.0, -1.0, -1.0], [1.0, 1.0, -0.01]]\n";

// A ball of 0.03 m that is held from below, and a smaller ball that presses it.
class NodeDetails : public testing::Test {
 protected:
  NodeDetails() { write_obj(icosphere(0.03, 2), folder_ / "ball.obj", "a ball"); }

  Scene scene(const std::string& law, const std::string& support = kFixed,
              double depth_m = 0.005, int depths = 6) const {
    return scene_of(
        fmt::format("law = \"{}\"\nyoungs_modulus_pa = 6000.0\npoissons_ratio = 0.4\n",
                    law),
        support, depth_m, depths);
  }

  // @param law the material's keys.
  Scene scene_of(const std::string& law, const std::string& support, double depth_m,
                 int depths) const {
    std::ofstream(folder_ / "scene.toml") << fmt::format(
        R"([body]
mesh = "ball.obj"
length_unit = "m"
[[material]]
region = "body"
{}{}[[tool]]
name = "tip"
shape = "sphere"
radius_m = 0.012
[reach]
depth_max_m = {}
[accuracy]
force_relative = 0.2
contact_resolution = 2.0
depths = {}
)",
        law, support, depth_m, depths);
    return read_scene(folder_ / "scene.toml");
  }

  static NodeDetail press(const Scene& scene,
                          const std::optional<NonlinearOptions>& options) {
    const BodySource body = read_body(scene);
    Progress quiet(nullptr);
    // Aside of the top, so that nothing is symmetric.
    const std::int64_t vertex = nearest_vertex(body.surface, {0.012, 0.005, 0.027});
    return press_in_detail(scene, body, body.tool.front(), vertex, options, quiet);
  }

  ScratchFolder folder_;
};

// Every tet by its law, and Newton's method to the end.
NonlinearOptions tight() {
  NonlinearOptions options{.near_gradient = 0.0};
  options.equilibrium.decrement_relative = 1e-13;
  options.equilibrium.multiplier_relative = 1e-3;
  options.equilibrium.gradient_tolerance = 1e-4;
  options.equilibrium.gradients_total = 20000;
  options.newton_per_depth = 200;
  options.equilibrium.newton_max = 200;
  return options;
}

TEST_F(NodeDetails, SupportsBearWhatTheToolPressesWithWhenAllTetsAreNear) {
  for (const char* support : {kFixed, kFoundation}) {
    const NodeDetail detail = press(scene("neo-hookean", support, 0.005, 2), tight());
    ASSERT_TRUE(detail.pressed.nonlinear && detail.pressed.failure.empty())
        << detail.pressed.failure;
    EXPECT_EQ(detail.pressed.checks.near_tets, detail.model.mesh.tet.rows());
    EXPECT_LT(detail.checks.force, 1e-6);
    EXPECT_LT(detail.checks.moment, 1e-6);
    EXPECT_EQ(detail.checks.theory_moment, 0.0);
  }
}

TEST_F(NodeDetails, AFarFieldAtRestStiffnessIsInBalanceAboutItsRestPosition) {
  NonlinearOptions options = tight();
  options.near_gradient = 0.05;
  const NodeDetail detail = press(scene("neo-hookean", kFixed, 0.005, 2), options);
  EXPECT_LT(detail.pressed.checks.near_tets, detail.model.mesh.tet.rows());
  EXPECT_LT(detail.checks.force, 1e-6);
  EXPECT_LT(detail.checks.moment, 1e-6);
  // Without its share the moments would not meet.
  EXPECT_GT(detail.checks.theory_moment, 1e-6);
  EXPECT_LT(detail.checks.theory_moment, 0.05);
}

// Laws with one Young's modulus and Poisson's ratio at small strain, or fibres beside.
TEST_F(NodeDetails, EveryLawIsPressedInBalanceAndTheWorkIsStored) {
  const std::string same = "youngs_modulus_pa = 6000.0\npoissons_ratio = 0.4\n";
  const double mu = 6000.0 / 2.8;
  const std::string poisson = "poissons_ratio = 0.4\n";
  const std::string fibre =
      "law = \"transversely-isotropic\"\nfibre = [1.0, 0.0, 0.0]\n";
  struct Law {
    std::string text;
    double least = 0.95;  // of the linear law's force, 0.2 mm deep
    double most = 1.05;
  };
  const std::vector<Law> laws{
      {"law = \"linear\"\n" + same},
      {"law = \"st-venant-kirchhoff\"\n" + same, 0.8,
       1.0},  // gives way when compressed
      {"law = \"neo-hookean\"\n" + same},
      {fmt::format("law = \"mooney-rivlin\"\nc10_pa = {}\nc01_pa = {}\n", 0.35 * mu,
                   0.15 * mu) +
       poisson},
      {fmt::format("law = \"ogden\"\nmu_pa = [{}]\nalpha = [8.0]\n", mu / 4.0) +
       poisson},
      {fibre + "fibre_law = \"exponential\"\nk1_pa = 5000.0\nk2 = 1.0\n" + same, 1.05,
       2.0},
      {fibre +
           "fibre_law = \"linear\"\nyoungs_modulus_fibre_pa = 20000.0\n"
           "youngs_modulus_pa = 6000.0\nshear_modulus_fibre_pa = 2500.0\n"
           "poissons_ratio_fibre = 0.3\npoissons_ratio = 0.4\nfinite_strain = true\n",
       0.8, 1.2}};
  // Rounder: where a tool touches a facet late, meshes are made finer.
  write_obj(icosphere(0.03, 3), folder_ / "ball.obj", "a rounder ball");
  const NonlinearOptions every_depth;
  double shallow_n = 0.0;  // of the linear law
  for (const Law& law : laws) {
    const NodeDetail small = press(scene_of(law.text, kFixed, 0.0002, 3), every_depth);
    const NodeDetail deep = press(scene_of(law.text, kFixed, 0.002, 4), every_depth);
    for (const NodeDetail* detail : {&small, &deep}) {
      EXPECT_EQ(detail->pressed.failure, "") << law.text;
      EXPECT_LT(detail->checks.force, 1e-2) << law.text;
      EXPECT_LT(detail->checks.moment, 1e-2) << law.text;
      EXPECT_LT(detail->checks.work, 0.02) << law.text;
    }
    const double force_n = small.pressed.indentation.sample.back().force_n.norm();
    shallow_n = shallow_n > 0.0 ? shallow_n : force_n;
    EXPECT_GT(force_n / shallow_n, law.least) << law.text;
    EXPECT_LT(force_n / shallow_n, law.most) << law.text;
  }
}

// A sharp rim folds to a side under the tool: updates of the contact's multipliers
// alone do not settle there.
TEST_F(NodeDetails, ASharpRimThatGivesWayIsPressedToTheEnd) {
  Scene ball = scene("neo-hookean", kBottom, 0.005, 20);
  ball.tool.front().radius_m = 0.005;
  ball.force_relative = 0.05;
  ball.contact_resolution = 0.0;
  write_obj(cylinder(0.02, 0.02, 5), folder_ / "ball.obj", "a cylinder");
  const BodySource body = read_body(ball);
  Progress quiet(nullptr);
  const std::int64_t rim = nearest_vertex(body.surface, {0.02, 0.0, 0.02});
  const NodeDetail detail =
      press_in_detail(ball, body, body.tool.front(), rim, NonlinearOptions{}, quiet);
  EXPECT_EQ(detail.pressed.failure, "");
  EXPECT_EQ(detail.pressed.indentation.sample.size(), 21U);
  EXPECT_LT(detail.checks.force, 1e-3);
  // Another place of the rim, on a mesh of its own: the same force within what is said.
  const NodeDetail other = press_in_detail(
      ball, body, body.tool.front(), nearest_vertex(body.surface, {0.0, 0.02, 0.02}),
      NonlinearOptions{}, quiet);
  const double force_n = detail.pressed.indentation.sample.back().force_n.norm();
  EXPECT_EQ(other.pressed.failure, "");
  EXPECT_NEAR(other.pressed.indentation.sample.back().force_n.norm(), force_n,
              0.02 * force_n);
}

TEST_F(NodeDetails, ALinearPressIsInBalanceToRounding) {
  for (const char* support : {kFixed, kFoundation}) {
    const NodeDetail detail = press(scene("linear", support), {});
    ASSERT_EQ(detail.pressed.nonlinear, nullptr);
    EXPECT_LT(detail.checks.force, 1e-9);
    EXPECT_LT(detail.checks.moment, 1e-9);
  }
}

TEST_F(NodeDetails, TheWorkIsTheStoredEnergy) {
  // So many depths that the curve between them adds nothing that shows.
  for (const char* law : {"linear", "neo-hookean"}) {
    const double work = press(scene(law, kFixed, 0.005, 10), tight()).checks.work;
    std::printf("%s: work off the stored energy by %.2g\n", law, work);
    EXPECT_LT(work, 1e-3);
  }
}

TEST_F(NodeDetails, ContactOverTheSupportIsNotCompared) {
  // Held up to a ring around the vertex that is pressed.
  const NodeDetail detail = press(
      scene("linear", "[[support]]\nbox_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 0.026]]\n",
            0.01),
      {});
  EXPECT_FALSE(std::isnan(detail.checks.work));
  EXPECT_TRUE(std::isnan(detail.checks.force));
}

TEST_F(NodeDetails, EveryDepthSaysWhatItCost) {
  const NodeDetail detail = press(scene("neo-hookean"), NonlinearOptions{});
  ASSERT_EQ(detail.depth.size(), detail.pressed.indentation.sample.size());
  for (std::size_t k = 1; k < detail.depth.size(); ++k) {
    EXPECT_GT(detail.depth[k].newton, 0);
    EXPECT_GE(detail.depth[k].gradients, detail.depth[k].newton);
    EXPECT_LT(detail.depth[k].smallest_jacobian, 1.0);
    EXPECT_GT(detail.depth[k].smallest_jacobian, 0.0);
  }
  EXPECT_EQ(detail.depth.front().newton, 0);
}

TEST_F(NodeDetails, AVertexThatIsHeldOrDoesNotExistIsRefused) {
  const Scene held = scene("linear");
  const BodySource body = read_body(held);
  Progress quiet(nullptr);
  const std::int64_t low = nearest_vertex(body.surface, {0.0, 0.0, -0.03});
  EXPECT_THROW((void)press_in_detail(held, body, body.tool.front(), low, {}, quiet),
               InputError);
  EXPECT_THROW((void)press_in_detail(held, body, body.tool.front(), 162, {}, quiet),
               InputError);
}

constexpr const char* kReader = R"(
import sys
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
r = vtkXMLUnstructuredGridReader()
r.SetFileName(sys.argv[1])
r.Update()
g = r.GetOutput()
u = vtk_to_numpy(g.GetPointData().GetArray("displacement"))
x = vtk_to_numpy(g.GetPoints().GetData())
d = vtk_to_numpy(g.GetCellData().GetArray("det_f"))
g.GetCellData().GetArray("region").GetTuple1(0)
print(g.GetNumberOfPoints(), g.GetNumberOfCells(), g.GetCellType(0),
      repr(float((u ** 2).sum())), repr(float((x ** 2).sum())), repr(float(d.min())))
)";

TEST_F(NodeDetails, VtkReadsTheDeformedBody) {
  constexpr const char* kPython = "/usr/bin/python3";  // Debian's, with its modules
  if (std::system(fmt::format("{} -c 'import vtkmodules.vtkIOXML' 2>/dev/null", kPython)
                      .c_str()) != 0) {
    GTEST_SKIP() << "python3-vtk9 is not installed";
  }
  const NodeDetail detail = press(scene("linear"), {});
  const QuadraticMesh& mesh = detail.model.mesh;
  const Eigen::VectorXd& u = detail.body.displacement_m;
  write_vtu(folder_ / "body.vtu", mesh, u, detail.body.near);
  std::ofstream(folder_ / "read.py") << kReader;
  FILE* pipe =
      ::popen(fmt::format("{} '{}' '{}'", kPython, (folder_ / "read.py").string(),
                          (folder_ / "body.vtu").string())
                  .c_str(),
              "r");
  long points = 0;
  long cells = 0;
  int type = 0;
  std::array<double, 3> read{};
  const int fields = std::fscanf(pipe, "%ld %ld %d %lf %lf %lf", &points, &cells, &type,
                                 read.data(), &read[1], &read[2]);
  ASSERT_EQ(::pclose(pipe), 0);
  ASSERT_EQ(fields, 6);
  EXPECT_EQ(points, mesh.position_m.rows());
  EXPECT_EQ(cells, mesh.tet.rows());
  EXPECT_EQ(type, 24);
  Eigen::VectorXd moved = u;
  for (Eigen::Index i = 0; i < points; ++i) {
    moved.segment<3>(3 * i) += mesh.position_m.row(i).transpose();
  }
  // Nine digits are written.
  EXPECT_NEAR(read[0] / u.squaredNorm(), 1.0, 1e-7);
  EXPECT_NEAR(read[1] / moved.squaredNorm(), 1.0, 1e-7);
  EXPECT_NEAR(read[2], detail.depth.back().smallest_jacobian, 1e-7);
}

}  // namespace
}  // namespace palpate
