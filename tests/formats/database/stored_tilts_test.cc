// Tilts of forces in a file: kept, read in whole and by chunk, refused where wrong.
#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_rules.h"
#include "formats/database/database_slice.h"
#include "formats/database/response_database.h"
#include "formats/database/work_unit.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// The first tool with tilts, each tangent to its normal.
ResponseDatabase tilted() {
  ResponseDatabase database = small_database();
  ResponseTable& table = database.tools.front();
  table.tilt = Points::Zero(6, 3);
  table.tilt_by_depth_per_m = Points::Zero(6, 3);
  for (Eigen::Index i = 0; i < 5; ++i) {
    const Eigen::Vector3d n = database.normal.row(i).transpose();
    const Eigen::Vector3d aside = n.unitOrthogonal();
    table.tilt.row(i) = 0.05 * static_cast<double>(i) * aside.transpose();
    table.tilt_by_depth_per_m.row(i) = 3.0 * n.cross(aside).transpose();
  }
  return database;
}

class StoredTilts : public testing::Test {
 protected:
  void expect_refused(const std::function<void(ResponseTable&)>& change,
                      const std::string& said) const {
    ResponseDatabase database = tilted();
    change(database.tools.front());
    try {
      check(database);
      FAIL() << "accepted, not " << said;
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos)
          << error.what();
    }
  }
  ScratchFolder folder_;
};

TEST_F(StoredTilts, AreReadAsTheyWereWritten) {
  const ResponseDatabase written = tilted();
  write_database(folder_ / "a.h5", written);
  const ResponseDatabase read = read_database(folder_ / "a.h5");
  EXPECT_EQ(read.tools[0].tilt, written.tools[0].tilt);
  EXPECT_EQ(read.tools[0].tilt_by_depth_per_m, written.tools[0].tilt_by_depth_per_m);
  EXPECT_EQ(read.tools[1].tilt.rows(), 0);
}

TEST_F(StoredTilts, ComeWithTheChunksThatARendererReads) {
  ResponseDatabase database = tilted();
  database.storage.chunk_nodes = 2;
  write_database(folder_ / "a.h5", database);
  const ResponseDatabase whole = read_in_file_order(folder_ / "a.h5");
  const ChunkReader reader(folder_ / "a.h5");
  for (std::int64_t k = 0; k < 3; ++k) {
    const ResponseTable part = reader.responses(0, k);
    EXPECT_EQ(part.tilt, whole.tools[0].tilt.middleRows(2 * k, 2)) << k;
    EXPECT_EQ(part.tilt_by_depth_per_m,
              whole.tools[0].tilt_by_depth_per_m.middleRows(2 * k, 2))
        << k;
    EXPECT_EQ(reader.responses(1, k).tilt.rows(), 0);
  }
}

TEST_F(StoredTilts, AreHeldToTheRules) {
  expect_refused(
      [](ResponseTable& table) {
        table.tilt(2, 0) = std::numeric_limits<double>::quiet_NaN();
      },
      "/tools/tip/tilt: node 2");
  expect_refused(
      [](ResponseTable& table) {
        table.tilt.row(1) = table.direction.row(1) * 1e-6;
      },
      "tangent to the normal");
  expect_refused(
      [](ResponseTable& table) {
        table.tilt_by_depth_per_m.row(1) += table.direction.row(1) * 1e-3;
      },
      "tangent to the normal");
  expect_refused(
      [](ResponseTable& table) {
        table.tilt.row(3) *= 7.0;  // 1.05
      },
      "must be at most 1");
  expect_refused(
      [](ResponseTable& table) {
        table.tilt_by_depth_per_m.row(3) *= 2.4;  // 0.509 over an edge
      },
      "0.5 over an edge of 0.0707");
  expect_refused(
      [](ResponseTable& table) {
        table.tilt(5, 0) = 0.1;
      },
      "must be 0 without response");
  expect_refused(
      [](ResponseTable& table) {
        table.tilt_by_depth_per_m.resize(5, 3);
      },
      "tilt has 6 rows and tilt_by_depth_per_m 5, must have 6");
}

// What check() refuses before writing, a renderer refuses where a file has it.
TEST_F(StoredTilts, OfAFileThatIsWrongAreRefusedByChunk) {
  ResponseDatabase database = tilted();
  database.tools[0].tilt.row(1) += 0.01 * database.normal.row(1);
  write_unchecked(folder_ / "a.h5", database);
  const ChunkReader reader(folder_ / "a.h5");
  const BodyChunk body = reader.body(0);
  const ResponseTable part = reader.responses(0, 0);
  EXPECT_THROW(check_normals(body.normal, part, 0), FormatError);
}

TEST_F(StoredTilts, OfASliceAreThoseOfItsNodesAtEveryDepth) {
  const ResponseDatabase database = tilted();
  const ResponseTable shallow = cut(database.tools[0], 0.002);
  EXPECT_EQ(shallow.tilt, database.tools[0].tilt);
  const ResponseTable some =
      select_nodes(database.tools[0], std::vector<std::int32_t>{4, 1});
  EXPECT_EQ(some.tilt.row(1), database.tools[0].tilt.row(1));
  EXPECT_EQ(some.tilt_by_depth_per_m.row(0),
            database.tools[0].tilt_by_depth_per_m.row(4));
}

TEST_F(StoredTilts, OfAUnitComeThroughItsBytes) {
  WorkUnitNode node{.vertex = 3};
  node.response.tilt = TiltLine{.tilt = {0.1, 0.2, 0.3}, .by_depth_per_m = {4, 5, 6}};
  const WorkUnitOutcome unit{.index = 0, .node = {node, WorkUnitNode{}}};
  const WorkUnitOutcome back = unit_from_bytes(to_bytes(unit), "a unit");
  ASSERT_TRUE(back.node[0].response.tilt);
  EXPECT_EQ(back.node[0].response.tilt->tilt, node.response.tilt->tilt);
  EXPECT_EQ(back.node[0].response.tilt->by_depth_per_m,
            node.response.tilt->by_depth_per_m);
  EXPECT_FALSE(back.node[1].response.tilt);
}

}  // namespace
}  // namespace palpate
