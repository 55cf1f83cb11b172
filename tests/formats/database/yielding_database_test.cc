// How responses yield, through a database file: written, read whole and by chunks,
// sliced, compared, described, refused.
#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_diff.h"
#include "formats/database/database_slice.h"
#include "formats/database/database_summary.h"
#include "formats/database/table_memory.h"
#include "tests/formats/database/violation.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

void expect_equal_yielding(const Yielding& a, const Yielding& b) {
  EXPECT_EQ(a.yield_depth_m, b.yield_depth_m);
  EXPECT_EQ(a.share, b.share);
  EXPECT_EQ(a.onset_m, b.onset_m);
  EXPECT_EQ(a.scale_m, b.scale_m);
  EXPECT_EQ(a.largest, b.largest);
}

// A sphere in many chunks that yields differently everywhere, with sites; else alike.
ResponseDatabase yielding_sphere(bool by_node) {
  ResponseDatabase database = sphere_database(24, 6);
  const auto n = static_cast<std::size_t>(database.body.position_m.rows());
  Viscoelasticity yields;
  yields.yielding = {.yield_depth_m = {0.001},
                     .share = {0.4},
                     .onset_m = {0.002},
                     .scale_m = {0.003},
                     .largest = {0.5}};
  for (std::size_t i = 0; by_node && i < n; ++i) {
    yields.yielding.share.resize(n);
    yields.yielding.share[i] = 0.9 * static_cast<double>(i) / static_cast<double>(n);
  }
  give_memory(database.body, database.normal, yields, 1, database.tools[0]);
  database.storage.chunk_nodes = 100;
  return database;
}

TEST(DatabaseYielding, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  for (const bool by_node : {false, true}) {
    const ResponseDatabase written = yielding_sphere(by_node);
    write_database(folder / "a.h5", written);
    const Viscoelasticity read =
        read_database(folder / "a.h5").tools[0].viscoelasticity;
    EXPECT_TRUE(read.empty());
    EXPECT_TRUE(read.remembers());
    expect_equal_yielding(read.yielding, written.tools[0].viscoelasticity.yielding);
    EXPECT_EQ(read.sites.site, written.tools[0].viscoelasticity.sites.site);
    EXPECT_GT(read.sites.node.size(), 20U);
  }
}

TEST(DatabaseYielding, ChunksHaveTheRowsOfTheWhole) {
  const ScratchFolder folder;
  for (const bool by_node : {false, true}) {
    write_database(folder / "a.h5", yielding_sphere(by_node));
    const ResponseDatabase whole = read_in_file_order(folder / "a.h5");
    const Viscoelasticity& all = whole.tools[0].viscoelasticity;
    const ChunkReader reader(folder / "a.h5");
    EXPECT_EQ(reader.index().tools[0].yielding_rows, by_node);
    ASSERT_GT(reader.index().chunks(), 5);
    for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
      const Viscoelasticity part = reader.responses(0, k).viscoelasticity;
      const Viscoelasticity same =
          rows_of(all, reader.index().node_begin[static_cast<std::size_t>(k)],
                  reader.index().node_begin[static_cast<std::size_t>(k) + 1]);
      expect_equal_yielding(part.yielding, same.yielding);
      EXPECT_EQ(part.sites.site, same.sites.site);
    }
    EXPECT_EQ(summarise(reader.index().tools[0]).yielding,
              by_node ? "differs from node to node"
                      : "dents stay past 1 mm, 40 % of it; softens past 2 mm by up to "
                        "50 %, over 3 mm");
  }
}

TEST(DatabaseYielding, ASliceKeepsTheRowsOfItsNodes) {
  const ResponseDatabase whole = yielding_sphere(true);
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
    EXPECT_EQ(
        part.tools[0].viscoelasticity.yielding.share[static_cast<std::size_t>(i)],
        whole.tools[0].viscoelasticity.yielding.share[static_cast<std::size_t>(same)]);
  }
}

TEST(DatabaseYielding, DatabasesThatYieldDifferentlyDiffer) {
  const ResponseDatabase database = yielding_sphere(false);
  ResponseDatabase other = database;
  EXPECT_TRUE(difference(database, other, 0)[0].agrees(0.0));
  other.tools[0].viscoelasticity.yielding.largest = {0.6};
  EXPECT_FALSE(difference(database, other, 0)[0].agrees(1.0));
}

TEST(DatabaseYielding, ASummaryDoubtsItsSitesToo) {
  ResponseDatabase database = yielding_sphere(false);
  EXPECT_EQ(doubts_of_memory(summarise(database.tools[0])), "");
  database.tools[0].viscoelasticity.sites.spacing_m *= 0.3;
  EXPECT_NE(doubts_of_memory(summarise(database.tools[0])), "");
}

class BrokenYielding : public testing::TestWithParam<Violation<Yielding>> {};

TEST_P(BrokenYielding, IsRefusedByName) {
  ResponseDatabase database = small_database();
  Yielding& yielding = database.tools[1].viscoelasticity.yielding;
  yielding = {.yield_depth_m = {0.001},
              .share = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6},
              .onset_m = {0.002},
              .scale_m = {0.003},
              .largest = {0.5}};
  const ScratchFolder folder;
  write_database(folder / "a.h5", database);
  GetParam().make(yielding);
  try {
    write_database(folder / "a.h5", database);
    FAIL() << "written";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
        << error.what();
  }
}

const std::vector<Violation<Yielding>> kYieldingViolations{
    {"ShareOfOne",
     [](Yielding& y) {
       y.share[3] = 1.0;
     },
     "/tools/ball/plastic/share: row 3 has 1, must lie in [0, 1)"},
    {"NegativeShare",
     [](Yielding& y) {
       y.share[0] = -0.1;
     },
     "/tools/ball/plastic/share: row 0 has -0.1, must lie in [0, 1)"},
    {"NegativeYieldDepth",
     [](Yielding& y) {
       y.yield_depth_m[0] = -1e-3;
     },
     "/tools/ball/plastic/yield_depth_m: row 0 has -0.001, must be at least 0"},
    {"OnsetNotANumber",
     [](Yielding& y) {
       y.onset_m[0] = std::nan("");
     },
     "/tools/ball/damage/onset_m: row 0 has nan, must be at least 0"},
    {"ScaleOfZero",
     [](Yielding& y) {
       y.scale_m[0] = 0.0;
     },
     "/tools/ball/damage/scale_m: row 0 has 0, must be positive"},
    {"LargestOfTwo",
     [](Yielding& y) {
       y.largest[0] = 2.0;
     },
     "/tools/ball/damage/largest: row 0 has 2, must lie in [0, 1)"},
    {"RowsOfOtherNodes",
     [](Yielding& y) {
       y.share.pop_back();
     },
     "/tools/ball/plastic/share has 5 rows, must have 1 or 6"},
    {"ShareWithoutDepth",
     [](Yielding& y) {
       y.yield_depth_m.clear();
     },
     "/tools/ball/plastic has 1 of its 2 datasets, must have all"},
    {"LargestWithoutScale",
     [](Yielding& y) {
       y.scale_m.clear();
     },
     "/tools/ball/damage has 2 of its 3 datasets, must have all"},
};
INSTANTIATE_TEST_SUITE_P(Yielding, BrokenYielding,
                         testing::ValuesIn(kYieldingViolations),
                         [](const auto& violation) {
                           return violation.param.name;
                         });

}  // namespace
}  // namespace palpate
