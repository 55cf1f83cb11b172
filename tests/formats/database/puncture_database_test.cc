// What a needle breaks, through a database file: written, read whole and by chunks,
// sliced, merged, compared, refused.
#include <array>
#include <bit>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_diff.h"
#include "formats/database/database_slice.h"
#include "formats/hdf5/hdf5_reader.h"
#include "tests/formats/database/violation.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::string digest_in(const std::filesystem::path& file) {
  const Hdf5Lock lock;
  return Hdf5Reader(file).remark("/", kDigestName);
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
    const Hdf5Lock lock;
    const Hdf5Reader reader(folder / "a.h5");
    EXPECT_NO_THROW((void)reader.shape_of(path, units, Hdf5Type::kFloat64, {-1}));
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
    const Hdf5Lock lock;
    Hdf5Reader reader(folder / "a.h5");
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
  const Hdf5Lock lock;
  const Hdf5Reader reader(folder / "never.h5");
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

class BrokenPuncture : public testing::TestWithParam<Violation<Puncture>> {};

TEST_P(BrokenPuncture, IsRefusedByName) {
  ResponseDatabase database = small_database();
  Puncture& puncture = database.tools[1].puncture;
  puncture = some_puncture(6);
  const ScratchFolder folder;
  write_database(folder / "a.h5", database);
  GetParam().make(puncture);
  try {
    write_database(folder / "a.h5", database);
    FAIL() << "written";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
        << error.what();
  }
}

const std::vector<Violation<Puncture>> kHeadViolations{
    {"RuleUnknown",
     [](Puncture& p) {
       p.rule = "strain";
     },
     "/tools/ball/puncture@rule is \"strain\", must be \"force\" or \"energy\""},
    {"NoMaterials",
     [](Puncture& p) {
       p.material.clear();
     },
     "/tools/ball/puncture/material has 0 lines, must have 1 to 8"},
    {"NineMaterials",
     [](Puncture& p) {
       p.material = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
     },
     "/tools/ball/puncture/material has 9 lines, must have 1 to 8"},
    {"MaterialTwice",
     [](Puncture& p) {
       p.material[2] = "skin";
     },
     "/tools/ball/puncture/material: line 2 is \"skin\" as line 0 is, must be unique"},
    {"MaterialOfTwoLines",
     [](Puncture& p) {
       p.material[1] = "a\nb";
     },
     "/tools/ball/puncture/material: line 1 is \"a\\nb\", must be one line"},
    {"MembranesOfOthers",
     [](Puncture& p) {
       p.membrane_n.pop_back();
     },
     "/tools/ball/puncture/membrane_n has 2 rows, must have one per material: 3"},
    {"MembraneNotANumber",
     [](Puncture& p) {
       p.membrane_n[1] = kNaN;
     },
     "/tools/ball/puncture/membrane_n: row 1 has nan, must be at least 0"},
    {"CuttingNegative",
     [](Puncture& p) {
       p.cutting_n[0] = -0.5;
     },
     "/tools/ball/puncture/cutting_n: row 0 has -0.5, must be at least 0"},
    {"FrictionInfinite",
     [](Puncture& p) {
       p.friction_n_per_m[2] = std::numeric_limits<double>::infinity();
     },
     "/tools/ball/puncture/friction_n_per_m: row 2 has inf, must be at least 0 and "
     "finite"},
    {"ToughnessNegative",
     [](Puncture& p) {
       p.toughness_j_per_m2[0] = -1.0;
     },
     "/tools/ball/puncture/toughness_j_per_m2: row 0 has -1, must be at least 0 or not "
     "a number"},
    {"EdgeNegative",
     [](Puncture& p) {
       p.edge_width_m = -1e-3;
     },
     "/tools/ball/puncture@edge_width_m is -0.001, must be at least 0 and finite"},
    {"StaticBelowKinetic",
     [](Puncture& p) {
       p.static_ratio[1] = 0.9;
     },
     "/tools/ball/puncture/static_ratio: row 1 has 0.9, must be at least 1 and finite"},
    {"ShaftOfZero",
     [](Puncture& p) {
       p.shaft_n_per_m = 0.0;
     },
     "/tools/ball/puncture@shaft_n_per_m is 0, must be positive and finite"},
    {"LateralNotANumber",
     [](Puncture& p) {
       p.lateral_n_per_m2 = kNaN;
     },
     "/tools/ball/puncture@lateral_n_per_m2 is nan, must be at least 0 and finite"},
    {"MouthNegative",
     [](Puncture& p) {
       p.mouth_m = -1.0;
     },
     "/tools/ball/puncture@mouth_m is -1, must be positive and finite"},
    {"RadiusNegative",
     [](Puncture& p) {
       p.radius_m = -1e-3;
     },
     "/tools/ball/puncture@radius_m is -0.001, must be at least 0 and finite"},
    {"TipOfAHalfPlane",
     [](Puncture& p) {
       p.tip_angle_rad = 3.2;
     },
     "/tools/ball/puncture@tip_angle_rad is 3.2, must be in [0, pi)"},
    {"InsertableNotANumber",
     [](Puncture& p) {
       p.insertable_m = kNaN;
     },
     "/tools/ball/puncture@insertable_m is nan, must be at least 0 and finite"},
    {"MembraneEnergiesOfOthers",
     [](Puncture& p) {
       p.membrane_j = {1.0};
     },
     "/tools/ball/puncture/membrane_j has 1 rows, must have one per material: 3"},
    {"MembraneEnergyInfinite",
     [](Puncture& p) {
       p.membrane_j = {kNaN, std::numeric_limits<double>::infinity(), kNaN};
     },
     "/tools/ball/puncture/membrane_j: row 1 has inf, must be at least 0 and finite or "
     "not a number"},
};
INSTANTIATE_TEST_SUITE_P(OfTheTool, BrokenPuncture, testing::ValuesIn(kHeadViolations),
                         [](const auto& violation) {
                           return violation.param.name;
                         });

