// Chunks hold what the whole file holds, wherever the file is cut.
#include "formats/database/chunk_reader.h"

#include <algorithm>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class EveryStorage : public testing::TestWithParam<StorageOptions> {};

TEST_P(EveryStorage, ChunksHoldWhatTheWholeFileHolds) {
  const ScratchFolder folder;
  ResponseDatabase written = sphere_database(12, 9);
  written.storage = GetParam();
  write_database(folder / "a.h5", written);
  const ResponseDatabase whole = read_database(folder / "a.h5");
  const ResponseTable& table = whole.tools[0];
  const ChunkReader reader(folder / "a.h5");
  const DatabaseIndex& index = reader.index();
  EXPECT_EQ(index.nodes(), whole.body.position_m.rows());
  EXPECT_EQ(index.chunks(),
            (index.nodes() + GetParam().chunk_nodes - 1) / GetParam().chunk_nodes);
  std::vector<std::int32_t> row_node;  // source node of each row of the file
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    const BodyChunk body = reader.body(k);
    row_node.insert(row_node.end(), body.source_node.begin(), body.source_node.end());
  }
  std::int64_t triangles = 0;
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    const BodyChunk body = reader.body(k);
    const ResponseTable part = reader.responses(0, k);
    for (std::int64_t i = 0; i < part.nodes(); ++i) {
      const Eigen::Index node = body.source_node[static_cast<std::size_t>(i)];
      EXPECT_EQ(index.chunk_of(body.node_begin + i), k);
      EXPECT_EQ(body.position_m.row(i), whole.body.position_m.row(node));
      EXPECT_TRUE(
          (body.position_m.row(i).array() >= index.box_min_m.row(k).array()).all());
      EXPECT_TRUE(
          (body.position_m.row(i).array() <= index.box_max_m.row(k).array()).all());
      EXPECT_EQ(part.direction.row(i), table.direction.row(node));
      const CurveView a = part.curve(i);
      const CurveView b = table.curve(node);
      EXPECT_TRUE(std::ranges::equal(a.depth_m, b.depth_m));
      EXPECT_TRUE(std::ranges::equal(a.force_n, b.force_n));
      EXPECT_TRUE(std::ranges::equal(a.stiffness_n_per_m, b.stiffness_n_per_m));
      EXPECT_TRUE(std::ranges::equal(a.energy_j, b.energy_j));
    }
    for (Eigen::Index t = 0; t < body.triangle.rows(); ++t, ++triangles) {
      const Eigen::Index source = body.source_triangle[static_cast<std::size_t>(t)];
      EXPECT_EQ(index.chunk_of(body.triangle.row(t).minCoeff()), k);
      for (Eigen::Index j = 0; j < 3; ++j) {
        const std::int32_t node =
            row_node[static_cast<std::size_t>(body.triangle(t, j))];
        EXPECT_EQ(node, whole.body.triangle(source, j));
        const auto corner = whole.body.position_m.row(node).array();
        EXPECT_TRUE((corner >= index.box_min_m.row(k).array()).all());
        EXPECT_TRUE((corner <= index.box_max_m.row(k).array()).all());
      }
    }
  }
  EXPECT_EQ(triangles, whole.body.triangle.rows());
}

INSTANTIATE_TEST_SUITE_P(
    Storage, EveryStorage,
    testing::Values(StorageOptions{}, StorageOptions{Precision::kFloat64, true, 64},
                    StorageOptions{Precision::kFloat32, false, 100},
                    StorageOptions{Precision::kFloat32, true, 1},
                    StorageOptions{Precision::kInt16, false, 17},
                    StorageOptions{Precision::kInt16, true, 1000}),
    [](const auto& storage) {
      return fmt::format("{}{}{}", name_of(storage.param.precision),
                         storage.param.compress ? "deflated" : "plain",
                         storage.param.chunk_nodes);
    });

TEST(DatabaseStorage, WhatWasReadIsWrittenTheSameAgain) {
  const ScratchFolder folder;
  for (const Precision precision :
       {Precision::kFloat64, Precision::kFloat32, Precision::kInt16}) {
    for (const bool compress : {false, true}) {
      ResponseDatabase database = sphere_database(8, 9);
      database.storage = {precision, compress, 50};
      write_database(folder / "a.h5", database);
      write_database(folder / "b.h5", read_database(folder / "a.h5"));
      EXPECT_EQ(bytes_of(folder / "a.h5"), bytes_of(folder / "b.h5"))
          << name_of(precision) << compress;
    }
  }
}

TEST(DatabaseStorage, TheDigestDoesNotDependOnChunksOrCompression) {
  const ScratchFolder folder;
  const auto digest_with = [&](StorageOptions storage) {
    ResponseDatabase database = sphere_database(8, 9);
    database.storage = storage;
    write_database(folder / "a.h5", database);
    return database_sha256(folder / "a.h5");
  };
  const std::string digest = digest_with({});
  EXPECT_EQ(digest_with({Precision::kFloat64, true, 256}), digest);
  EXPECT_EQ(digest_with({Precision::kFloat64, false, 7}), digest);
  const std::string rounded = digest_with({Precision::kInt16, false, 256});
  EXPECT_NE(rounded, digest);
  EXPECT_EQ(digest_with({Precision::kInt16, true, 9}), rounded);
}

