// What a needle breaks, through a database file: written, read whole and by chunks,
// sliced, merged, compared.
#include <array>
#include <bit>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_diff.h"
#include "formats/database/database_slice.h"
#include "formats/stored/stored_reader.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::string digest_in(const std::filesystem::path& file) {
  return database_sha256(file);
}

TEST(DatabasePuncture, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  for (const bool by_node : {false, true}) {
    for (const char* rule : {"force", "energy"}) {
      ResponseDatabase written = punctured_sphere(by_node);
      if (!by_node) {
        written.tools[0].puncture = known_puncture(1);
      }
      written.tools[0].puncture.rule = rule;
      write_database(folder / "a.h5", written);
      const ResponseDatabase read = read_database(folder / "a.h5");
      EXPECT_TRUE(same(read.tools[0].puncture, written.tools[0].puncture));
      const ResponseDatabase ordered = read_in_file_order(folder / "a.h5");
      const DatabaseIndex index = read_index(folder / "a.h5");
      EXPECT_TRUE(same(index.tools[0].puncture, ordered.tools[0].puncture));
    }
  }
}

TEST(DatabasePuncture, ForcesAreInNewtonsAndEnergiesInJoules) {
  const ScratchFolder folder;
  ResponseDatabase database = punctured_sphere(true);
  const std::string path =
      "/tools/" + database.tools[0].tool.name + "/puncture/rupture";
  for (const auto& [rule, units] :
       {std::pair{"force", "N"}, std::pair{"energy", "J"}}) {
    database.tools[0].puncture.rule = rule;
    write_database(folder / "a.h5", database);
    const StoredReader reader(open_stored(folder / "a.h5"));
    EXPECT_NO_THROW((void)reader.shape_of(path, units, StoredType::kFloat64, {-1}));
  }
}

TEST(DatabasePuncture, ChunksHaveTheRowsOfTheWhole) {
  const ScratchFolder folder;
  for (const bool by_node : {false, true}) {
    write_database(folder / "a.h5", punctured_sphere(by_node));
    const ResponseDatabase whole = read_in_file_order(folder / "a.h5");
    const ChunkReader reader(folder / "a.h5");
    const DatabaseIndex& index = reader.index();
    ASSERT_GT(index.chunks(), 5);
    const Puncture part = reader.responses(0, 2).puncture;
    ASSERT_EQ(std::ssize(part.rupture), by_node ? 100 : 1);
    const auto row = static_cast<std::size_t>(by_node ? index.node_begin[2] + 7 : 0);
    const Puncture& all = whole.tools[0].puncture;
    EXPECT_EQ(part.rupture[by_node ? 7 : 0], all.rupture[row]);
    EXPECT_EQ(part.layer_depth_m(by_node ? 7 : 0, 1),
              all.layer_depth_m(static_cast<Eigen::Index>(row), 1));
    EXPECT_EQ(part.material, all.material);
  }
}

class DamagedPuncture : public testing::TestWithParam<double* (*)(Puncture&)> {};

