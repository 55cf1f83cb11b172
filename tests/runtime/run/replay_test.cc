#include "runtime/run/replay.h"

#include <atomic>
#include <cmath>
#include <span>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/table_memory.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

ResponseDatabase bumpy_body(double stiffness_n_per_m) {
  return sample_database(
      sphere_surface(0.04, 3), ball(0.005, 0.3, 5e-4),
      [=](Eigen::Index node, double d) {
        const double local = 1.0 + 0.1 * static_cast<double>(node % 7);
        return stiffness_n_per_m * local * d * (0.5 + 50.0 * d);
      },
      0.005);
}

class Replay : public testing::Test {
 protected:
  Replay() { write_database(file_, database_); }

  SimulationOptions options(LocalModel model) {
    SimulationOptions o;
    o.model = model;
    o.duration_s = 4.0;  // one round of the hand
    o.limit_stiffness = true;
    o.recording = {.file = recording_,
                   .database = "body.h5",
                   .database_sha256 = database_sha256(file_)};
    return o;
  }

  Recording recorded(const SimulationOptions& o) {
    const SimulationReport report = simulate(database_, o, stop_);
    EXPECT_EQ(report.recording_failure, "");
    EXPECT_EQ(report.records_dropped, 0U);
    Recording recording = read_recording(recording_);
    EXPECT_EQ(static_cast<std::int64_t>(recording.tick.size()), report.render.ticks);
    EXPECT_EQ(recording.end.fault, name(report.render.fault));
    return recording;
  }

  std::atomic<bool> stop_ = false;
  ScratchFolder scratch_;
  fs::path file_ = scratch_ / "body.h5";
  fs::path recording_ = scratch_ / "run.h5";
  ResponseDatabase database_ = bumpy_body(100.0);
};

TEST_F(Replay, ReproducesEveryLocalModelBitForBit) {
  for (const LocalModel model : kLocalModels) {
    const Recording recording = recorded(options(model));
    const ReplayReport report = replay(recording, read_database(file_));
    EXPECT_TRUE(report.is_reproduced()) << name(model) << ": " << report.different_in;
    EXPECT_EQ(report.compared, 8000) << name(model);
    EXPECT_GT(report.force_max_n, 0.02) << name(model);
    EXPECT_EQ(report.force_difference_n, 0.0) << name(model);
    EXPECT_EQ(report.net_energy_j, report.replayed_net_j) << name(model);
    EXPECT_NE(summary(report, true).find("reproduced: 8000 ticks bit for bit"),
              std::string::npos);
  }
}

// A body that relaxes, in bundles; its curves are of a press.
ResponseDatabase relaxing_body() {
  ResponseDatabase database = bumpy_body(100.0);
  Viscoelasticity relaxation;
  relaxation.speed_m_per_s = 0.001;
  relaxation.tau_s = {0.1, 2.0};
  relaxation.g = RowsOf<float>{{0.3F, 0.25F}};
  give_memory(database.body, database.normal, relaxation, 3, database.tools[0]);
  return database;
}

TEST_F(Replay, ReproducesEveryLocalModelOfABodyThatRemembers) {
  database_ = relaxing_body();
  write_database(file_, database_);
  for (const LocalModel model : kLocalModels) {
    SimulationOptions o = options(model);
    const SimulationReport run = simulate(database_, o, stop_);
    EXPECT_TRUE(run.render.relaxes);
    EXPECT_GT(run.render.carried_max_n, 0.002) << name(model);
    const RenderReport& r = run.render;
    if (passive(model)) {
      EXPECT_GE(r.model_work_j, 0.0) << name(model);
      EXPECT_NEAR(r.model_work_j, r.stored_j + r.dissipated_j + r.tank_j + r.memory_j,
                  1e-12)
          << name(model);
    }
    const ReplayReport report =
        replay(read_recording(recording_), read_database(file_));
    EXPECT_TRUE(report.is_reproduced()) << name(model) << ": " << report.different_in;
    // Without its memory the body answers otherwise.
    ResponseDatabase without = read_database(file_);
    without.tools[0].viscoelasticity = {};
    EXPECT_FALSE(replay(read_recording(recording_), without).is_reproduced());
  }
}

