// Contact sets and compliances over distance through a database file: written, read
// whole and by chunks, sliced, compared, described, refused.
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_diff.h"
#include "formats/database/database_slice.h"
#include "formats/database/database_summary.h"
#include "formats/database/work_unit.h"
#include "tests/formats/database/violation.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// Rows that differ from node to node and from knot to knot.
ComplianceTable rising(std::int64_t nodes) {
  ComplianceTable table;
  table.distance_m = log_spaced(0.002, 0.1, 7);
  table.value.resize(nodes, 7);
  for (Eigen::Index i = 0; i < nodes; ++i) {
    for (Eigen::Index k = 0; k < 7; ++k) {
      table.value(i, k) = 1e-6F * static_cast<float>(3 * i - k);
    }
  }
  table.mode = RowsOf<float>::Random(nodes, 3);
  table.added_modes = 2;
  table.error_relative = 0.03;
  table.convex = true;
  return table;
}

ToolShape two_pads() {
  ToolShape tool{.name = "pads", .radius_m = 0.005};
  tool.contact.point_m = Points(2, 3);
  tool.contact.point_m << 0.0, 0.0, 0.0, 0.012, 0.0, 0.001;
  tool.contact.radius_m = {0.005, 0.005};
  return tool;
}

ResponseDatabase coupled_sphere() {
  ResponseDatabase database = sphere_database(24, 6);
  ResponseTable& table = database.tools[0];
  table.tool = two_pads();
  table.compliance = rising(table.nodes());
  database.storage.chunk_nodes = 100;
  return database;
}

void expect_equal_compliance(const ComplianceTable& a, const ComplianceTable& b) {
  EXPECT_EQ(a.distance_m, b.distance_m);
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.added_modes, b.added_modes);
  EXPECT_EQ(a.error_relative, b.error_relative);
  EXPECT_EQ(a.convex, b.convex);
}

TEST(DatabaseCompliance, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  const ResponseDatabase written = coupled_sphere();
  write_database(folder / "a.h5", written);
  const ResponseTable read = read_database(folder / "a.h5").tools[0];
  expect_equal_compliance(read.compliance, written.tools[0].compliance);
  EXPECT_EQ(read.tool.contact.point_m, two_pads().contact.point_m);
  EXPECT_EQ(read.tool.contact.radius_m, two_pads().contact.radius_m);
}

TEST(DatabaseCompliance, ChunksHaveTheRowsOfTheWhole) {
  const ScratchFolder folder;
  write_database(folder / "a.h5", coupled_sphere());
  const ComplianceTable all = read_in_file_order(folder / "a.h5").tools[0].compliance;
  const ChunkReader reader(folder / "a.h5");
  const ToolIndex& tool = reader.index().tools[0];
  EXPECT_EQ(tool.tool.contact.radius_m.size(), 2U);
  EXPECT_EQ(tool.compliance.distance_m, all.distance_m);
  EXPECT_TRUE(tool.compliance.convex);
  ASSERT_GT(reader.index().chunks(), 5);
  for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
    const ComplianceTable part = reader.responses(0, k).compliance;
    const std::int64_t begin = reader.index().node_begin[static_cast<std::size_t>(k)];
    EXPECT_EQ(part.value, all.value.middleRows(begin, part.value.rows()));
    EXPECT_EQ(part.distance_m, all.distance_m);
    EXPECT_EQ(part.mode, all.mode.middleRows(begin, part.value.rows()));
    EXPECT_EQ(part.added_modes, 2);
  }
}

TEST(DatabaseCompliance, FilesWithoutHaveNone) {
  const ScratchFolder folder;
  write_database(folder / "a.h5", sphere_database(24, 6));
  EXPECT_TRUE(read_database(folder / "a.h5").tools[0].compliance.empty());
  const ChunkReader reader(folder / "a.h5");
  EXPECT_TRUE(reader.responses(0, 0).compliance.empty());
}

TEST(DatabaseCompliance, ASliceKeepsTheRowsOfItsNodes) {
  const ResponseDatabase whole = coupled_sphere();
  SliceOptions options;
  options.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1.0, -1.0, 0.0),
                                      Eigen::Vector3d(1.0, 1.0, 1.0));
  const ResponseDatabase part = slice(whole, options);
  ASSERT_LT(part.body.position_m.rows(), whole.body.position_m.rows());
  for (Eigen::Index i = 0; i < part.body.position_m.rows(); ++i) {
    Eigen::Index same = 0;
    (whole.body.position_m.rowwise() - part.body.position_m.row(i))
        .rowwise()
        .squaredNorm()
        .minCoeff(&same);
    EXPECT_EQ(part.tools[0].compliance.value.row(i),
              whole.tools[0].compliance.value.row(same));
    EXPECT_EQ(part.tools[0].compliance.mode.row(i),
              whole.tools[0].compliance.mode.row(same));
  }
}

