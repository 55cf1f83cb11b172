// Runs of tools with several contacts, and of two hands, on a padded plate.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/database/table_memory.h"
#include "runtime/run/replay.h"
#include "runtime/run/several_run.h"
#include "tests/support/padded_plate.h"
#include "tests/support/test_data.h"

namespace palpate {

class ContactRuns : public testing::Test {
 protected:
  SimulationReport run(const SimulationOptions& options) {
    return simulate(database_, options, stop_);
  }
  static SimulationOptions options(const std::string& tool) {
    SimulationOptions o;
    o.tool = tool;
    o.duration_s = 4.0;
    o.limit_stiffness = true;
    return o;
  }
  // Two fingers 14 mm apart.
  static SimulationOptions pinch() {
    SimulationOptions o = options("ball");
    o.at_m = Eigen::Vector3d(-0.007, 0.0, 0.0);
    o.together = SecondHand{.tool = "ball", .at_m = Eigen::Vector3d(0.007, 0.0, 0.0)};
    return o;
  }
  // Renders, and again what was recorded of it.
  ReplayReport replayed(SimulationOptions o, Recording& recording) {
    o.recording.file = folder_ / "run.h5";
    last_ = run(o);
    recording = read_recording(o.recording.file);
    return replay(recording, database_);
  }
  void give_all(const Viscoelasticity& relaxation) {
    for (ResponseTable& table : database_.tools) {
      give_memory(database_.body, database_.normal, relaxation, 1, table);
    }
  }
  static void expect_balance(const RenderReport& r) {
    EXPECT_EQ(r.fault, Fault::kNone);
    EXPECT_GE(r.lowest_work_j, -1e-12);
    EXPECT_NEAR(r.model_work_j, r.stored_j + r.tank_j + r.memory_j + r.dissipated_j,
                1e-12);
  }

  ResponseDatabase database_ = padded_plate(3);
  ScratchFolder folder_;
  SimulationReport last_;
  std::atomic<bool> stop_ = false;
};

}  // namespace palpate