TEST(DatabaseStorage, CoarserPrecisionsErrByNoMoreThanTheirStep) {
  const ScratchFolder folder;
  const ResponseDatabase exact = sphere_database(8, 9);
  const ResponseTable& a = exact.tools[0];
  for (const Precision precision : {Precision::kFloat32, Precision::kInt16}) {
    ResponseDatabase database = exact;
    database.storage.precision = precision;
    write_database(folder / "a.h5", database);
    const ResponseDatabase read = read_database(folder / "a.h5");
    const ResponseTable& b = read.tools[0];
    for (std::int64_t i = 0; i < a.nodes(); ++i) {
      const CurveView exact_curve = a.curve(i);
      const CurveView curve = b.curve(i);
      for (std::size_t k = 0; k < curve.depth_m.size(); ++k) {
        // Half a unit in the last place of 24 bits; half a step of 15 bits, whose scale
        // is rounded up by less than 1e-6.
        const double depth_step = precision == Precision::kFloat32
                                      ? exact_curve.depth_m[k] * 0x1p-24
                                      : 0.0050001 / 32767 / 2;
        const double force_step =
            precision == Precision::kFloat32
                ? exact_curve.force_n[k] * 0x1p-24
                : exact_curve.force_n.back() * 1.00001 / 32767 / 2;
        EXPECT_LE(std::abs(curve.depth_m[k] - exact_curve.depth_m[k]), depth_step);
        EXPECT_LE(std::abs(curve.force_n[k] - exact_curve.force_n[k]), force_step);
      }
    }
  }
}

TEST(DatabaseStorage, DepthsThatSixteenBitsCannotTellApartAreRefused) {
  const ScratchFolder folder;
  ResponseDatabase database = small_database();
  NodeResponse response;
  response.direction = database.normal.row(0).transpose();
  response.origin = ResponseOrigin::kSimulated;
  response.depth_m = {0.0, 1e-8, 0.01};
  response.force_n = {0.0, 0.5, 1.0};
  database.tools = {
      make_table(database.tools[0].tool, std::vector<NodeResponse>(6, response))};
  for (Eigen::Index i = 0; i < 6; ++i) {
    database.tools[0].direction.row(i) = database.normal.row(i);
  }
  database.storage.precision = Precision::kInt16;
  EXPECT_THROW(write_database(folder / "a.h5", database), InputError);
  database.storage.precision = Precision::kFloat32;
  EXPECT_NO_THROW(write_database(folder / "a.h5", database));
}

TEST(DatabaseIndex, StatesTheLargestOfEachChunk) {
  const ScratchFolder folder;
  ResponseDatabase database = sphere_database(6, 5);
  database.storage.chunk_nodes = 10;
  write_database(folder / "a.h5", database);
  const ChunkReader reader(folder / "a.h5");
  const ToolIndex& tool = reader.index().tools[0];
  EXPECT_EQ(tool.tool.name, "ball");
  EXPECT_EQ(tool.tool.radius_m, 0.005);
  EXPECT_EQ(tool.origin_count, (std::vector<std::int64_t>{0, 74, 0, 0}));
  for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
    const ResponseTable part = reader.responses(0, k);
    const auto at = static_cast<std::size_t>(k);
    EXPECT_EQ(tool.force_max_n[at],
              *std::max_element(part.force_n.begin(), part.force_n.end()));
    EXPECT_EQ(tool.depth_max_m[at], part.depth_max_m());
    EXPECT_EQ(tool.stiffness_max_n_per_m[at],
              *std::max_element(part.stiffness_max_n_per_m.begin(),
                                part.stiffness_max_n_per_m.end()));
  }
}

TEST(ChunkReader, OneThreadReadsChunksWhileAnotherReadsAndWritesFiles) {
  const ScratchFolder folder;
  ResponseDatabase database = sphere_database(8, 9);
  database.storage.chunk_nodes = 16;
  write_database(folder / "a.h5", database);
  const ChunkReader reader(folder / "a.h5");
  std::int64_t nodes = 0;
  std::thread other([&] {
    for (int round = 0; round < 5; ++round) {
      for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
        nodes += reader.responses(0, k).nodes();
      }
    }
  });
  for (int round = 0; round < 5; ++round) {
    write_database(folder / "b.h5", read_database(folder / "a.h5"));
  }
  other.join();
  EXPECT_EQ(nodes, 5 * reader.index().nodes());
  EXPECT_EQ(bytes_of(folder / "a.h5"), bytes_of(folder / "b.h5"));
}

TEST(ChunkReader, OneDamagedChunkIsNamedAndTheOthersAreRead) {
  const ScratchFolder folder;
  ResponseDatabase database = sphere_database(12, 9);
  database.storage.chunk_nodes = 32;
  write_database(folder / "a.h5", database);
  // The last force of the file's last node.
  std::string bytes = bytes_of(folder / "a.h5");
  const ChunkReader intact(folder / "a.h5");
  const std::int64_t last = intact.index().chunks() - 1;
  const ResponseTable part = intact.responses(0, last);
  const std::string run(
      reinterpret_cast<const char*>(part.force_n.data() + part.force_n.size() - 9),
      9 * sizeof(double));
  const std::size_t at = bytes.rfind(run);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 40] ^= 1;
  std::ofstream(folder / "b.h5", std::ios::binary) << bytes;
  const ChunkReader damaged(folder / "b.h5");
  EXPECT_NO_THROW((void)damaged.responses(0, last - 1));
  EXPECT_NO_THROW((void)damaged.body(last));
  try {
    (void)damaged.responses(0, last);
    FAIL() << "read a damaged chunk";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what())
                  .find(fmt::format("/tools/ball: chunk {} is damaged", last)),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace palpate
