#include "formats/database/response_database.h"

#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/select_nodes.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"
#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

void expect_equal(const ToolShape& a, const ToolShape& b) {
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

void expect_equal(const ResponseTable& a, const ResponseTable& b) {
  expect_equal(a.tool, b.tool);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.direction_spread_rad, b.direction_spread_rad);
  EXPECT_EQ(a.touch_offset_m, b.touch_offset_m);
  EXPECT_EQ(a.error_relative, b.error_relative);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.presliding_m, b.presliding_m);
  EXPECT_EQ(a.stiffness_max_n_per_m, b.stiffness_max_n_per_m);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.sample_begin, b.sample_begin);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.force_n, b.force_n);
  EXPECT_EQ(a.stiffness_n_per_m, b.stiffness_n_per_m);
  EXPECT_EQ(a.energy_j, b.energy_j);
}

TEST(ResponseDatabase, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  ResponseDatabase written = small_database();
  written.measurement = {{0.0, 0.001, 0.0005}, {0.0, 0.2, -0.01}};
  write_database(folder / "a.h5", written);
  const ResponseDatabase read = read_database(folder / "a.h5");
  EXPECT_EQ(read.body.position_m, written.body.position_m);
  EXPECT_EQ(read.body.triangle, written.body.triangle);
  EXPECT_EQ(read.normal, written.normal);
  ASSERT_EQ(read.tools.size(), written.tools.size());
  for (std::size_t i = 0; i < read.tools.size(); ++i) {
    expect_equal(read.tools[i], written.tools[i]);
  }
  EXPECT_EQ(read.measurement.depth_m, written.measurement.depth_m);
  EXPECT_EQ(read.measurement.force_n, written.measurement.force_n);
  EXPECT_EQ(read.provenance.writer, written.provenance.writer);
  EXPECT_EQ(read.provenance.scene_toml, written.provenance.scene_toml);
  EXPECT_EQ(read.provenance.source_file, written.provenance.source_file);
  EXPECT_EQ(read.provenance.source_sha256, written.provenance.source_sha256);
  EXPECT_EQ(read.provenance.left_out, written.provenance.left_out);
  EXPECT_EQ(read.provenance.plan_sha256, written.provenance.plan_sha256);
}

TEST(ResponseDatabase, KeepsTheShapeOfEveryTool) {
  const ScratchFolder folder;
  ResponseDatabase written = small_database();
  const ResponseTable table = written.tools[0];
  written.tools.clear();
  ToolShape tilted = cone(0.5, 0.001, 0.02);
  tilted.axis = Eigen::Vector3d(0.6, 0.0, 0.8);
  tilted.sticking = true;
  for (const ToolShape& tool :
       {flat_punch(0.005, 0.001), tilted, capsule(0.004, 0.01), box_tool({1, 2, 3})}) {
    written.tools.push_back(table);
    written.tools.back().tool = tool;
  }
  write_database(folder / "a.h5", written);
  const ResponseDatabase read = read_database(folder / "a.h5");
  ASSERT_EQ(read.tools.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    expect_equal(read.tools[i], written.tools[i]);
  }
}

// Everything that a table may hold beyond what it must.
void fill_optional_parts(ResponseTable& table) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  table.verified_error_relative = {nan, 0.01, 0.03, nan, nan, nan};
  table.flags[1] |= kTruncatedPath;
  table.flags[3] |= kExtrapolated;
  table.flags[5] |= kFailed;
  table.failure = {-1, 1, -1, -1, -1, 0};
  table.failure_reason = {"folded at 2 mm", "no convergence after 40 steps"};
  table.history = {0, -1, -1, 1, -1, 0};
  table.history_text = {"touches late: mesh 2 times finer",
                        "failed: mesh 2 times coarser"};
  table.force_errors_n.assign(table.force_n.size(), 0.001);
  // Node 0 has four samples, each with its own direction.
  table.direction_begin = {0, 4, 4, 4, 4, 4, 4};
  table.sample_direction = Points::Zero(4, 3);
  table.sample_direction.col(2).setOnes();
  table.accuracy = {0.05, 1.3,        2.1,          0.9,        0.5,         2,
                    1,    {0.5, 1.0}, {0.02, 0.03}, {0.1, 0.5}, {0.04, 0.02}};
  table.displacement.basis.setRandom(18, 2);
  table.displacement.coefficient.setRandom(3, 2);
  table.displacement.node = {0, 2, 4};
  table.displacement.depth_m = {0.005, 0.005, 0.004};
  table.displacement.error_relative = {0.01, 0.02, 0.03};
}

// NaN compares equal to NaN here.
std::vector<std::string> printed(const std::vector<double>& values) {
  std::vector<std::string> list;
  for (const double value : values) {
    list.push_back(fmt::format("{}", value));
  }
  return list;
}

