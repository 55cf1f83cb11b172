// What runs of several contacts leave in recordings, rendered again.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/recording/recording_writer.h"
#include "runtime/run/pose_trace.h"
#include "runtime/run/recorded_setup.h"
#include "tests/support/contact_runs.h"

namespace palpate {
namespace {

class ContactRecordings : public ContactRuns {};

TEST_F(ContactRecordings, ARecordingOfTwoHandsIsReproducedToTheBit) {
  SimulationOptions live = pinch();
  live.at_m = Eigen::Vector3d(-0.015, 0.0, 0.0);
  live.together = SecondHand{.tool = "pads", .at_m = Eigen::Vector3d(0.015, 0.0, 0.0)};
  live.duration_s = 2.0;
  live.device.damping_n_s_per_m = 0.05;  // too little: forces are scaled
  Recording recording;
  const ReplayReport again = replayed(live, recording);
  EXPECT_TRUE(again.is_reproduced()) << again.different_in;
  EXPECT_LT(last_.force_scale, 1.0);
  EXPECT_GT(last_.render.torque_max_n_m, 1e-5);
  EXPECT_EQ(recording.header.tool, "ball");
  EXPECT_EQ(recording.header.second_tool, "pads");
  EXPECT_EQ(again.ticks, 4000);
  EXPECT_EQ(again.replayed_net_j, again.net_energy_j);
  EXPECT_GT(again.force_max_n, 0.0);
  // Nothing of it passes unseen.
  const auto differs_at = [&](auto&& change) {
    Recording other = recording;
    change(other);
    return replay(other, database_).different_tick;
  };
  EXPECT_EQ(differs_at([](Recording& r) {
              r.tick[1700].second.torque_n_m[2] += 1e-15;
            }),
            1700);
  EXPECT_EQ(differs_at([](Recording& r) {
              r.tick[900].tank_j += 1e-15;
            }),
            900);
  EXPECT_EQ(differs_at([](Recording& r) {
              r.tick[1100].contacts += 1;
            }),
            1100);
  const auto touched = static_cast<std::int64_t>(recording.tick.size()) / 2;
  EXPECT_LE(differs_at([](Recording& r) {
              for (std::size_t i = 0; i < 50; ++i) {
                r.tick[1800 + i].second.turn = {0.0, 0.1, 0.0, std::sqrt(0.99)};
              }
            }),
            touched);
  recording.header.force_scale = 1.0;
  EXPECT_GT(replay(recording, database_).force_difference_n, 1e-3);
}

// What hangs is recorded with what it hangs by.
TEST_F(ContactRecordings, ARecordingOfACouplingIsReproducedToTheBit) {
  for (const bool hands : {false, true}) {
    SimulationOptions o = hands ? pinch() : options("pads");
    o.duration_s = 2.0;
    o.coupling = VirtualCoupling{.mass_kg = 0.05, .spring_n_per_m = 200.0};
    Recording recording;
    EXPECT_TRUE(replayed(o, recording).is_reproduced());
    recording.header.coupling_spring_n_per_m = 210.0;
    EXPECT_FALSE(replay(recording, database_).is_reproduced());
  }
}

// By the other field, of the same elements or asked for anew.
TEST_F(ContactRecordings, ARecordingIsRenderedAgainByAnotherField) {
  Recording recording;
  (void)replayed(options("pads"), recording);
  const ReplayReport same = render_again(recording, database_, LocalModel::kPotential);
  EXPECT_LT(same.force_rms_n, 0.05 * same.force_max_n);
  const ReplayReport facets = render_again(recording, database_, LocalModel::kFacets);
  EXPECT_EQ(facets.compared, facets.ticks);
  EXPECT_GT(facets.force_difference_n, 0.0);
  EXPECT_THROW((void)render_again(recording, database_, LocalModel::kElement),
               InputError);
}

// A recording whose writer died has what it had written by then, of all hands.
TEST_F(ContactRecordings, ARecordingOutlivesItsWriter) {
  SimulationOptions o = pinch();
  o.duration_s = 2.0;
  Recording recording;
  (void)replayed(o, recording);
  RecordingHeader header = recording.header;
  {
    RecordingWriter writer(folder_ / "cut.h5", header);
    for (std::size_t i = 0, next = 0; i < recording.tick.size(); ++i) {
      for (; next < recording.arrival.size() &&
             recording.arrival[next].tick <= recording.tick[i].tick;
           ++next) {
        writer.append(std::span(&recording.arrival[next], 1));
      }
      writer.append(std::span(&recording.tick[i], 1));
    }
  }
  const Recording cut = read_recording(folder_ / "cut.h5.partial");
  EXPECT_FALSE(cut.ended);
  EXPECT_GE(cut.tick.size(), 3072U - kRecordingBlock);
  const ReplayReport again = replay(cut, database_);
  EXPECT_EQ(again.identical, again.ticks);
}

// A second hand whose sensor turns by half a radian in a tick.
TEST_F(ContactRecordings, AFaultLeavesItsLastTicks) {
  std::vector<RenderTick> ticks(1000);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].time_ns = static_cast<std::int64_t>(i) * 500'000;
    ticks[i].pose[0].position_m = {-0.007, 0.0, 0.004};
    ticks[i].pose[1].position_m = {0.015, 0.0, 0.004};
    if (i >= 600) {
      ticks[i].pose[1].turn = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY());
    }
  }
  SimulationOptions o = pinch();
  o.together->tool = "pads";
  o.poses = folder_ / "poses.csv";
  write_pose_trace(o.poses, 2, ticks);
  o.recording.flight_file = folder_ / "flight.h5";
  const SimulationReport report = run(o);
  EXPECT_EQ(report.render.fault, Fault::kJump);
  EXPECT_NEAR(report.render.fault_s, 0.3, 1e-9);
  EXPECT_GT(report.render.contact_ticks, 300);
  const Recording flight = read_recording(o.recording.flight_file);
  EXPECT_EQ(flight.end.fault, "jump");
  EXPECT_EQ(flight.tick.size(), 601U);
  EXPECT_TRUE(replay(flight, database_).is_reproduced());
}

}  // namespace
}  // namespace palpate
