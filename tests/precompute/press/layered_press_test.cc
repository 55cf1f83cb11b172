// A ball on an elastic layer that is bonded to an elastic half-space, without friction:
// the transform of its surface's displacement is known (Burmister 1945), and the
// contact follows from a Fredholm equation of the second kind (Lebedev and Ufliand
// 1958). Letters: T(x) = compliance over that of the layer's material alone at wave
// number x / h, lambda and kappa of Nogi and Kato (1997), phi: the pressure's transform
// is the integral of phi(t) cos(xi t) over 0 < t < a.
#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/body/meshed_body.h"
#include "precompute/press/own_mesh_press.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

struct Layered {
  double layer_pa = 0.0;  // Young's moduli
  double below_pa = 0.0;
  double poissons_ratio = 0.4;  // of both
  double thickness_m = 1e-3;
};

double shear_pa(double young_pa, double poissons_ratio) {
  return young_pa / (2.0 * (1.0 + poissons_ratio));
}

double kernel(const Layered& body, double x) {
  const double nu = body.poissons_ratio;
  const double mu = body.layer_pa / body.below_pa;
  const double lambda = 1.0 - 4.0 * (1.0 - nu) / (1.0 + mu * (3.0 - 4.0 * nu));
  const double kappa = (mu - 1.0) / (mu + 3.0 - 4.0 * nu);
  const double e = std::exp(-2.0 * x);
  return (1.0 + 4.0 * x * kappa * e - lambda * kappa * e * e) /
         (1.0 - (lambda + kappa + 4.0 * kappa * x * x) * e + lambda * kappa * e * e);
}

double simpson_weight(int i, int n) {
  return (i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) / 3.0;
}

// Force and depth of a ball whose contact has a radius.
std::pair<double, double> ball_on_layer(const Layered& body, double ball_m, double a) {
  constexpr int kPlaces = 40;
  constexpr int kWaves = 2000;
  const double h = body.thickness_m;
  const double C =
      (1.0 - body.poissons_ratio) / shear_pa(body.layer_pa, body.poissons_ratio);
  const double dxi = 15.0 / h / kWaves;  // beyond, T is 1 to 1e-10
  const double dt = a / kPlaces;
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(kPlaces + 1, kPlaces + 1);
  for (int w = 0; w <= kWaves; ++w) {
    const double xi = w * dxi;
    const double more = simpson_weight(w, kWaves) * dxi * (kernel(body, xi * h) - 1.0);
    for (int i = 0; i <= kPlaces; ++i) {
      for (int j = 0; j <= kPlaces; ++j) {
        A(i, j) += 2.0 / std::numbers::pi * more * simpson_weight(j, kPlaces) * dt *
                   std::cos(xi * i * dt) * std::cos(xi * j * dt);
      }
    }
  }
  Eigen::MatrixXd g(kPlaces + 1, 2);  // for a depth of 1, and for the ball's shape
  for (int i = 0; i <= kPlaces; ++i) {
    g(i, 0) = 2.0 / (std::numbers::pi * C);
    g(i, 1) = g(i, 0) * (i * dt) * (i * dt) / ball_m;
  }
  const Eigen::MatrixXd phi = A.partialPivLu().solve(g);
  const double depth_m = phi(kPlaces, 1) / phi(kPlaces, 0);  // no pressure at the rim
  double force_n = 0.0;
  for (int i = 0; i <= kPlaces; ++i) {
    force_n += 2.0 * std::numbers::pi * simpson_weight(i, kPlaces) * dt *
               (depth_m * phi(i, 0) - phi(i, 1));
  }
  return {force_n, depth_m};
}

// The same by elements, at some times the usual fineness.
double pressed_n(const Layered& body, double ball_m, double depth_m, double times) {
  const ScratchFolder folder;
  write_obj(graded_block(0.2, 0.2, 0.1, 2), folder / "block.obj", "a half-space");
  std::ofstream(folder / "layered.toml")
      << fmt::format(R"([body]
mesh = "block.obj"
length_unit = "m"
[[layer]]
name = "skin"
thickness_m = {}
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = {}
poissons_ratio = {}
[[material]]
region = "skin"
law = "linear"
youngs_modulus_pa = {}
poissons_ratio = {}
[[support]]
box_m = [[-1, -1, -1], [1, 1, -0.1999]]
[[tool]]
name = "ball"
shape = "sphere"
radius_m = {}
[reach]
depth_max_m = {}
)",
                     body.thickness_m, body.below_pa, body.poissons_ratio,
                     body.layer_pa, body.poissons_ratio, ball_m, depth_m);
  const Scene scene = read_scene(folder / "layered.toml");
  const BodySource source = read_body(scene);
  const std::int32_t middle = 0;
  const std::vector<PressedNode> pressed = press_on_own_mesh(
      scene, source, source.tool.front(), {&middle, 1},
      finer(contact_focus(scene, source), times), {.nonlinear = false});
  return pressed.front().indentation.sample.back().force_n.norm();
}

TEST(LayeredPress, TheReferenceIsHertzsWithoutALayerAndTheBondedLayersOnRock) {
  const auto [force_n, depth_m] = ball_on_layer({1e4, 1e4}, 0.01, 1e-3);
  EXPECT_NEAR(depth_m, 1e-4, 1e-12);
  EXPECT_NEAR(force_n / (4.0 / 3.0 * 1e4 / 0.84 * 1e-3 * 1e-4), 1.0, 1e-4);
  // Rigid base: (2 k sinh 2x - 4x) / (2 k cosh 2x + k^2 + 1 + 4 x^2), k = 3 - 4 nu.
  const double k = 3.0 - 4.0 * 0.4;
  for (const double x : {0.2, 1.0, 3.0}) {
    EXPECT_NEAR(kernel({1e4, 1e16}, x),
                (2 * k * std::sinh(2 * x) - 4 * x) /
                    (2 * k * std::cosh(2 * x) + k * k + 1 + 4 * x * x),
                1e-9);
  }
}

TEST(LayeredPress, MeetsTheLayeredHalfSpaceWithinTheBudgetAndHalfOfItOnFinerMeshes) {
  const double ball_m = 0.01;
  for (const auto& [layer_pa, below_pa] :
       {std::pair{1e5, 1e4}, std::pair{1e4, 1e4}, std::pair{1e4, 1e5}}) {
    const Layered body{layer_pa, below_pa};
    const auto [force_n, depth_m] = ball_on_layer(body, ball_m, 1e-3);
    const double coarse = pressed_n(body, ball_m, depth_m, 1.0) / force_n - 1.0;
    const double fine = pressed_n(body, ball_m, depth_m, 2.0) / force_n - 1.0;
    const std::string ratio = fmt::format("{:g}", layer_pa / below_pa);
    RecordProperty("off_" + ratio, fmt::format("{:+.4f}", coarse));
    RecordProperty("off_" + ratio + "_finer", fmt::format("{:+.4f}", fine));
    EXPECT_LT(std::abs(coarse), 0.05);  // the scene's budget
    EXPECT_LT(std::abs(fine), 0.5 * 0.05);
  }
}

}  // namespace
}  // namespace palpate
