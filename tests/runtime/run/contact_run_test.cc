// Runs of tools with several contacts, and of two hands on one body.
#include "runtime/run/contact_run.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/table_memory.h"
#include "runtime/run/contact_replay.h"
#include "runtime/run/pose_trace.h"
#include "runtime/run/render_run.h"
#include "tests/support/padded_plate.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

class ContactRuns : public testing::Test {
 protected:
  ContactRunReport run(const ContactRunOptions& options) {
    return simulate_contacts(database_, options, stop_);
  }
  ContactRunOptions options(std::vector<std::string> tools) const {
    ContactRunOptions o;
    o.tools = std::move(tools);
    o.duration_s = 4.0;
    return o;
  }

  ResponseDatabase database_ = padded_plate(3);
  ScratchFolder folder_;
  std::atomic<bool> stop_ = false;
};

TEST_F(ContactRuns, PadsAreHeldAndTurned) {
  const ContactRunReport r = run(options({"pads"}));
  EXPECT_EQ(r.fault, Fault::kNone);
  EXPECT_EQ(r.ticks, 8000);
  EXPECT_GT(r.contact_ticks, 3000);
  EXPECT_EQ(r.contacts_max, 3);
  EXPECT_GT(r.torque_max_n_m, 1e-4);
  EXPECT_GE(r.lowest_work_j, -1e-12);
  EXPECT_NEAR(r.model_work_j, r.stored_j + r.tank_j + r.dissipated_j, 1e-12);
  EXPECT_EQ(r.scaled_ticks, 0);
  EXPECT_TRUE(r.convex);
  EXPECT_NE(summary(r).find("3 contacts"), std::string::npos);
}

// Held pads bear less with time; what dents hold is in the account, also of pads that
// hang, and a recording needs nothing more.
TEST_F(ContactRuns, PadsRelax) {
  const ContactRunReport before = run(options({"pads"}));
  for (ResponseTable& table : database_.tools) {
    Viscoelasticity relaxation;
    relaxation.instantaneous = true;
    relaxation.tau_s = {0.1, 2.0};
    relaxation.g = RowsOf<float>{{0.3F, 0.25F}};
    give_memory(database_.body, database_.normal, relaxation, 1, table);
  }
  for (const bool hung : {false, true}) {
    ContactRunOptions o = options({"pads"});
    o.keep = true;
    if (hung) {
      o.coupling = VirtualCoupling{.spring_n_per_m = 200.0};
    }
    const ContactRunReport r = run(o);
    EXPECT_EQ(r.fault, Fault::kNone);
    EXPECT_TRUE(r.relaxes);
    EXPECT_GT(r.carried_max_n, 0.1 * before.force_max_n);
    EXPECT_GE(r.lowest_work_j, -1e-12);
    EXPECT_NEAR(r.model_work_j, r.stored_j + r.tank_j + r.memory_j + r.dissipated_j,
                1e-12);
    EXPECT_NE(summary(r).find("+ dents"), std::string::npos);
    if (!hung) {
      EXPECT_LT(r.kept.back().command.wrench[0].force_n.norm(), before.force_max_n);
      EXPECT_TRUE(replay_contacts(contact_recording(r, "pads.h5", std::string(64, 'a')),
                                  database_)
                      .is_reproduced());
    }
  }
}

TEST_F(ContactRuns, PadsLeaveDents) {
  for (ResponseTable& table : database_.tools) {
    Viscoelasticity relaxation;
    relaxation.yielding.yield_depth_m = {0.0005};
    relaxation.yielding.share = {0.3};
    give_memory(database_.body, database_.normal, relaxation, 1, table);
  }
  const ContactRunReport r = run(options({"pads"}));
  EXPECT_EQ(r.fault, Fault::kNone);
  EXPECT_TRUE(r.yields);
  EXPECT_GT(r.yielded_j, 1e-5);
  EXPECT_LT(r.yielded_j, r.dissipated_j + 1e-12);
  EXPECT_GE(r.lowest_work_j, -1e-12);
  EXPECT_NE(summary(r).find("yielding: dissipated"), std::string::npos);
}

// Two fingers 14 mm apart: each makes the other's place softer than it is alone.
TEST_F(ContactRuns, TwoHandsFeelEachOther) {
  ContactRunOptions both = options({"ball", "ball"});
  both.at_m = {{-0.007, 0.0, 0.0}, {0.007, 0.0, 0.0}};
  both.tilt_rad = 0.0;
  const ContactRunReport coupled = run(both);
  EXPECT_EQ(coupled.contacts, 2);
  EXPECT_EQ(coupled.fault, Fault::kNone);
  EXPECT_GE(coupled.lowest_work_j, -1e-12);
  ContactRunOptions single = options({"ball"});
  single.at_m = {both.at_m[0]};
  const ContactRunReport alone = run(single);
  EXPECT_EQ(alone.contacts, 1);
  EXPECT_GT(alone.force_max_n, 1.02 * coupled.force_max_n);
}

