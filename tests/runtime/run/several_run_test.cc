// Runs of tools with several contacts, and of two hands on one body.
#include "runtime/run/several_run.h"

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/database/table_memory.h"
#include "runtime/run/pose_trace.h"
#include "runtime/run/run_outcome.h"
#include "runtime/slow/chunk_cache.h"
#include "tests/support/contact_runs.h"

namespace palpate {
namespace {

TEST_F(ContactRuns, PadsAreHeldAndTurned) {
  const SimulationReport report = run(options("pads"));
  const RenderReport& r = report.render;
  expect_balance(r);
  EXPECT_EQ(r.ticks, 8000);
  EXPECT_GT(r.contact_ticks, 3000);
  EXPECT_EQ(r.contacts_max, 3);
  EXPECT_GT(r.torque_max_n_m, 1e-4);
  EXPECT_EQ(r.scaled_ticks, 0);
  EXPECT_TRUE(report.convex);
  EXPECT_TRUE(report.torque_felt);
  EXPECT_GT(report.turning_n_m_per_rad, 0.0);
  EXPECT_NE(summary(report).find("3, coupled; turned by hands"), std::string::npos);
  EXPECT_EQ(as_json(report)["contacts_max"], 3);
}

// Held pads bear less with time; what dents hold is in the account, also of pads that
// hang.
TEST_F(ContactRuns, PadsRelax) {
  const SimulationReport before = run(options("pads"));
  Viscoelasticity relaxation;
  relaxation.instantaneous = true;
  relaxation.tau_s = {0.1, 2.0};
  relaxation.g = RowsOf<float>{{0.3F, 0.25F}};
  give_all(relaxation);
  for (const bool held : {false, true}) {
    SimulationOptions o = options("pads");
    if (held) {
      o.coupling = VirtualCoupling{.spring_n_per_m = 200.0};
    }
    Recording recording;
    EXPECT_TRUE(replayed(o, recording).is_reproduced());
    const RenderReport& r = last_.render;
    expect_balance(r);
    EXPECT_TRUE(r.relaxes);
    EXPECT_GT(r.carried_max_n, 0.1 * before.render.force_max_n);
    EXPECT_NE(summary(last_).find("dents"), std::string::npos);
  }
}

TEST_F(ContactRuns, PadsLeaveDents) {
  Viscoelasticity relaxation;
  relaxation.yielding.yield_depth_m = {0.0005};
  relaxation.yielding.share = {0.3};
  give_all(relaxation);
  Recording recording;
  EXPECT_TRUE(replayed(options("pads"), recording).is_reproduced());
  const RenderReport& r = last_.render;
  expect_balance(r);
  EXPECT_TRUE(r.yields);
  EXPECT_GT(r.yielded_j, 1e-5);
  EXPECT_LT(r.yielded_j, r.dissipated_j + 1e-12);
}

// What had yielded is begun with, left, and held by recordings, for each table of
// responses; two hands' of one name are one in files.
TEST_F(ContactRuns, BeginWithADentedSurface) {
  Viscoelasticity relaxation;
  relaxation.yielding.yield_depth_m = {0.0005};
  relaxation.yielding.share = {0.3};
  give_all(relaxation);
  for (SimulationOptions o : {options("pads"), pinch()}) {
    const bool hands = o.together.has_value();
    Recording recording;
    EXPECT_TRUE(replayed(o, recording).is_reproduced());
    const SimulationReport first = last_;
    const std::vector<YieldedRow>& rows = first.render.surface.yielded;
    EXPECT_EQ(first.tables, hands ? std::vector<std::string>({"ball", "ball"})
                                  : std::vector<std::string>({"pads"}));
    for (std::int32_t table = 0; table < (hands ? 2 : 1); ++table) {
      EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [&](const YieldedRow& row) {
        return row.table == table && row.dent_m > 1e-4;
      })) << table;
    }
    put_surface(first.render.surface, first.tables, o.surface);
    EXPECT_EQ(o.surface.tool.size(), 1U);
    EXPECT_TRUE(replayed(o, recording).is_reproduced());
    EXPECT_EQ(recording.header.surface, surface_of(o.surface, first.tables));
    EXPECT_LT(last_.render.yielded_j, 0.1 * first.render.yielded_j);
    expect_balance(last_.render);
    // Each table by itself counts.
    for (std::int32_t table = 0; table < (hands ? 2 : 1); ++table) {
      Recording other = recording;
      std::erase_if(other.header.surface.yielded, [&](const YieldedRow& row) {
        return row.table == table;
      });
      EXPECT_FALSE(replay(other, database_).is_reproduced()) << table;
    }
  }
}