TEST(DatabaseCompliance, DatabasesThatCoupleDifferentlyDiffer) {
  const ResponseDatabase database = coupled_sphere();
  ResponseDatabase other = database;
  EXPECT_TRUE(difference(database, other, 0)[0].agrees(0.0));
  const float largest = database.tools[0].compliance.value.cwiseAbs().maxCoeff();
  other.tools[0].compliance.value(3, 2) += 0.02F * largest;
  EXPECT_NEAR(difference(database, other, 0)[0].largest_compliance, 0.02, 1e-6);
  EXPECT_FALSE(difference(database, other, 0)[0].agrees(0.01));
  other.tools[0].compliance = {};
  EXPECT_EQ(difference(database, other, 0)[0].largest_compliance, 1.0);
}

TEST(DatabaseCompliance, SummariesDescribeIt) {
  const ScratchFolder folder;
  write_database(folder / "a.h5", coupled_sphere());
  const ChunkReader reader(folder / "a.h5");
  const std::string line =
      "7 distances from 2 to 100 mm, 3 modes; forces of several contacts within 3 % "
      "of the largest of their set, at 95 % of sets; one equilibrium";
  EXPECT_EQ(describe(summarise(reader.index().tools[0]).compliance), line);
  EXPECT_EQ(describe(summarise(coupled_sphere().tools[0]).compliance), line);
}

TEST(DatabaseCompliance, UnitsCarryTheContactsOfTheirTools) {
  const ResponseDatabase database = coupled_sphere();
  const JobDescription plan{.digest = "x",
                            .body = database.body,
                            .normal = database.normal,
                            .tool = {two_pads()},
                            .provenance = {}};
  const ToolShape tool = plan_from_bytes(to_bytes(plan), "here").tool.at(0);
  EXPECT_EQ(tool.contact.point_m, two_pads().contact.point_m);
  EXPECT_EQ(tool.contact.radius_m, two_pads().contact.radius_m);
}

TEST(DatabaseCompliance, SaysWhatIsWrong) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Violation<ResponseDatabase>> violations{
      {"few knots",
       [](ResponseDatabase& db) {
         db.tools[0].compliance.distance_m = {0.001, 0.002, 0.004};
       },
       "compliance/distance_m has 3 rows, must have 4 to 32"},
      {"uneven",
       [](ResponseDatabase& db) {
         db.tools[0].compliance.distance_m[3] *= 1.01;
       },
       "compliance/distance_m: element 3 is"},
      {"falling",
       [](ResponseDatabase& db) {
         db.tools[0].compliance.distance_m = log_spaced(0.1, 0.002, 7);
       },
       "must be positive and increase"},
      {"rows",
       [](ResponseDatabase& db) {
         db.tools[0].compliance.value.conservativeResize(5, 7);
       },
       "compliance/value is 5 x 7, must be"},
      {"not finite",
       [nan](ResponseDatabase& db) {
         db.tools[0].compliance.value(4, 2) = nan;
       },
       "compliance/value: row 4 has nan, must be finite"},
      {"modes that add",
       [](ResponseDatabase& db) {
         db.tools[0].compliance.added_modes = 4;
       },
       "compliance/mode has 3 columns of which 4 add"},
      {"rows of modes",
       [](ResponseDatabase& db) {
         db.tools[0].compliance.mode.conservativeResize(5, 3);
       },
       "compliance/mode is 5 x 3, must be"},
      {"error",
       [](ResponseDatabase& db) {
         db.tools[0].compliance.error_relative = -1.0;
       },
       "compliance@error_relative is -1"},
      {"radius without a table",
       [](ResponseDatabase& db) {
         db.tools[0].tool.contact.radius_m[1] = 0.004;
       },
       "must have a table of that radius, named \"pads.2\""},
      {"another table",
       [](ResponseDatabase& db) {
         db.tools[0].tool.contact.radius_m[1] = 0.004;
         db.tools.push_back(db.tools[0]);
         db.tools[1].tool = {.name = "pads.2", .radius_m = 0.003};
       },
       "is a sphere of radius 0.003, must be a sphere of radius 0.004"}};
  for (const Violation<ResponseDatabase>& violation : violations) {
    ResponseDatabase database = coupled_sphere();
    violation.make(database);
    try {
      check(database);
      ADD_FAILURE() << violation.name << " was accepted";
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find(violation.message), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace palpate
