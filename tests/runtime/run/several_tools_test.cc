// Several tools in one scene: each its device, model and ledger, one slow process.
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/run/render_run.h"
#include "runtime/run/replay.h"
#include "tests/support/pressed_plate.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/test_data.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

class SeveralTools : public testing::Test {
 protected:
  SeveralTools() {
    ToolShape punch = flat_punch(0.004, 0.001);
    punch.name = "punch";
    punch.axis = Eigen::Vector3d::UnitZ();
    const auto stiffer = [](Eigen::Index, double d) {
      return 300.0 * d;
    };
    database_.tools.push_back(
        sample_database(database_.body, punch, stiffer, kDepthMax, 21).tools.front());
  }

  static SimulationOptions options(const std::string& tool) {
    SimulationOptions o;
    o.tool = tool;
    o.duration_s = 4.0;
    return o;
  }

  ResponseDatabase database_ =
      sample_database(plate(0.1, 10), ball(kRadius, 0.3, 5e-4), wall, kDepthMax, 41);
  std::atomic<bool> stop_ = false;
};

TEST_F(SeveralTools, RenderTogetherWhatEachRendersAlone) {
  const std::vector<SimulationOptions> both{options("ball"), options("punch")};
  const std::vector<SimulationReport> together = simulate(database_, both, stop_);
  ASSERT_EQ(together.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const RenderReport alone = simulate(database_, both[i], stop_).render;
    const RenderReport& r = together[i].render;
    EXPECT_EQ(together[i].tool, both[i].tool);
    EXPECT_EQ(r.fault, Fault::kNone);
    EXPECT_GT(r.contact_ticks, 2000);
    // The same bits: nothing of one tool reaches another.
    EXPECT_EQ(r.ticks, alone.ticks);
    EXPECT_EQ(r.force_max_n, alone.force_max_n);
    EXPECT_EQ(r.model_work_j, alone.model_work_j);
    EXPECT_EQ(r.dissipated_j, alone.dissipated_j);
    EXPECT_EQ(r.slow_updates, alone.slow_updates);
    // Each account closes: sums of some mJ, rounded.
    EXPECT_NEAR(r.model_work_j, r.stored_j + r.dissipated_j + r.tank_j, 1e-12);
  }
  EXPECT_NE(together[0].render.force_max_n, together[1].render.force_max_n);
}

// Both in memory and streamed, with a recording each.
TEST_F(SeveralTools, AreRecordedAndReplayedEachOnItsOwn) {
  const ScratchFolder scratch;
  const auto file = scratch / "plate.h5";
  write_database(file, database_);
  std::vector<SimulationOptions> both{options("ball"), options("punch")};
  for (SimulationOptions& o : both) {
    o.recording = {.file = scratch / (o.tool + ".h5"),
                   .database = "plate.h5",
                   .database_sha256 = database_sha256(file)};
  }
  for (const bool streamed : {false, true}) {
    const std::vector<SimulationReport> reports =
        streamed ? simulate_streamed(file, both, std::size_t{64} << 20, stop_)
                 : simulate(database_, both, stop_);
    ASSERT_EQ(reports.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(reports[i].stream.has_value(), streamed);
      const Recording recording = read_recording(both[i].recording.file);
      EXPECT_EQ(recording.header.tool, both[i].tool);
      EXPECT_EQ(static_cast<std::int64_t>(recording.tick.size()),
                reports[i].render.ticks);
      const ReplayReport replayed = replay(recording, database_);
      EXPECT_TRUE(replayed.is_reproduced()) << replayed.different_in;
      EXPECT_GT(replayed.force_max_n, 0.1);
    }
  }
}

TEST_F(SeveralTools, FaultAlone) {
  FakeClock clock{1'000'000};
  FakeDevice sound(clock, press(0.004, 1.0));
  FakeDevice lost(clock, press(0.004, 1.0));
  lost.lost_read = 100;
  ElementStream first(database_, database_.tools[0]);
  ElementStream second(database_, database_.tools[0]);
  const RenderConfig c = config(LocalModel::kPotential);
  const std::vector<RenderedTool> tools{
      {c, {.device = lost, .stream = &first, .stop = stop_}},
      {c, {.device = sound, .stream = &second, .stop = stop_}}};
  const std::vector<RenderReport> reports = render_in_turns(tools, clock);
  EXPECT_EQ(reports[0].fault, Fault::kDeviceLost);
  EXPECT_EQ(reports[1].fault, Fault::kNone);
  EXPECT_EQ(reports[1].ticks, 4000);  // 2 s at 2 kHz
  EXPECT_NEAR(reports[1].force_max_n, wall(0, 0.002), 1e-9);
  EXPECT_EQ(lost.force.back().norm(), 0.0);
  EXPECT_EQ(sound.force.back().norm(), 0.0);
}

TEST_F(SeveralTools, RenderOnThreadsOfTheirOwn) {
  std::vector<SimulationOptions> both{options("ball"), options("punch")};
  for (SimulationOptions& o : both) {
    o.real_time = true;
    o.duration_s = 0.5;
    o.fast_hz = 200.0;  // a busy machine keeps up
    o.slow_hz = 20.0;
    o.limit_stiffness = true;
  }
  for (const SimulationReport& report : simulate(database_, both, stop_)) {
    EXPECT_GT(report.render.ticks, 0) << report.tool;
    EXPECT_GT(report.render.slow_updates, 0) << report.tool;
    EXPECT_FALSE(report.render.scheduling.empty()) << report.tool;
  }
}

TEST_F(SeveralTools, ShareClockRateAndEnd) {
  std::vector<SimulationOptions> both{options("ball"), options("punch")};
  both[1].slow_hz = 50.0;
  EXPECT_THROW((void)simulate(database_, both, stop_), InputError);
  both[1] = options("punch");
  both[1].real_time = true;
  EXPECT_THROW((void)simulate(database_, both, stop_), InputError);
  both.clear();
  EXPECT_THROW((void)simulate(database_, both, stop_), InputError);
}

}  // namespace
}  // namespace palpate
