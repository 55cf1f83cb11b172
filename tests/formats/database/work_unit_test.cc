#include "formats/database/work_unit.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/error_calibration.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/sample_units.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using Limits = std::numeric_limits<double>;

void expect_same(const WorkUnitNode& a, const WorkUnitNode& b) {
  EXPECT_EQ(a.tool, b.tool);
  EXPECT_EQ(a.vertex, b.vertex);
  EXPECT_EQ(a.failure, b.failure);
  EXPECT_EQ(a.history, b.history);
  EXPECT_EQ(a.response.direction, b.response.direction);
  EXPECT_EQ(a.response.direction_spread_rad, b.response.direction_spread_rad);
  EXPECT_EQ(a.response.touch_offset_m, b.response.touch_offset_m);
  EXPECT_EQ(a.response.depth_m, b.response.depth_m);
  EXPECT_EQ(a.response.force_n, b.response.force_n);
  EXPECT_EQ(a.response.sample_direction, b.response.sample_direction);
  EXPECT_EQ(a.response.error_relative, b.response.error_relative);
  EXPECT_EQ(a.response.origin, b.response.origin);
  EXPECT_EQ(a.response.flags, b.response.flags);
}

void expect_same(const WorkUnitOutcome& a, const WorkUnitOutcome& b) {
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.is_check, b.is_check);
  ASSERT_EQ(a.node.size(), b.node.size());
  for (std::size_t i = 0; i < a.node.size(); ++i) {
    expect_same(a.node[i], b.node[i]);
  }
}

void expect_same(const ToolShape& a, const ToolShape& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.radius_m, b.radius_m);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.presliding_m, b.presliding_m);
  EXPECT_EQ(a.edge_radius_m, b.edge_radius_m);
  EXPECT_EQ(a.half_angle_rad, b.half_angle_rad);
  EXPECT_EQ(a.tip_radius_m, b.tip_radius_m);
  EXPECT_EQ(a.length_m, b.length_m);
  EXPECT_EQ(a.mesh.position_m, b.mesh.position_m);
  EXPECT_EQ(a.mesh.triangle, b.mesh.triangle);
  EXPECT_EQ(a.axis, b.axis);
  EXPECT_EQ(a.sticking, b.sticking);
}

void expect_same(const JobDescription& a, const JobDescription& b) {
  EXPECT_EQ(a.digest, b.digest);
  EXPECT_EQ(a.units, b.units);
  EXPECT_EQ(a.body.position_m, b.body.position_m);
  EXPECT_EQ(a.body.triangle, b.body.triangle);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.force_relative, b.force_relative);
  EXPECT_EQ(a.reachable, b.reachable);
  EXPECT_EQ(a.depth_max_m, b.depth_max_m);
  EXPECT_EQ(a.force_max_n, b.force_max_n);
  EXPECT_EQ(a.provenance.writer, b.provenance.writer);
  EXPECT_EQ(a.provenance.scene_toml, b.provenance.scene_toml);
  EXPECT_EQ(a.provenance.source_file, b.provenance.source_file);
  EXPECT_EQ(a.provenance.source_sha256, b.provenance.source_sha256);
  EXPECT_EQ(a.relaxation.rule, b.relaxation.rule);
  EXPECT_EQ(a.relaxation.instantaneous, b.relaxation.instantaneous);
  EXPECT_EQ(a.relaxation.tau_s, b.relaxation.tau_s);
  EXPECT_EQ(a.relaxation.g, b.relaxation.g);
  EXPECT_EQ(a.bundles, b.bundles);
  ASSERT_EQ(a.puncture.size(), b.puncture.size());
  for (std::size_t i = 0; i < a.puncture.size(); ++i) {
    EXPECT_TRUE(same(a.puncture[i], b.puncture[i]));
  }
  ASSERT_EQ(a.tool.size(), b.tool.size());
  for (std::size_t i = 0; i < a.tool.size(); ++i) {
    expect_same(a.tool[i], b.tool[i]);
  }
}

JobDescription puncturing_plan() {
  JobDescription plan = sample_plan();
  plan.puncture = {known_puncture(plan.body.position_m.rows())};
  return plan;
}

JobDescription relaxing_plan() {
  JobDescription plan = sample_plan();
  plan.relaxation.rule = "one for all";
  plan.relaxation.instantaneous = true;
  plan.relaxation.tau_s = {0.5, 4.0};
  plan.relaxation.g = RowsOf<float>{{0.25F, 0.3F}};
  plan.bundles = 3;
  return plan;
}

