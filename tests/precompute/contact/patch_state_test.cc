#include "precompute/contact/patch_state.h"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "precompute/contact/lateral_state.h"
#include "tests/precompute/contact/soft_block.h"

namespace palpate {
namespace {

constexpr double kBallM = 0.02;
constexpr double kPressM = 4e-4;
constexpr double kSoftPa = 10e3;
constexpr double kFineM = 0.0008;

IndentationPath into_top(const ToolShape& tool) {
  return {.vertex_m = Eigen::Vector3d::Zero(),
          .outward = Eigen::Vector3d::UnitZ(),
          .tool = std::make_shared<const ToolSurface>(tool),
          .depth_max_m = kPressM,
          .force_max_n = 1e9,
          .samples = 20};
}

// A press into the top of a block, with its states.
struct StuckPress : HeldBlock {
  StuckPress(const ToolShape& tool, double poissons_ratio, double fine_m)
      : HeldBlock(0.12, 0.004, fine_m, 2.2), path(into_top(tool)) {
    const std::array<Material, 1> gel{linear(kSoftPa, poissons_ratio)};
    const CholeskyFactor factor(reduce(assemble_stiffness(mesh, gel), supports));
    std::int32_t centre = -1;
    for (std::size_t i = 0; i < surface.node.size(); ++i) {
      if (surface.node[i].position_m.norm() < 1e-12) {
        centre = static_cast<std::int32_t>(i);
      }
    }
    patch = contact_patch(surface, supports, centre, Eigen::Vector3d::UnitZ(),
                          patch_radius_m(path, fine_m / 2));
    const SurfaceCompliance compliance(factor, supports, surface, patch);
    press = indent(surface, compliance, patch, path);
    add_pressure_states(surface, patch, path, press);
    add_lateral_states(factor, supports, surface, compliance, patch, path, press);
    contact = stored_contact(press, path);
  }
  [[nodiscard]] double last_n() const { return press.sample.back().force_n.z(); }

  IndentationPath path;
  std::vector<std::int32_t> patch;
  Indentation press;
  ContactTable contact;
};

const StuckPress& ball_press(double poissons_ratio) {
  static std::map<double, StuckPress> made;
  const auto at = made.find(poissons_ratio);
  return at != made.end()
             ? at->second
             : made.try_emplace(poissons_ratio, sphere(kBallM), poissons_ratio, kFineM)
                   .first->second;
}

// Mindlin: K = 8 a G / (2 - nu), of which the normal stiffness is 4 a G / (1 - nu).
TEST(PatchState, ABallThatSticksIsAsStiffAsMindlinSays) {
  for (const double nu : {0.3, 0.49}) {
    const StuckPress& ball = ball_press(nu);
    ASSERT_TRUE(ball.contact.has_lateral()) << nu;
    const double mindlin = 3.0 * (1.0 - nu) / (2.0 - nu);
    for (const double share : {0.25, 0.5, 1.0}) {
      const Eigen::Matrix2d S = lateral_at(ball.contact, 0, share);
      EXPECT_NEAR(S(0, 0) / mindlin, 1.0, 0.02) << nu << " at " << share;
      EXPECT_NEAR(S(1, 1) / mindlin, 1.0, 0.02) << nu << " at " << share;
      // Of a contact of few nodes the mesh's own lack of symmetry shows.
      EXPECT_NEAR(S(0, 1) / mindlin, 0.0, share < 0.5 ? 0.03 : 0.02) << nu << share;
    }
  }
}

// Hertz: a^2 = R d, p_0 = 3 N / (2 pi a^2).
TEST(PatchState, ABallsPressureIsHertzs) {
  const StuckPress& ball = ball_press(0.3);
  for (const double share : {0.25, 0.5, 1.0}) {
    const double a_m = std::sqrt(kBallM * share * kPressM);
    const ContactPressure at = pressure_at(ball.contact, 0, share, 1.0);
    const bool few = share < 0.5;  // a contact of fewer than four nodes to its edge
    EXPECT_NEAR(at.radius_m() / a_m, 1.0, few ? 0.05 : 0.03) << share;
    EXPECT_NEAR(at.middle_pa() / (1.5 / (std::numbers::pi * a_m * a_m)), 1.0,
                few ? 0.1 : 0.05)
        << share;
    EXPECT_NEAR(at.centre_m.norm() / a_m, 0.0, 0.01) << share;
  }
}

// Of a rigid punch the pressure is N / (2 pi a^2) in the middle, the stiffness 2 a E*.
TEST(PatchState, APunchsPressureAndStiffnessAreThoseOfAPunch) {
  constexpr double kPunchM = 0.0036;
  const StuckPress punch({.name = "punch", .kind = "flat-punch", .radius_m = kPunchM},
                         0.3, 0.0006);
  ASSERT_TRUE(punch.contact.has_lateral());
  const ContactPressure at = pressure_at(punch.contact, 0, 1.0, 1.0);
  EXPECT_NEAR(at.radius_m() / kPunchM, 1.0, 0.03);
  EXPECT_NEAR(at.middle_pa() / (0.5 / (std::numbers::pi * kPunchM * kPunchM)), 1.0,
              0.05);
  const double shear_pa = kSoftPa / 2.6;
  const double mindlin_n_per_m = 8.0 * kPunchM * shear_pa / 1.7;
  const double found_n_per_m =
      lateral_at(punch.contact, 0, 1.0)(0, 0) * punch.last_n() / kPressM;
  EXPECT_NEAR(found_n_per_m / mindlin_n_per_m, 1.0, 0.05);
}

TEST(PatchState, WithoutForceNothingIsStored) {
  Indentation none;
  none.sample.resize(5);
  EXPECT_TRUE(stored_contact(none, into_top(sphere(kBallM))).empty());
}

// A path that ends elsewhere stores its states at shares of its own end.
TEST(PatchState, AreStoredAtSharesOfThePathsOwnEnd) {
  const StuckPress& ball = ball_press(0.3);
  Indentation shorter = ball.press;
  shorter.sample.resize(15);  // 14/20 of the radius, 0.49 of the depth
  const ContactTable contact = stored_contact(shorter, ball.path);
  const double end_m = shorter.sample.back().penetration_m;
  const ContactPressure at = pressure_at(contact, 0, 1.0, 1.0);
  EXPECT_NEAR(at.radius_m() / std::sqrt(kBallM * end_m), 1.0, 0.03);
  EXPECT_NEAR(
      lateral_at(contact, 0, 1.0)(0, 0) / lateral_at(ball.contact, 0, 0.49)(0, 0), 1.0,
      0.02);
}

}  // namespace
}  // namespace palpate