// Each makes the other's place softer than it is alone.
TEST_F(ContactRuns, TwoHandsFeelEachOther) {
  SimulationOptions both = pinch();
  both.tilt_rad = 0.0;
  both.limit_stiffness = false;
  const SimulationReport coupled = run(both);
  EXPECT_EQ(coupled.contacts, 2);
  EXPECT_EQ(coupled.render.contacts_max, 2);
  expect_balance(coupled.render);
  EXPECT_GE(coupled.second_node, 0);
  EXPECT_NE(coupled.second_node, coupled.node);
  both.together.reset();
  const SimulationReport alone = run(both);
  EXPECT_EQ(alone.contacts, 1);
  EXPECT_GT(alone.render.force_max_n, 1.02 * coupled.render.force_max_n);
}

TEST_F(ContactRuns, PosesOfATraceGiveTheSameBits) {
  for (SimulationOptions first : {options("pads"), pinch(), options("ball")}) {
    const bool hands = first.together.has_value();
    first.duration_s = 2.0;
    first.trace = folder_ / "first.csv";
    const SimulationReport live = run(first);
    SimulationOptions again = first;
    again.duration_s = 10.0;  // as long as there are poses
    again.poses = first.trace;
    again.trace = folder_ / "again.csv";
    const SimulationReport posed = run(again);
    EXPECT_EQ(posed.render.ticks, 4000);
    EXPECT_EQ(posed.render.model_work_j, live.render.model_work_j);
    EXPECT_EQ(posed.render.energy_in_j, live.render.energy_in_j);
    const std::string text = bytes_of(first.trace);
    EXPECT_GT(text.size(), 100'000U);
    EXPECT_TRUE(text == bytes_of(again.trace));
    EXPECT_EQ(text.substr(0, text.find('\n')).find("tz2_n_m") != std::string::npos,
              hands);
  }
}

// A tracker's thirty poses a second are a run of that rate, which no watch ends.
TEST_F(ContactRuns, PosesHaveTheRateThatTheyWereMeasuredAt) {
  SimulationOptions live = options("pads");
  live.tilt_rad = live.turn_rad = 0.0;
  live.trace = folder_ / "all.csv";
  const SimulationReport all = run(live);
  std::vector<RenderTick> some;
  for (const RenderTick& tick : read_poses(live.trace, 1)) {
    const auto number = tick.time_ns / 500'000;
    if (number % 66 == 0) {
      some.push_back(tick);
    }
  }
  SimulationOptions slow = options("pads");
  slow.poses = folder_ / "some.csv";
  write_pose_trace(slow.poses, 1, some);
  const SimulationReport report = run(slow);
  expect_balance(report.render);
  EXPECT_EQ(report.render.ticks, std::ssize(some));
  EXPECT_NEAR(report.render.duration_s, all.render.duration_s, 0.05);
  EXPECT_EQ(report.force_scale, all.force_scale);
  EXPECT_NEAR(report.render.force_max_n, all.render.force_max_n,
              0.1 * all.render.force_max_n);
}

TEST_F(ContactRuns, ATraceOfAllTimesIsRefused) {
  SimulationOptions o = options("pads");
  o.trace = folder_ / "t.csv";
  o.duration_s = 1e9;
  EXPECT_THROW((void)run(o), InputError);
}

// A recording of a body in its file is replayed, bit for bit, by the body in memory:
// one hand and two, relaxing and yielding.
TEST_F(ContactRuns, AStreamedBodyAnswersAsOneInMemory) {
  Viscoelasticity relaxation;
  relaxation.instantaneous = true;
  relaxation.tau_s = {0.1};
  relaxation.g = RowsOf<float>{{0.3F}};
  relaxation.yielding.yield_depth_m = {0.0005};
  relaxation.yielding.share = {0.3};
  database_.storage.chunk_nodes = 64;
  for (const bool remembers : {false, true}) {
    if (remembers) {
      give_all(relaxation);
    }
    const auto file = folder_ / "plate.h5";
    write_database(file, database_);
    for (SimulationOptions o : {options("pads"), pinch()}) {
      o.recording.file = folder_ / "run.h5";
      const SimulationReport report =
          simulate_streamed(file, std::span(&o, 1), 64 * kMebibyte, stop_).front();
      expect_balance(report.render);
      EXPECT_GT(report.render.contact_ticks, 3000);
      EXPECT_EQ(report.render.yields, remembers);
      ASSERT_TRUE(report.stream);
      EXPECT_EQ(report.stream->starved, 0);
      EXPECT_GT(report.stream->cache.loaded, 2);
      EXPECT_EQ(report.tables.size(), o.together ? 2U : 1U);
      EXPECT_EQ(report.turning_n_m_per_rad > 0.0, !o.together);
      const ReplayReport replayed =
          replay(read_recording(o.recording.file), read_database(file));
      EXPECT_TRUE(replayed.is_reproduced()) << replayed.different_in;
      EXPECT_GT(replayed.force_max_n, 0.05);
    }
  }
}

// In the same scene, each on the body as if it were alone.
TEST_F(ContactRuns, PadsBesideABallAreRenderedAsAlone) {
  SimulationOptions ball = options("ball");
  ball.at_m = Eigen::Vector3d(0.03, 0.0, 0.0);
  const std::vector<SimulationOptions> both{options("pads"), ball};
  const std::vector<SimulationReport> beside = simulate(database_, both, stop_);
  for (std::size_t i = 0; i < both.size(); ++i) {
    const RenderReport alone = run(both[i]).render;
    EXPECT_EQ(beside[i].render.force_max_n, alone.force_max_n);
    EXPECT_EQ(beside[i].render.model_work_j, alone.model_work_j);
    EXPECT_EQ(beside[i].render.contacts_max, alone.contacts_max);
    EXPECT_GT(alone.contact_ticks, 3000);
  }
}

// In real time, or with a device, nothing is where a file says.
TEST_F(ContactRuns, PosesAreOfSimulatedTimeAlone) {
  SimulationOptions o = options("pads");
  o.duration_s = 0.1;
  o.trace = folder_ / "poses.csv";
  (void)run(o);
  o.poses = o.trace;
  o.real_time = true;
  EXPECT_THROW((void)run(o), InputError);
}

TEST_F(ContactRuns, PosesAreCheckedLineByLine) {
  const auto refusal = [&](const std::string& text) {
    const auto file = folder_ / "poses.csv";
    std::ofstream(file) << text;
    try {
      (void)read_poses(file, 1);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string head = "time_s,x1_m,y1_m,z1_m,qx1,qy1,qz1,qw1\n";
  EXPECT_EQ(refusal(head + "0,0,0,0.1,0,0,0,1\n"), "");
  EXPECT_NE(refusal("time_s,x1_m\n").find("no column \"y1_m\""), std::string::npos);
  EXPECT_NE(refusal(head + "0,0,0,0.1,0,0,0,nan\n").find("line 2: qw1"),
            std::string::npos);
  EXPECT_NE(refusal(head + "0,0,0,0.1,0,0,0,0\n").find("quaternion of zeros"),
            std::string::npos);
  EXPECT_NE(refusal(head + "1,0,0,0.1,0,0,0,1\n1,0,0,0.1,0,0,0,1\n").find("must rise"),
            std::string::npos);
  EXPECT_NE(refusal(head).find("no poses"), std::string::npos);
}

TEST_F(ContactRuns, RefuseWhatCannotBeRendered) {
  const auto refusal = [&](const SimulationOptions& o) {
    try {
      (void)run(o);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  SimulationOptions weak = options("pads");
  weak.device.damping_n_s_per_m = 0.001;
  weak.limit_stiffness = false;
  EXPECT_NE(refusal(weak).find("--limit-stiffness"), std::string::npos);
  weak.limit_stiffness = true;
  EXPECT_EQ(refusal(weak), "");
  SimulationOptions wild = options("pads");
  wild.tilt_rad = 3.0;
  EXPECT_NE(refusal(wild).find("tilt"), std::string::npos);
  SimulationOptions element = options("pads");
  element.model = LocalModel::kElement;
  EXPECT_NE(refusal(element).find("potential or facets"), std::string::npos);
}

// Hung by a coupling: its account closes, its spring counts for stability, and a pinch
// has it, too.
TEST_F(ContactRuns, HangByACoupling) {
  for (const bool hands : {false, true}) {
    SimulationOptions o = hands ? pinch() : options("pads");
    o.coupling = VirtualCoupling{.spring_n_per_m = 200.0};
    o.duration_s = 2.5;
    const SimulationReport report = run(o);
    expect_balance(report.render);
    EXPECT_GT(report.render.contact_ticks, 1000);
    ASSERT_TRUE(report.coupling);
    const VirtualToolAccount& a = report.coupling->account;
    EXPECT_LE(a.kinetic_j + a.spring_j, report.render.stored_j);
    EXPECT_GT(a.dissipated_j, 1e-5);
    EXPECT_LT(a.residual_j, 1e-12);
    EXPECT_EQ(report.stiffness.normal_n_per_m, 200.0);
    // 200 N/m held for half a millisecond by 0.5 N s/m.
    EXPECT_NEAR(report.coupling->every_hand_n_s_per_m, 200.0 * 0.00025 + 6.0, 1e-12);
    EXPECT_NE(summary(report).find("springs of 200 N/m"), std::string::npos);
    EXPECT_TRUE(as_json(report)["coupling"].contains("kinetic_j"));
  }
}

// What the device can hold is a matter of the spring alone.
TEST_F(ContactRuns, ACouplingIsSoftenedToWhatTheDeviceHolds) {
  SimulationOptions o = options("pads");
  o.limit_stiffness = false;
  o.duration_s = 0.1;
  o.device.damping_n_s_per_m = 0.01;
  o.device.coulomb_n = 0.0;
  EXPECT_THROW((void)run(o), InputError);
  o.coupling = VirtualCoupling{};
  EXPECT_THROW((void)run(o), InputError);
  o.limit_stiffness = true;
  const SimulationReport r = run(o);
  EXPECT_EQ(r.force_scale, 1.0);
  EXPECT_NEAR(r.coupling->coupling.spring_n_per_m, r.bounds.renderable_n_per_m(), 1e-9);
  o.limit_stiffness = false;
  o.coupling->spring_n_per_m = 0.9 * r.bounds.renderable_n_per_m();
  EXPECT_NEAR(run(o).coupling->coupling.spring_n_per_m,
              0.9 * r.bounds.renderable_n_per_m(), 0.0);
  // One contact has nothing to hang.
  SimulationOptions ball = options("ball");
  ball.coupling = VirtualCoupling{};
  EXPECT_THROW((void)run(ball), InputError);
}

// As if the three pressed bodies of their own.
TEST_F(ContactRuns, AreAsStiffAsTheirSum) {
  SimulationOptions o = options("pads");
  o.duration_s = 0.1;
  const SimulationReport report = run(o);
  SimulationOptions ball = o;
  ball.tool = "ball";
  ball.force_max_n = o.force_max_n / 3.0;
  EXPECT_NEAR(report.stiffness.normal_n_per_m, 3.0 * run(ball).stiffness.normal_n_per_m,
              1e-9);
}

}  // namespace
}  // namespace palpate