TEST_F(ContactRuns, PosesOfATraceGiveTheSameBits) {
  ContactRunOptions first = options({"pads"});
  first.duration_s = 2.0;
  first.trace = folder_ / "first.csv";
  const ContactRunReport live = run(first);
  ContactRunOptions again = options({"pads"});
  again.poses = first.trace;
  again.trace = folder_ / "again.csv";
  const ContactRunReport replayed = run(again);
  EXPECT_EQ(replayed.ticks, live.ticks);
  EXPECT_EQ(replayed.model_work_j, live.model_work_j);
  EXPECT_EQ(replayed.torque_max_n_m, live.torque_max_n_m);
  EXPECT_EQ(read_text(first.trace), read_text(again.trace));
  const std::string header =
      read_text(first.trace).substr(0, read_text(first.trace).find('\n'));
  EXPECT_NE(header.find("tz1_n_m"), std::string::npos);
}

TEST_F(ContactRuns, ARecordingOfTwoHandsIsReproducedToTheBit) {
  ContactRunOptions live = options({"ball", "pads"});
  live.at_m = {{-0.015, 0.0, 0.0}, {0.015, 0.0, 0.0}};
  live.duration_s = 2.0;
  live.keep = true;
  live.device.damping_n_s_per_m = 0.05;  // too little: forces are scaled
  live.limit_stiffness = true;
  const ContactRunReport report = run(live);
  EXPECT_LT(report.force_scale, 1.0);
  EXPECT_GT(report.torque_max_n_m, 1e-5);
  ContactRecording recording =
      contact_recording(report, "pads.h5", std::string(64, 'a'));
  EXPECT_EQ(recording.tools, (std::vector<std::string>{"ball", "pads"}));
  const ContactReplayReport again = replay_contacts(recording, database_);
  EXPECT_TRUE(again.is_reproduced()) << again.different_tick;
  EXPECT_EQ(again.ticks, 4000);
  EXPECT_EQ(again.replayed_net_j, again.net_energy_j);
  // Nothing of it passes unseen.
  recording.wrench(1700, 11) += 1e-15;
  EXPECT_EQ(replay_contacts(recording, database_).different_tick, 1700);
  recording.wrench(1700, 11) = report.kept[1700].command.wrench[1].torque_n_m.z();
  recording.tank_j[900] += 1e-15;
  EXPECT_EQ(replay_contacts(recording, database_).different_tick, 900);
  recording.tank_j[900] = report.kept[900].command.tank_j;
  recording.force_scale = 1.0;
  EXPECT_GT(replay_contacts(recording, database_).force_difference_n, 1e-3);
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
  const auto refusal = [&](const ContactRunOptions& o) {
    try {
      (void)run(o);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  ContactRunOptions weak = options({"pads"});
  weak.device.damping_n_s_per_m = 0.001;
  EXPECT_NE(refusal(weak).find("--limit-stiffness"), std::string::npos);
  weak.limit_stiffness = true;
  EXPECT_EQ(refusal(weak), "");
  ContactRunOptions wild = options({"pads"});
  wild.tilt_rad = 3.0;
  EXPECT_NE(refusal(wild).find("tilt"), std::string::npos);
  EXPECT_TRUE(is_contact_run(database_, {"pads"}, false));
  EXPECT_FALSE(is_contact_run(database_, {"ball", "ball"}, false));
  EXPECT_TRUE(is_contact_run(database_, {"ball", "ball"}, true));
  EXPECT_THROW((void)is_contact_run(database_, {"pads", "ball"}, false), InputError);
}

// Hung by a coupling: its account closes, its spring counts for stability, and a pinch
// has it, too.
TEST_F(ContactRuns, HangByACoupling) {
  for (const bool pinch : {false, true}) {
    ContactRunOptions o = pinch ? options({"ball", "ball"}) : options({"pads"});
    if (pinch) {
      o.at_m = {{-0.007, 0.0, 0.0}, {0.007, 0.0, 0.0}};
    }
    o.coupling = VirtualCoupling{.spring_n_per_m = 200.0};
    o.duration_s = 2.5;
    const ContactRunReport r = run(o);
    EXPECT_EQ(r.fault, Fault::kNone);
    EXPECT_GT(r.contact_ticks, 1000);
    EXPECT_GE(r.lowest_work_j, -1e-12);
    EXPECT_NEAR(r.model_work_j, r.stored_j + r.tank_j + r.dissipated_j, 1e-12);
    ASSERT_TRUE(r.coupling);
    const HungAccount& a = r.coupling->account;
    EXPECT_LE(a.kinetic_j + a.spring_j, r.stored_j);
    EXPECT_GT(a.dissipated_j, 1e-5);
    EXPECT_LT(a.residual_j, 1e-12);
    // 200 N/m held for half a millisecond by 0.5 N s/m.
    EXPECT_NEAR(r.margin.share, 200.0 * 0.00025 / 0.5, 1e-12);
    EXPECT_NEAR(r.coupling->every_hand_n_s_per_m, 200.0 * 0.00025 + 6.0, 1e-12);
    EXPECT_NE(summary(r).find("springs of 200 N/m"), std::string::npos);
    EXPECT_NE(to_json(r).find("\"kinetic_j\""), std::string::npos);
  }
}

// What the device can hold is a matter of the spring alone.
TEST_F(ContactRuns, ACouplingIsSoftenedToWhatTheDeviceHolds) {
  ContactRunOptions o = options({"pads"});
  o.duration_s = 0.1;
  o.device.damping_n_s_per_m = 0.01;  // 40 N/m at 2 kHz
  EXPECT_THROW((void)run(o), InputError);
  o.coupling = VirtualCoupling{};
  EXPECT_THROW((void)run(o), InputError);
  o.limit_stiffness = true;
  const ContactRunReport r = run(o);
  EXPECT_EQ(r.force_scale, 1.0);
  EXPECT_NEAR(r.coupling->coupling.spring_n_per_m, 40.0, 1e-9);
  EXPECT_NEAR(r.margin.share, 1.0, 1e-12);
  o.limit_stiffness = false;
  o.coupling->spring_n_per_m = 39.0;
  EXPECT_NEAR(run(o).coupling->coupling.spring_n_per_m, 39.0, 0.0);
  // Contacts that the device could hold do not help.
  ContactRunOptions stiff = options({"pads"});
  stiff.duration_s = 0.1;
  EXPECT_LT(run(stiff).margin.share, 1.0);
  stiff.coupling = VirtualCoupling{.spring_n_per_m = 2100.0};  // 2000 N/m at 0.5 N s/m
  EXPECT_THROW((void)run(stiff), InputError);
  // One contact has nothing to hang.
  ContactRunOptions ball = options({"ball"});
  ball.coupling = VirtualCoupling{};
  EXPECT_THROW((void)run(ball), InputError);
}

TEST_F(ContactRuns, OnADeviceHangByACoupling) {
  SimulationOptions device;
  device.tool = "pads";
  device.duration_s = 2.5;
  device.coupling = VirtualCoupling{.spring_n_per_m = 200.0};
  const SimulationReport report = simulate(database_, device, stop_);
  EXPECT_EQ(report.render.fault, Fault::kNone);
  EXPECT_GT(report.render.contact_ticks, 1000);
  EXPECT_EQ(report.stiffness.normal_n_per_m, 200.0);
  ASSERT_TRUE(report.coupling);
  EXPECT_GT(report.coupling->account.dissipated_j, 0.0);
  EXPECT_NEAR(
      report.render.model_work_j,
      report.render.stored_j + report.render.tank_j + report.render.dissipated_j,
      1e-12);
  EXPECT_NE(summary(report).find("of the coupling"), std::string::npos);
  device.tool = "ball";
  EXPECT_THROW((void)simulate(database_, device, stop_), InputError);
}

TEST_F(ContactRuns, OnADeviceKeepTheirAxes) {
  SimulationOptions device;
  device.tool = "pads";
  device.duration_s = 4.0;
  device.limit_stiffness = true;
  const SimulationReport report = simulate(database_, device, stop_);
  EXPECT_EQ(report.contacts, 3);
  EXPECT_EQ(report.render.fault, Fault::kNone);
  EXPECT_GT(report.render.contact_ticks, 1000);
  EXPECT_GE(report.render.model_work_j, -1e-12);
  // As if the three pressed bodies of their own.
  SimulationOptions ball = device;
  ball.tool = "ball";
  ball.force_max_n = device.force_max_n / 3.0;
  EXPECT_NEAR(report.stiffness.normal_n_per_m,
              3.0 * simulate(database_, ball, stop_).stiffness.normal_n_per_m, 1e-9);
  EXPECT_NE(summary(report).find("3, coupled"), std::string::npos);

  device.model = LocalModel::kElement;
  EXPECT_THROW((void)simulate(database_, device, stop_), InputError);
  device.model = LocalModel::kPotential;
  device.recording.file = "never.h5";
  EXPECT_THROW((void)simulate(database_, device, stop_), InputError);
}

}  // namespace
}  // namespace palpate