TEST_F(Replay, AStreamedBodyRemembersAsOneInMemoryDoes) {
  database_ = relaxing_body();
  database_.storage.chunk_nodes = 64;
  write_database(file_, database_);
  SimulationOptions o = options(LocalModel::kPotential);
  o.limit_stiffness = false;
  const SimulationReport streamed =
      simulate_streamed(file_, std::span(&o, 1), 64 * kMebibyte, stop_).front();
  EXPECT_GT(streamed.stream->cache.loaded, 1);
  EXPECT_GT(streamed.render.carried_max_n, 0.002);
  const ReplayReport report = replay(read_recording(recording_), read_database(file_));
  EXPECT_TRUE(report.is_reproduced()) << report.different_in;
}

// A body that yields everywhere, and relaxes.
ResponseDatabase yielding_body() {
  ResponseDatabase database = relaxing_body();
  Viscoelasticity relaxation = database.tools[0].viscoelasticity;
  relaxation.bundle_depth_m.clear();
  relaxation.sites = {};
  relaxation.yielding = {.yield_depth_m = {0.0005},
                         .share = {0.4},
                         .onset_m = {0.001},
                         .scale_m = {0.002},
                         .largest = {0.5}};
  give_memory(database.body, database.normal, relaxation, 1, database.tools[0]);
  return database;
}

TEST_F(Replay, ReproducesARunThatBeginsWithDents) {
  database_ = yielding_body();
  database_.storage.chunk_nodes = 64;
  write_database(file_, database_);
  for (const LocalModel model : kLocalModels) {
    SimulationOptions o = options(model);
    const SimulationReport first = simulate(database_, o, stop_);
    EXPECT_TRUE(first.render.yields);
    EXPECT_FALSE(first.render.surface.empty()) << name(model);
    EXPECT_EQ(first.render.not_yielded, 0U);
    EXPECT_TRUE(
        replay(read_recording(recording_), read_database(file_)).is_reproduced())
        << name(model);
    o.surface.tool[first.tool] = first.render.surface;
    const SimulationReport second = simulate(database_, o, stop_);
    Recording recording = read_recording(recording_);
    EXPECT_EQ(recording.header.surface, first.render.surface);
    const ReplayReport report = replay(recording, read_database(file_));
    EXPECT_TRUE(report.is_reproduced()) << name(model) << ": " << report.different_in;
    if (follows_surface(model)) {
      EXPECT_GT(first.render.yielded_j, 0.0);
      EXPECT_LT(second.render.yielded_j, 0.1 * first.render.yielded_j);
      EXPECT_GE(second.render.model_work_j, 0.0);
    }
    // On a fresh surface the same way gives other forces.
    recording.header.surface = {};
    EXPECT_FALSE(replay(recording, read_database(file_)).is_reproduced())
        << name(model);
  }
}

// Skin of a weak body, over something that the needle does not reach.
Puncture thin_skin() {
  Puncture p{.rule = "force",
             .material = {"skin"},
             .membrane_n = {0.1},
             .cutting_n = {0.05},
             .friction_n_per_m = {5.0},
             .static_ratio = {1.2},
             .toughness_j_per_m2 = {100.0},
             .edge_width_m = 5e-4,
             .shaft_n_per_m = 100.0,
             .lateral_n_per_m2 = 1e3,
             .mouth_m = 2e-3,
             .rupture = {0.1}};
  p.layer_depth_m = RowsOf<double>::Zero(1, 1);
  p.layer_material = RowsOf<std::int32_t>::Zero(1, 1);
  return p;
}