TEST(UnitBytes, KeepEveryFieldOfAUnit) {
  for (const WorkUnitOutcome& unit : sample_units()) {
    expect_same(unit, unit_from_bytes(to_bytes(unit), "unit"));
  }
}

TEST(UnitBytes, KeepNumbersAtTheEdgesOfDoublePrecision) {
  WorkUnitOutcome unit = sample_units().front();
  unit.node.front().response.force_n = {0.0, Limits::denorm_min(), Limits::min(),
                                        1.0 + Limits::epsilon(), Limits::max()};
  unit.node.front().response.touch_offset_m = -0.0;
  unit.node.front().response.sample_direction.assign(
      5, Eigen::Vector3d(1.0 / 3.0, -0.0, Limits::epsilon()));
  const WorkUnitOutcome back = unit_from_bytes(to_bytes(unit), "unit");
  expect_same(unit, back);
  EXPECT_TRUE(std::signbit(back.node.front().response.touch_offset_m));
}

TEST(UnitBytes, KeepEveryFieldOfAPlan) {
  JobDescription plan = sample_plan();
  expect_same(plan, plan_from_bytes(to_bytes(plan), "plan"));
  plan.force_max_n = Limits::infinity();  // a scene without a largest force
  plan.tool.front().axis.reset();
  expect_same(plan, plan_from_bytes(to_bytes(plan), "plan"));
  plan = relaxing_plan();
  expect_same(plan, plan_from_bytes(to_bytes(plan), "plan"));
  plan = puncturing_plan();  // with numbers that are infinite and none
  expect_same(plan, plan_from_bytes(to_bytes(plan), "plan"));
  plan.puncture = {some_puncture(1), {}};
  expect_same(plan, plan_from_bytes(to_bytes(plan), "plan"));
}

TEST(Assemble, GivesEveryToolItsPuncture) {
  const JobDescription plan = puncturing_plan();
  const ResponseDatabase database = assemble(plan, sample_units(), {}).database;
  EXPECT_TRUE(same(database.tools.front().puncture, plan.puncture.front()));
  EXPECT_NO_THROW(check(database));
  EXPECT_TRUE(assemble(sample_plan(), sample_units(), {})
                  .database.tools.front()
                  .puncture.empty());
}

TEST(Assemble, GivesEveryToolOfARelaxingJobItsMemory) {
  const ResponseDatabase database =
      assemble(relaxing_plan(), sample_units(), {}).database;
  const ResponseTable& table = database.tools.front();
  const Viscoelasticity& relaxation = table.viscoelasticity;
  EXPECT_EQ(relaxation.tau_s, (std::vector<double>{0.5, 4.0}));
  EXPECT_EQ(relaxation.g.rows(), 1);
  EXPECT_TRUE(relaxation.instantaneous);
  ASSERT_EQ(relaxation.bundle_depth_m.size(), 2U);
  EXPECT_NEAR(relaxation.bundle_depth_m[1],
              table.depth_max_m() * std::pow(2.0 / 3.0, 1.5), 1e-15);
  // Nodes remember where they have a response.
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    EXPECT_EQ(relaxation.sites.site(node, 0) < 0, table.curve(node).depth_m.empty());
  }
  EXPECT_TRUE(assemble(sample_plan(), sample_units(), {})
                  .database.tools.front()
                  .viscoelasticity.empty());
}

TEST(UnitBytes, ThatAreCutAnywhereAreRefusedByName) {
  const std::vector<std::byte> bytes = to_bytes(sample_units().front());
  for (std::size_t kept = 0; kept < bytes.size(); kept += 1 + bytes.size() / 50) {
    try {
      (void)unit_from_bytes(std::span(bytes).first(kept), "unit-000000");
      FAIL() << kept << " of " << bytes.size() << " bytes were read";
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find("unit-000000"), std::string::npos);
    }
  }
}

TEST(ShardFile, HoldsPlanAndUnits) {
  const ScratchFolder folder;
  const auto file = folder / "part";
  write_shard(file, {sample_plan(), sample_units()});
  EXPECT_TRUE(is_shard(file));
  const Shard shard = read_shard(file);
  expect_same(shard.plan, sample_plan());
  const std::vector<WorkUnitOutcome> units = sample_units();
  ASSERT_EQ(shard.unit.size(), units.size());
  for (std::size_t i = 0; i < units.size(); ++i) {
    expect_same(shard.unit[i], units[i]);
  }
}