TEST_P(DamagedPuncture, IsNoticedByWhoReadsTheIndexAlone) {
  const ScratchFolder folder;
  ResponseDatabase database = punctured_sphere(true);
  database.tools[0].puncture = known_puncture(database.body.position_m.rows());
  *GetParam()(database.tools[0].puncture) = 2.718281828;
  write_database(folder / "a.h5", database);
  std::ifstream in(folder / "a.h5", std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const auto number = std::bit_cast<std::array<char, 8>>(2.718281828);
  const std::size_t at = bytes.find(std::string(number.begin(), number.end()));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  std::ofstream(folder / "a.h5", std::ios::binary) << bytes;
  try {
    (void)read_index(folder / "a.h5");
    FAIL() << "read";
  } catch (const FormatError& error) {
    // Of attributes, HDF5 itself keeps a checksum.
    EXPECT_NE(std::string(error.what()).find("/puncture"), std::string::npos)
        << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Of, DamagedPuncture,
                         testing::Values(
                             [](Puncture& p) {
                               return &p.rupture[40];
                             },
                             [](Puncture& p) {
                               return &p.radius_m;
                             },
                             [](Puncture& p) {
                               return &p.tip_angle_rad;
                             },
                             [](Puncture& p) {
                               return &p.insertable_m;
                             },
                             [](Puncture& p) {
                               return &p.membrane_j[1];
                             }));

// What older files lack.
TEST(DatabasePuncture, WhatIsNotKnownIsNotInTheFile) {
  const ScratchFolder folder;
  ResponseDatabase database = punctured_sphere(false);
  const std::string group = "/tools/" + database.tools[0].tool.name + "/puncture";
  const auto has = [&](const char* name) {
    write_database(folder / "a.h5", database);
    EXPECT_TRUE(same(read_database(folder / "a.h5").tools[0].puncture,
                     database.tools[0].puncture));
    StoredReader reader(open_stored(folder / "a.h5"));
    return reader.optional_attribute(group, name, false);
  };
  EXPECT_FALSE(has("radius_m") || has("tip_angle_rad") || has("insertable_m"));
  database.tools[0].puncture = known_puncture(1);
  EXPECT_TRUE(has("radius_m") && has("tip_angle_rad") && has("insertable_m"));
}

TEST(DatabasePuncture, FilesWithoutItSayNothingOfItAndTheirDigestsStay) {
  const ScratchFolder folder;
  ResponseDatabase database = punctured_sphere(true);
  const std::string tool = "/tools/" + database.tools[0].tool.name;
  write_database(folder / "with.h5", database);
  database.tools[0].puncture = {};
  write_database(folder / "cleared.h5", database);
  ResponseDatabase never = sphere_database(24, 6);
  never.storage.chunk_nodes = database.storage.chunk_nodes;
  write_database(folder / "never.h5", never);
  EXPECT_EQ(digest_in(folder / "cleared.h5"), digest_in(folder / "never.h5"));
  EXPECT_NE(digest_in(folder / "with.h5"), digest_in(folder / "never.h5"));
  EXPECT_TRUE(read_database(folder / "never.h5").tools[0].puncture.empty());
  EXPECT_TRUE(read_index(folder / "never.h5").tools[0].puncture.empty());
  const StoredReader reader(open_stored(folder / "never.h5"));
  EXPECT_FALSE(reader.has(tool + "/puncture"));
  EXPECT_FALSE(reader.has(tool + "/index/puncture_sha256"));
}

TEST(DatabasePuncture, ASliceKeepsTheRowsOfItsNodes) {
  const ResponseDatabase whole = punctured_sphere(true);
  SliceOptions options;
  options.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1.0, -1.0, 0.0),
                                      Eigen::Vector3d(1.0, 1.0, 1.0));
  const ResponseDatabase part = slice(whole, options);
  ASSERT_LT(part.body.position_m.rows(), whole.body.position_m.rows());
  const Puncture& all = whole.tools[0].puncture;
  const Puncture& kept = part.tools[0].puncture;
  for (Eigen::Index i = 0; i < part.body.position_m.rows(); ++i) {
    Eigen::Index at = 0;
    (whole.body.position_m.rowwise() - part.body.position_m.row(i))
        .rowwise()
        .squaredNorm()
        .minCoeff(&at);
    EXPECT_EQ(kept.rupture[static_cast<std::size_t>(i)],
              all.rupture[static_cast<std::size_t>(at)]);
    EXPECT_EQ(kept.layer_depth_m(i, 1), all.layer_depth_m(at, 1));
    EXPECT_EQ(kept.layer_material(i, 2), all.layer_material(at, 2));
  }
  EXPECT_EQ(kept.material, all.material);
  const ScratchFolder folder;
  write_database(folder / "a.h5", part);
  EXPECT_TRUE(same(read_database(folder / "a.h5").tools[0].puncture, kept));
}

TEST(DatabasePuncture, MergedToolsKeepTheirOwn) {
  const ResponseDatabase needle = punctured_sphere(true);
  ResponseDatabase ball = sphere_database(24, 6);
  ball.tools[0].tool.name = "another";
  const ResponseDatabase both = merge({ball, needle});
  ASSERT_EQ(both.tools.size(), 2U);
  EXPECT_TRUE(both.tools[0].puncture.empty());
  EXPECT_TRUE(same(both.tools[1].puncture, needle.tools[0].puncture));
}

TEST(DatabasePuncture, DatabasesThatPunctureDifferentlyDiffer) {
  const ResponseDatabase database = punctured_sphere(true);
  ResponseDatabase other = database;
  EXPECT_TRUE(difference(database, other, 0)[0].agrees(0.0));
  other.tools[0].puncture.layer_depth_m(5, 1) += 1e-9;
  EXPECT_FALSE(difference(database, other, 0)[0].agrees(1.0));
  other.tools[0].puncture = {};
  EXPECT_FALSE(difference(database, other, 0)[0].agrees(1.0));
}

}  // namespace
}  // namespace palpate