// The second insertion finds the channel of the first: nothing breaks, nothing is cut.
TEST_F(Replay, ReproducesARunThatBeginsWithAChannel) {
  database_.tools[0].puncture = thin_skin();
  write_database(file_, database_);
  SimulationOptions o = options(LocalModel::kPotential);
  const SimulationReport first = simulate(database_, o, stop_);
  EXPECT_TRUE(replay(read_recording(recording_), read_database(file_)).is_reproduced());
  ASSERT_GT(first.render.needle.broken, 0U);
  ASSERT_EQ(first.render.surface.channels.size(), 1U);
  EXPECT_EQ(first.render.surface.channels[0].depth_m, first.render.needle.deepest_m);
  EXPECT_TRUE(first.render.surface.yielded.empty());

  o.surface.tool[first.tool] = first.render.surface;
  const SimulationReport second = simulate(database_, o, stop_);
  EXPECT_EQ(second.render.needle.broken, 0U);
  EXPECT_LT(second.render.needle.crack_j, 0.05 * first.render.needle.crack_j);
  EXPECT_GT(second.render.needle.shaft_j, 0.2 * first.render.needle.shaft_j);
  EXPECT_GE(second.render.lowest_work_j, -1e-12);
  Recording recording = read_recording(recording_);
  EXPECT_EQ(recording.header.surface, first.render.surface);
  const ReplayReport report = replay(recording, read_database(file_));
  EXPECT_TRUE(report.is_reproduced()) << report.different_in;
  // Without the channel the needle would have to break in.
  recording.header.surface = {};
  EXPECT_FALSE(replay(recording, read_database(file_)).is_reproduced());
  // What the tool does not puncture, no channel can go through.
  o.surface.tool[first.tool].channels[0].layer_material[0] = 1;
  EXPECT_THROW((void)simulate(database_, o, stop_), InputError);
}

TEST_F(Replay, AStreamedBodyYieldsAsOneInMemoryDoes) {
  database_ = yielding_body();
  database_.storage.chunk_nodes = 64;
  write_database(file_, database_);
  SimulationOptions o = options(LocalModel::kPotential);
  o.limit_stiffness = false;
  const SimulationReport streamed =
      simulate_streamed(file_, std::span(&o, 1), 64 * kMebibyte, stop_).front();
  EXPECT_GT(streamed.render.yielded_j, 0.0);
  const ReplayReport report = replay(read_recording(recording_), read_database(file_));
  EXPECT_TRUE(report.is_reproduced()) << report.different_in;
}

TEST_F(Replay, ReproducesARunInRealTimeWhateverItsTiming) {
  SimulationOptions o = options(LocalModel::kElement);
  o.real_time = true;
  o.duration_s = 1.5;
  const Recording recording = recorded(o);
  ASSERT_GT(recording.tick.size(), 10U);
  ASSERT_FALSE(recording.arrival.empty());
  EXPECT_EQ(recording.header.clock, "real");
  const ReplayReport report = replay(recording, database_);
  EXPECT_TRUE(report.is_reproduced()) << report.different_in;
}

TEST_F(Replay, ReproducesAStreamedRunFromTheWholeDatabase) {
  SimulationOptions o = options(LocalModel::kElement);
  (void)simulate_streamed(file_, std::span(&o, 1), std::size_t{32} << 20, stop_);
  const ReplayReport report = replay(read_recording(recording_), database_);
  EXPECT_TRUE(report.is_reproduced()) << report.different_in;
  EXPECT_GT(report.force_max_n, 0.1);
}

TEST_F(Replay, ReproducesScaledForces) {
  database_ = bumpy_body(4000.0);
  SimulationOptions o = options(LocalModel::kElement);
  o.device.damping_n_s_per_m = 0.1;
  const Recording recording = recorded(o);
  EXPECT_LT(recording.header.force_scale, 0.5);
  EXPECT_TRUE(replay(recording, database_).is_reproduced());
}

