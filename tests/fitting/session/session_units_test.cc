// Slips of the unit: what a session's positions and depths say beside its body.
#include "fitting/session/session_units.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.04;

// Twelve runs on a sphere that touches the origin, their positions times `factor`.
Session placed(double factor) {
  Session session;
  session.file = "lab.toml";
  session.length_unit = "mm";
  session.points_unit = "m";
  for (int i = 0; i < 12; ++i) {
    SessionRun run;
    run.name = "run";
    const double turn = 0.5 * i;
    const Eigen::Vector3d p(std::cos(turn), std::sin(turn), 1.0);
    run.position_m = factor * kRadius * p;
    session.run.push_back(run);
  }
  return session;
}

SurfaceMesh ball_on_origin() {
  SurfaceMesh mesh = sphere_surface(kRadius, 2);
  mesh.position_m.col(2).array() += kRadius;
  return mesh;
}

std::string refusal(double factor) {
  try {
    (void)unit_notes(placed(factor), ball_on_origin());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SessionUnits, RightOnesAreSilent) {
  EXPECT_TRUE(unit_notes(placed(1.0), ball_on_origin()).empty());
  EXPECT_TRUE(unit_notes(Session{}, ball_on_origin()).empty());
  Session one = placed(1.0);
  one.run.resize(1);
  EXPECT_TRUE(unit_notes(one, ball_on_origin()).empty());
}

TEST(SessionUnits, PositionsFarOffAreRefusedWithTheFactor) {
  const std::string text = refusal(1000.0);
  EXPECT_NE(text.find("lab.toml: 12 of 12 positions"), std::string::npos) << text;
  EXPECT_NE(text.find("times 0.001 they lie on it"), std::string::npos) << text;
  EXPECT_NE(text.find("length_unit of [points], now \"m\""), std::string::npos) << text;
  EXPECT_NE(text.find("length_unit of [body], now \"mm\""), std::string::npos) << text;
}

TEST(SessionUnits, PositionsInOnePointAreToldWhereLargerOnesLieOnTheBodyToo) {
  const auto notes = unit_notes(placed(0.001), ball_on_origin());
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("times 1000 they lie on it, too"), std::string::npos)
      << notes[0];
}

// A small patch of a body is measured, far from the origin: no factor explains it.
TEST(SessionUnits, ASmallPatchIsNoSlip) {
  Session session = placed(1e-3);
  for (SessionRun& run : session.run) {
    *run.position_m += Eigen::Vector3d(kRadius, 0.0, kRadius);
  }
  EXPECT_TRUE(unit_notes(session, ball_on_origin()).empty());
}

TEST(SessionUnits, PressesThroughTheBodyAreTold) {
  const Session session = placed(1.0);
  EXPECT_TRUE(depth_notes(session, ball_on_origin(), 0.02).empty());
  const auto notes = depth_notes(session, ball_on_origin(), 0.05);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("length_unit of [body], now \"mm\""), std::string::npos);
}

}  // namespace
}  // namespace palpate