TEST(ShardFile, WithAnyByteChangedIsRefused) {
  const ScratchFolder folder;
  const auto file = folder / "part";
  write_shard(file, {sample_plan(), sample_units()});
  const std::string whole = bytes_of(file);
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 200) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    std::ofstream(file, std::ios::binary) << damaged;
    EXPECT_THROW((void)read_shard(file), FormatError) << "byte " << at;
  }
  for (const std::size_t kept : {std::size_t{20}, whole.size() / 2, whole.size() - 1}) {
    std::ofstream(file, std::ios::binary) << whole.substr(0, kept);
    EXPECT_THROW((void)read_shard(file), FormatError) << kept << " bytes";
  }
}

TEST(ShardFile, IsToldFromOthers) {
  const ScratchFolder folder;
  const auto text = folder / "text";
  std::ofstream(text) << "palpate";
  EXPECT_FALSE(is_shard(text));
  EXPECT_FALSE(is_shard(folder / "missing"));
  EXPECT_THROW((void)read_shard(text), FormatError);
  EXPECT_THROW((void)read_shard(folder / "missing"), InputError);
}

TEST(Assembly, CountsEveryNodeOnce) {
  const Assembly all = assemble(sample_plan(), sample_units(), {});
  EXPECT_EQ(all.solved, 3);
  EXPECT_EQ(all.interpolated, 1);
  EXPECT_EQ(all.failed, 1);
  EXPECT_EQ(all.truncated, 1);
  EXPECT_EQ(all.untouched, 0);
  EXPECT_EQ(all.outside_reach, 1);
  EXPECT_EQ(all.failures.size(), 2U);
  EXPECT_TRUE(std::is_sorted(all.error.begin(), all.error.end()));
  EXPECT_EQ(all.error.size(), 4U);
}

TEST(Assembly, KeepsEachHistoryOnceAndByNodeWhichItIs) {
  std::vector<WorkUnitOutcome> units = sample_units();
  units[0].node[0].history = "touches late: mesh 2 times finer";
  units[1].node[0].history = "failed: mesh 2 times coarser";
  units[1].node[1].history = units[0].node[0].history;
  units[2].node[0].history = "a check's own";
  const Assembly all = assemble(sample_plan(), units, {});
  const ResponseTable& table = all.database.tools.front();
  EXPECT_EQ(table.history_text, (std::vector<std::string>{units[0].node[0].history,
                                                          units[1].node[0].history}));
  EXPECT_EQ(table.history, (std::vector<std::int32_t>{0, -1, -1, 1, 0, -1}));
  EXPECT_NO_THROW(check(all.database));
  for (WorkUnitOutcome& unit : units) {
    for (WorkUnitNode& node : unit.node) {
      node.history.clear();
    }
  }
  EXPECT_TRUE(
      assemble(sample_plan(), units, {}).database.tools.front().history.empty());
}

TEST(Assembly, MeasuresChecksAgainstWhatUnitsAnswered) {
  // The check's forces are 1.1 times those of the node that it solves again.
  const Assembly all = assemble(sample_plan(), sample_units(), {});
  ASSERT_EQ(all.checked.size(), 1U);
  EXPECT_NEAR(all.checked.front(), 0.1 / 1.1, 1e-12);
}