TEST_F(Replay, NamesTheFirstTickThatDiffers) {
  Recording recording = recorded(options(LocalModel::kElement));
  double& force = recording.tick[3210].force_n[2];
  force = std::nextafter(force, 1e9);
  const ReplayReport report = replay(recording, database_);
  EXPECT_FALSE(report.is_reproduced());
  EXPECT_EQ(report.different_tick, 3210);
  EXPECT_EQ(report.identical, 3210);
  EXPECT_NEAR(report.different_s, 1.605, 1e-9);
  EXPECT_NE(report.different_in.find("force z"), std::string::npos);
  EXPECT_GT(report.force_difference_n, 0.0);
}

TEST_F(Replay, StopsAtAGapAndSaysSo) {
  const Recording whole = recorded(options(LocalModel::kElement));
  Recording recording = whole;
  recording.tick.erase(recording.tick.begin() + 500);
  ReplayReport report = replay(recording, database_);
  EXPECT_EQ(report.gap_tick, 500);
  EXPECT_EQ(report.identical, 500);
  EXPECT_FALSE(report.is_reproduced());

  recording = whole;
  recording.arrival.erase(recording.arrival.begin() + 100);
  report = replay(recording, database_);
  EXPECT_GT(report.gap_tick, 0);
  EXPECT_FALSE(report.is_reproduced());

  recording = whole;
  recording.tick.erase(recording.tick.begin());
  EXPECT_FALSE(replay(recording, database_).is_reproduced());
}

TEST_F(Replay, OfAStifferBodyShowsForcesInProportion) {
  const Recording recording = recorded(options(LocalModel::kElement));
  const ReplayReport same = render_again(recording, database_, LocalModel::kElement);
  const ReplayReport stiffer =
      render_again(recording, bumpy_body(120.0), LocalModel::kElement);
  EXPECT_LT(same.force_rms_n, 2e-3 * same.force_max_n);  // elements a tick earlier
  EXPECT_NEAR(stiffer.replayed_max_n, 1.2 * same.replayed_max_n,
              1e-3 * same.replayed_max_n);
  EXPECT_NEAR(stiffer.replayed_net_j, 1.2 * same.replayed_net_j,
              1e-2 * same.replayed_net_j);
}

TEST_F(Replay, WithAnotherModelRendersTheSameTrajectory) {
  const Recording recording = recorded(options(LocalModel::kElement));
  const ReplayReport report = render_again(recording, database_, LocalModel::kSingle);
  EXPECT_EQ(report.compared, 8000);
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_GT(report.force_rms_n, 1e-3);
  EXPECT_LT(report.force_difference_n, report.force_max_n);
}

TEST_F(Replay, RefusesAnotherDatabaseAndAnotherModelByName) {
  const Recording recording = recorded(options(LocalModel::kElement));
  EXPECT_NO_THROW(check_same_database(recording, database_sha256(file_), "body.h5"));
  try {
    check_same_database(recording, std::string(64, '0'), "other.h5");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("other.h5: is not the database"),
              std::string::npos);
  }
  Recording foreign = recording;
  foreign.header.model = "magic";
  EXPECT_THROW((void)replay(foreign, database_), FormatError);
  foreign = recording;
  foreign.header.force_max_n = -1.0;
  EXPECT_THROW((void)replay(foreign, database_), FormatError);
  foreign = recording;
  foreign.arrival[0].triangle = 1 << 30;
  EXPECT_THROW((void)replay(foreign, database_), FormatError);
}

TEST_F(Replay, HoldsAnUnfinishedRecordingOfAKilledRun) {
  const Recording whole = recorded(options(LocalModel::kElement));
  Recording cut = whole;
  cut.ended = false;
  cut.tick.resize(4096);
  EXPECT_TRUE(replay(cut, database_).is_reproduced());
}

}  // namespace
}  // namespace palpate