TEST(ResponseDatabase, KeepsTheOptionalParts) {
  const ScratchFolder folder;
  ResponseDatabase written = small_database();
  fill_optional_parts(written.tools[1]);
  write_database(folder / "a.h5", written);
  const ResponseDatabase read = read_database(folder / "a.h5");
  EXPECT_TRUE(read.tools[0].verified_error_relative.empty());
  EXPECT_TRUE(read.tools[0].failure.empty());
  EXPECT_EQ(read.tools[0].displacement.coefficient.rows(), 0);
  const ResponseTable& a = read.tools[1];
  const ResponseTable& b = written.tools[1];
  expect_equal(a, b);
  EXPECT_EQ(printed(a.verified_error_relative), printed(b.verified_error_relative));
  EXPECT_EQ(a.failure, b.failure);
  EXPECT_EQ(a.failure_reason, b.failure_reason);
  EXPECT_EQ(a.history, b.history);
  EXPECT_EQ(a.history_text, b.history_text);
  EXPECT_EQ(a.force_errors_n, b.force_errors_n);
  EXPECT_EQ(a.direction_begin, b.direction_begin);
  EXPECT_EQ(a.sample_direction, b.sample_direction);
  EXPECT_EQ(a.accuracy.budget_relative, b.accuracy.budget_relative);
  EXPECT_EQ(a.accuracy.error_factor, b.accuracy.error_factor);
  EXPECT_EQ(a.accuracy.hard_error_factor, b.accuracy.hard_error_factor);
  EXPECT_EQ(a.accuracy.covered, b.accuracy.covered);
  EXPECT_EQ(a.accuracy.hard_covered, b.accuracy.hard_covered);
  EXPECT_EQ(a.accuracy.verified, b.accuracy.verified);
  EXPECT_EQ(a.accuracy.between_nodes, b.accuracy.between_nodes);
  EXPECT_EQ(a.accuracy.quantile_level, b.accuracy.quantile_level);
  EXPECT_EQ(a.accuracy.error_relative, b.accuracy.error_relative);
  EXPECT_EQ(a.accuracy.depth_share, b.accuracy.depth_share);
  EXPECT_EQ(a.accuracy.covering_relative, b.accuracy.covering_relative);
  EXPECT_EQ(a.displacement.basis, b.displacement.basis);
  EXPECT_EQ(a.displacement.coefficient, b.displacement.coefficient);
  EXPECT_EQ(a.displacement.node, b.displacement.node);
  EXPECT_EQ(a.displacement.depth_m, b.displacement.depth_m);
  EXPECT_EQ(a.displacement.error_relative, b.displacement.error_relative);
}

TEST(ResponseDatabase, KeepsTheRunsOfAMeasurement) {
  const ScratchFolder folder;
  ResponseDatabase written = small_database();
  Measurement& m = written.measurement;
  m.depth_m = {0.0, 0.001, 0.0, 0.002};
  m.force_n = {0.0, 0.2, 0.01, 0.3};
  m.time_s = {0.0, 1.0, 0.0, 1.0};
  m.depth_errors_m.assign(4, 1e-6);
  m.force_errors_n.assign(4, 1e-3);
  m.run_begin = {0, 2, 4};
  m.run_node = {3, -1};
  m.run_name = {"first.csv", "second.csv"};
  write_database(folder / "a.h5", written);
  const Measurement read = read_database(folder / "a.h5").measurement;
  EXPECT_EQ(read.time_s, m.time_s);
  EXPECT_EQ(read.depth_errors_m, m.depth_errors_m);
  EXPECT_EQ(read.force_errors_n, m.force_errors_n);
  EXPECT_EQ(read.run_begin, m.run_begin);
  EXPECT_EQ(read.run_node, m.run_node);
  EXPECT_EQ(read.run_name, m.run_name);
}

TEST(ResponseDatabase, EmptyTextsAndNoMeasurementComeBackEmpty) {
  const ScratchFolder folder;
  ResponseDatabase written = small_database();
  written.provenance = {};
  write_database(folder / "a.h5", written);
  const ResponseDatabase read = read_database(folder / "a.h5");
  EXPECT_EQ(read.provenance.scene_toml, "");
  EXPECT_EQ(read.provenance.writer, "");
  EXPECT_TRUE(read.measurement.depth_m.empty());
}

TEST(ResponseDatabase, EqualContentGivesEqualBytes) {
  const ScratchFolder folder;
  write_database(folder / "a.h5", small_database());
  write_database(folder / "b.h5", read_database(folder / "a.h5"));
  EXPECT_EQ(bytes_of(folder / "a.h5"), bytes_of(folder / "b.h5"));
}

TEST(ResponseDatabase, AnInvalidDatabaseIsNotWritten) {
  const ScratchFolder folder;
  ResponseDatabase database = small_database();
  database.tools[0].force_n[2] = std::nan("");
  EXPECT_THROW(write_database(folder / "a.h5", database), FormatError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ResponseDatabase, FindsAToolByNameOrTheOnlyOne) {
  ResponseDatabase database = small_database();
  EXPECT_EQ(find_tool(database, "ball").tool.radius_m, 0.005);
  EXPECT_THROW((void)find_tool(database, ""), InputError);
  try {
    (void)find_tool(database, "bal");
    FAIL() << "found a tool that is not there";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "unknown tool \"bal\"; there are: tip, ball");
  }
  database.tools.pop_back();
  EXPECT_EQ(find_tool(database, "").tool.name, "tip");
}

TEST(ResponseDatabase, InFileOrderHoldsTheSameNodesInAnotherOrder) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  write_database(file, small_database());
  const ResponseDatabase source = read_database(file);
  const ResponseDatabase stored = read_in_file_order(file);
  const StorageOrder order = storage_order(source.body);
  for (std::size_t row = 0; row < order.node.size(); ++row) {
    const Eigen::Index node = order.node[row];
    EXPECT_EQ(stored.body.position_m.row(static_cast<Eigen::Index>(row)),
              source.body.position_m.row(node));
    EXPECT_EQ(stored.tools[0].error_relative[row],
              source.tools[0].error_relative[static_cast<std::size_t>(node)]);
  }
}

}  // namespace
}  // namespace palpate