TEST(Assembly, StatesEstimatesTimesWhatTheChecksFound) {
  const JobDescription plan = sample_plan();
  std::vector<WorkUnitOutcome> units = sample_units();
  const Assembly all = assemble(plan, units, {});
  const ResponseTable& table = all.database.tools.front();
  EXPECT_EQ(table.accuracy.error_factor, all.error_factor);
  EXPECT_EQ(table.accuracy.verified, 1);
  EXPECT_GE(all.error_factor, kLeastErrorFactor);
  std::int64_t over = 0;
  for (const WorkUnitOutcome& unit : units) {
    for (const WorkUnitNode& node : unit.node) {
      const auto v = static_cast<std::size_t>(node.vertex);
      if (!unit.is_check && !node.response.depth_m.empty()) {
        const double stated = all.error_factor * node.response.error_relative;
        EXPECT_DOUBLE_EQ(table.error_relative[v], stated);
        EXPECT_EQ((table.flags[v] & kErrorOverBudget) != 0,
                  stated > plan.force_relative ||
                      (node.response.flags & kErrorOverBudget) != 0);
        over += (table.flags[v] & kErrorOverBudget) != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(all.over_budget, over);
}

TEST(Assembly, StatesWhatShareOfNodesSoManyChecksCover) {
  const Assembly one = assemble(sample_plan(), sample_units(), {});
  EXPECT_DOUBLE_EQ(one.error_covered, 0.5);
  EXPECT_DOUBLE_EQ(one.database.tools.front().accuracy.covered, 0.5);
  EXPECT_EQ(one.checked_in_vain, 0);
  std::vector<WorkUnitOutcome> units = sample_units();
  units[2].node.front().response = {};
  units[2].node.front().failure = "it does not converge";
  const Assembly none = assemble(sample_plan(), units, {});
  EXPECT_EQ(none.error_covered, 0.0);
  EXPECT_EQ(none.checked_in_vain, 1);
  EXPECT_TRUE(none.checked.empty());
  EXPECT_NO_THROW(check(none.database));
}

// A force that turns by 0.6 over a depth as long as the node's edges, 28.3 mm, and one
// that turns by 0.4: the first is limited, and what it lost is in its error.
TEST(Assembly, LimitsTiltsAndSaysSo) {
  const JobDescription plan = sample_plan();
  std::vector<WorkUnitOutcome> units = sample_units();
  const double edge_m = 0.02 * std::sqrt(2.0);
  for (WorkUnitOutcome& unit : units) {
    for (WorkUnitNode& node : unit.node) {
      if (node.response.origin != ResponseOrigin::kNone) {
        const Eigen::Vector3d n = plan.normal.row(node.vertex).transpose();
        node.response.tilt = TiltLine{.by_depth_per_m = (node.vertex == 0 ? 0.6 : 0.4) /
                                                        edge_m * n.unitOrthogonal()};
      }
    }
  }
  const Assembly steep = assemble(plan, units, {});
  EXPECT_EQ(steep.tilts_limited, 1);
  EXPECT_NE(steep.database.provenance.left_out.find("tilts of 1 of"), std::string::npos)
      << steep.database.provenance.left_out;
  const ResponseTable& table = steep.database.tools[0];
  EXPECT_NEAR(table.tilt_by_depth_per_m.row(0).norm() * edge_m, 0.5, 1e-12);
  const Assembly none = assemble(plan, sample_units(), {});
  EXPECT_EQ(none.tilts_limited, 0);
  EXPECT_EQ(none.database.provenance.left_out.find("tilts of"), std::string::npos);
  EXPECT_GT(table.error_relative[0], none.database.tools[0].error_relative[0]);
}

TEST(Assembly, DoesNotDependOnTheOrderOfUnits) {
  const ScratchFolder folder;
  std::vector<WorkUnitOutcome> units = sample_units();
  write_database(folder / "a.h5", assemble(sample_plan(), units, {}).database);
  std::reverse(units.begin(), units.end());
  write_database(folder / "b.h5", assemble(sample_plan(), units, {}).database);
  EXPECT_TRUE(bytes_of(folder / "a.h5") == bytes_of(folder / "b.h5"));
}

std::string refusal(const JobDescription& plan,
                    const std::vector<WorkUnitOutcome>& units) {
  try {
    (void)assemble(plan, units, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Assembly, NamesUnitsThatAreMissingTwiceOrForeign) {
  const JobDescription plan = sample_plan();
  std::vector<WorkUnitOutcome> units = sample_units();
  const WorkUnitOutcome last = units.back();
  units.pop_back();
  EXPECT_EQ(refusal(plan, units), "1 of 3 units are missing: 2");
  units.push_back(units.front());
  EXPECT_EQ(refusal(plan, units), "unit 0 comes twice");
  units.back() = last;
  units.back().index = 3;
  EXPECT_EQ(refusal(plan, units), "unit 3 is none of the plan's 3");
  units.back() = last;
  units.back().node.front().vertex = 6;
  EXPECT_NE(refusal(plan, units).find("vertex 6"), std::string::npos);
  units.back().node.front().vertex = 0;
  units.back().node.front().tool = 1;
  EXPECT_NE(refusal(plan, units).find("tool 1"), std::string::npos);
}

TEST(Assembly, WithoutAnyResponseIsNoDatabase) {
  JobDescription plan = sample_plan();
  std::vector<WorkUnitOutcome> units = sample_units();
  for (WorkUnitOutcome& unit : units) {
    for (WorkUnitNode& node : unit.node) {
      node.response = {};
      node.failure.clear();
    }
  }
  const Assembly none = assemble(plan, units, {});
  EXPECT_EQ(none.untouched, 5);
  EXPECT_THROW(require_responses(plan, none), NumericalError);
  EXPECT_NO_THROW(require_responses(plan, assemble(plan, sample_units(), {})));
}

}  // namespace
}  // namespace palpate