const std::vector<Violation<Puncture>> kNodeViolations{
    {"RupturesOfOthers",
     [](Puncture& p) {
       p.rupture.pop_back();
     },
     "/tools/ball/puncture/rupture has 5 rows, must have 1 or 6"},
    {"RuptureNegative",
     [](Puncture& p) {
       p.rupture[3] = -2.0;
     },
     "/tools/ball/puncture/rupture: row 3 has -2, must be at least 0"},
    {"LayersOfOthers",
     [](Puncture& p) {
       p.layer_depth_m.conservativeResize(4, 3);
     },
     "/tools/ball/puncture/layer_depth_m has 4 rows, must have 1 or 6"},
    {"SevenLayers",
     [](Puncture& p) {
       p.layer_depth_m.setConstant(6, 7, kNaN);
       p.layer_material.setConstant(6, 7, -1);
     },
     "/tools/ball/puncture/layer_depth_m has 7 columns, must have 1 to 6"},
    {"MaterialsOfOtherLayers",
     [](Puncture& p) {
       p.layer_material.conservativeResize(6, 2);
     },
     "/tools/ball/puncture/layer_material is 6 x 2, must be as layer_depth_m: 6 x 3"},
    {"FirstBelowTheSurface",
     [](Puncture& p) {
       p.layer_depth_m(2, 0) = 1e-3;
     },
     "/tools/ball/puncture/layer_depth_m: row 2 begins with 0.001, must begin with 0"},
    {"NoFirst",
     [](Puncture& p) {
       p.layer_depth_m(2, 0) = kNaN;
     },
     "/tools/ball/puncture/layer_depth_m: row 2 begins with nan, must begin with 0"},
    {"NotDeeper",
     [](Puncture& p) {
       p.layer_depth_m(4, 2) = 0.002;
     },
     "/tools/ball/puncture/layer_depth_m: row 4 has 0.002 after"},
    {"LayerBehindTheLast",
     [](Puncture& p) {
       p.layer_depth_m(4, 1) = kNaN;
     },
     "/tools/ball/puncture: row 4 has a layer at nan of material 1 behind its last, "
     "must have none"},
    {"MaterialBehindTheLast",
     [](Puncture& p) {
       p.layer_material(1, 2) = 0;
     },
     "/tools/ball/puncture: row 1 has a layer at nan of material 0 behind its last"},
    {"MaterialUnknown",
     [](Puncture& p) {
       p.layer_material(0, 1) = 3;
     },
     "/tools/ball/puncture/layer_material: row 0 has 3 at 0.002 m, must lie in [0, 2]"},
};
INSTANTIATE_TEST_SUITE_P(OfTheNodes, BrokenPuncture, testing::ValuesIn(kNodeViolations),
                         [](const auto& violation) {
                           return violation.param.name;
                         });

TEST(DatabasePuncture, WhatNothingBreaksIsInfinite) {
  ResponseDatabase database = small_database();
  database.tools[0].puncture = some_puncture(6);
  database.tools[0].puncture.rupture = {std::numeric_limits<double>::infinity()};
  EXPECT_NO_THROW(check(database));
}

}  // namespace
}  // namespace palpate
