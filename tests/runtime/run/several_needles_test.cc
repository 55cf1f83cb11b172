// Several needles in one body: each has its own channels, and renders as it does alone.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/run/render_run.h"
#include "runtime/run/replay.h"
#include "tests/support/punctured_plate.h"
#include "tests/support/said.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class SeveralNeedles : public testing::Test {
 protected:
  SeveralNeedles() {
    ResponseTable lance = database_.tools[0];
    lance.tool.name = "lance";
    lance.puncture.rupture = {1.0};
    lance.puncture.cutting_n[0] = 0.3;
    database_.tools.push_back(lance);
  }

  static SimulationOptions needle(const std::string& tool, double x_m) {
    SimulationOptions o;
    o.tool = tool;
    o.at_m = Eigen::Vector3d(x_m, 0.0, 0.0);
    o.duration_s = 6.0;
    o.limit_stiffness = true;
    return o;
  }

  static void expect_alike(const RenderReport& a, const RenderReport& b) {
    EXPECT_EQ(a.ticks, b.ticks);
    EXPECT_EQ(a.force_max_n, b.force_max_n);
    EXPECT_EQ(a.energy_in_j, b.energy_in_j);
    EXPECT_EQ(a.model_work_j, b.model_work_j);
    EXPECT_EQ(a.dissipated_j, b.dissipated_j);
    EXPECT_EQ(a.needle.channels, b.needle.channels);
    EXPECT_EQ(a.needle.broken, b.needle.broken);
    EXPECT_EQ(a.needle.deepest_m, b.needle.deepest_m);
    EXPECT_EQ(a.needle.crack_j, b.needle.crack_j);
    EXPECT_EQ(a.needle.released_j, b.needle.released_j);
    EXPECT_EQ(a.needle.shaft_j, b.needle.shaft_j);
  }

  ResponseDatabase database_ = punctured_plate();
  std::atomic<bool> stop_ = false;
};

// Far apart, and at one place: what one has cut open, the other does not find.
TEST_F(SeveralNeedles, RenderTogetherWhatEachRendersAlone) {
  for (const double apart_m : {0.04, 0.0}) {
    const std::vector<SimulationOptions> both{needle("ball", -0.5 * apart_m),
                                              needle("lance", 0.5 * apart_m)};
    const std::vector<SimulationReport> together = simulate(database_, both, stop_);
    ASSERT_EQ(together.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      const RenderReport& r = together[i].render;
      EXPECT_EQ(r.fault, Fault::kNone);
      EXPECT_TRUE(r.needle.punctures);
      EXPECT_EQ(r.needle.channels, 1);
      EXPECT_GE(r.needle.broken, 2U);
      expect_alike(r, simulate(database_, both[i], stop_).render);
      EXPECT_NEAR(r.model_work_j, r.stored_j + r.dissipated_j + r.tank_j, 1e-12);
    }
    EXPECT_NE(together[0].render.needle.crack_j, together[1].render.needle.crack_j);
  }
}

// Two of one tool are two needles, too.
TEST_F(SeveralNeedles, OfOneToolAreAlike) {
  const std::vector<SimulationOptions> both{needle("ball", 0.0), needle("ball", 0.0)};
  const std::vector<SimulationReport> together = simulate(database_, both, stop_);
  ASSERT_EQ(together.size(), 2U);
  EXPECT_EQ(together[0].render.needle.channels, 1);
  expect_alike(together[0].render, together[1].render);
}

// From the file, and again from the recordings.
TEST_F(SeveralNeedles, AreStreamedAndReplayedEachOnItsOwn) {
  const ScratchFolder scratch;
  const auto file = scratch / "needles.h5";
  write_database(file, database_);
  std::vector<SimulationOptions> both{needle("ball", -0.02), needle("lance", 0.02)};
  for (SimulationOptions& o : both) {
    o.recording = {.file = scratch / (o.tool + ".h5"),
                   .database = "needles.h5",
                   .database_sha256 = database_sha256(file)};
  }
  const std::vector<SimulationReport> streamed =
      simulate_streamed(file, both, std::size_t{64} << 20, stop_);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(streamed[i].render.needle.channels, 1);
    const ReplayReport replayed =
        replay(read_recording(both[i].recording.file), database_);
    EXPECT_TRUE(replayed.is_reproduced()) << replayed.different_in;
  }
}

// Two hands that feel each other through the body have no channels.
TEST_F(SeveralNeedles, AreRefusedInTwoHands) {
  SimulationOptions hands = needle("ball", -0.02);
  hands.together = {.tool = "lance", .at_m = Eigen::Vector3d(0.02, 0.0, 0.0)};
  expect_says(palpate::refusal([&] {
                (void)simulate(database_, hands, stop_);
              }),
              "is a needle, and contacts that are coupled puncture nothing");
}

}  // namespace
}  // namespace palpate
