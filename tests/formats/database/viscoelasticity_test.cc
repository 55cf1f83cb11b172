// How responses relax, through a database file: written, read whole and by chunks,
// sliced, compared, described, refused.
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_diff.h"
#include "formats/database/database_slice.h"
#include "formats/database/database_summary.h"
#include "formats/response/memory_sites.h"
#include "tests/formats/database/violation.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

void expect_equal_relaxation(const Viscoelasticity& a, const Viscoelasticity& b) {
  EXPECT_EQ(a.rule, b.rule);
  EXPECT_EQ(a.probes, b.probes);
  EXPECT_EQ(a.instantaneous, b.instantaneous);
  EXPECT_EQ(a.speed_m_per_s, b.speed_m_per_s);
  EXPECT_EQ(a.tau_s, b.tau_s);
  EXPECT_EQ(a.g, b.g);
  EXPECT_EQ(a.error_relative, b.error_relative);
  EXPECT_EQ(a.bundle_depth_m, b.bundle_depth_m);
  EXPECT_EQ(a.sites.spacing_m, b.sites.spacing_m);
  EXPECT_EQ(a.sites.node, b.sites.node);
  EXPECT_EQ(a.sites.site, b.sites.site);
  EXPECT_EQ(a.sites.weight, b.sites.weight);
}

ResponseDatabase relaxing_octahedron() {
  ResponseDatabase database = small_database();
  database.tools[1].viscoelasticity = viscous();
  return database;
}

TEST(DatabaseViscoelasticity, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  const ResponseDatabase written = relaxing_octahedron();
  write_database(folder / "a.h5", written);
  const ResponseDatabase read = read_database(folder / "a.h5");
  EXPECT_TRUE(read.tools[0].viscoelasticity.empty());
  expect_equal_relaxation(read.tools[1].viscoelasticity,
                          written.tools[1].viscoelasticity);
}

TEST(DatabaseViscoelasticity, OneRowOfSharesIsForAllNodesAndSitesAreOptional) {
  const ScratchFolder folder;
  ResponseDatabase written = relaxing_octahedron();
  Viscoelasticity& relaxation = written.tools[1].viscoelasticity;
  relaxation = viscous();
  relaxation.g = relaxation.g.topRows(1).eval();
  relaxation.error_relative = {0.1F};
  relaxation.bundle_depth_m.clear();
  relaxation.sites = {};
  relaxation.instantaneous = true;
  relaxation.speed_m_per_s = 0.0;
  relaxation.probes = 0;
  write_database(folder / "a.h5", written);
  expect_equal_relaxation(read_database(folder / "a.h5").tools[1].viscoelasticity,
                          relaxation);
  const ChunkReader reader(folder / "a.h5");
  EXPECT_EQ(reader.index().tools[1].memory_sha256.size(), 0);
  EXPECT_EQ(reader.responses(1, 0).viscoelasticity.g, relaxation.g);
}

// A sphere in many chunks, with sites, and shares that differ everywhere.
ResponseDatabase relaxing_sphere() {
  ResponseDatabase database = sphere_database(24, 6);
  const auto n = static_cast<std::int64_t>(database.body.position_m.rows());
  Viscoelasticity& relaxation = database.tools[0].viscoelasticity;
  relaxation.tau_s = {0.1, 1.0, 10.0};
  relaxation.instantaneous = true;
  relaxation.g.resize(n, 3);
  for (std::int64_t i = 0; i < n; ++i) {
    relaxation.g.row(i) << 0.3F * static_cast<float>(i) / static_cast<float>(n), 0.2F,
        0.1F;
  }
  relaxation.sites =
      place_sites(database.body, database.normal,
                  std::vector<bool>(static_cast<std::size_t>(n), true), 0.02);
  database.storage.chunk_nodes = 100;
  return database;
}

TEST(DatabaseViscoelasticity, ChunksHaveTheRowsOfTheWhole) {
  const ScratchFolder folder;
  write_database(folder / "a.h5", relaxing_sphere());
  const ResponseDatabase whole = read_in_file_order(folder / "a.h5");
  const Viscoelasticity& all = whole.tools[0].viscoelasticity;
  const ChunkReader reader(folder / "a.h5");
  const ToolIndex& tool = reader.index().tools[0];
  EXPECT_EQ(tool.memory_sites, std::ssize(all.sites.node));
  EXPECT_GT(tool.memory_sites, 20);
  EXPECT_EQ(share_extent(tool).low, share_extent(all).low);
  EXPECT_EQ(share_extent(tool).high, share_extent(all).high);
  ASSERT_GT(reader.index().chunks(), 5);
  for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
    const Viscoelasticity part = reader.responses(0, k).viscoelasticity;
    const Viscoelasticity same =
        rows_of(all, reader.index().node_begin[static_cast<std::size_t>(k)],
                reader.index().node_begin[static_cast<std::size_t>(k) + 1]);
    EXPECT_EQ(part.tau_s, all.tau_s);
    EXPECT_EQ(part.g, same.g);
    EXPECT_EQ(part.sites.site, same.sites.site);
    EXPECT_EQ(part.sites.weight, same.sites.weight);
  }
}

TEST(DatabaseViscoelasticity, ASliceKeepsTheMemoryOfItsNodes) {
  const ResponseDatabase whole = relaxing_octahedron();
  SliceOptions options;
  options.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1.0, -0.01, -0.01),
                                      Eigen::Vector3d(1.0, 1.0, 1.0));
  const ResponseDatabase part = slice(whole, options);
  ASSERT_EQ(part.body.position_m.rows(), 4);  // nodes 0, 1, 2, 4
  const Viscoelasticity& relaxation = part.tools[1].viscoelasticity;
  EXPECT_EQ(relaxation.sites.node, (std::vector<std::int32_t>{3, 0, 2}));
  EXPECT_EQ(relaxation.g.row(3), viscous().g.row(4));
  EXPECT_EQ(relaxation.sites.weight.row(1), viscous().sites.weight.row(1));
  EXPECT_EQ(relaxation.sites.site.row(1), viscous().sites.site.row(1));
  // Where no node reads a site, it is left out; where its own node is gone, it stays.
  options.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1.0, -1.0, -0.01),
                                      Eigen::Vector3d(0.01, 0.01, 1.0));
  const Viscoelasticity other = slice(whole, options).tools[1].viscoelasticity;
  EXPECT_EQ(other.sites.node, (std::vector<std::int32_t>{2, -1, -1}));  // 1, 3, 4
  EXPECT_NO_THROW({
    const ScratchFolder folder;
    write_database(folder / "a.h5", slice(whole, options));
    static_cast<void>(read_database(folder / "a.h5"));
  });
}

TEST(DatabaseViscoelasticity, DatabasesThatRelaxDifferentlyDiffer) {
  const ResponseDatabase database = relaxing_octahedron();
  const auto compared = [&](const std::function<void(Viscoelasticity&)>& change) {
    ResponseDatabase other = database;
    change(other.tools[1].viscoelasticity);
    return difference(database, other, 0)[1];
  };
  const ToolDifference same = compared([](Viscoelasticity&) {});
  EXPECT_TRUE(same.agrees(0.0));
  const ToolDifference more = compared([](Viscoelasticity& v) {
    v.g(2, 1) += 0.1F;
  });
  EXPECT_FALSE(more.agrees(0.09));
  EXPECT_NEAR(more.largest_relaxation, 0.1, 0.001);
  EXPECT_TRUE(more.agrees(0.1001));
  const ToolDifference moved = compared([](Viscoelasticity& v) {
    v.sites.weight.row(1).leftCols<2>() << 0.5F, 0.5F;
  });
  EXPECT_EQ(moved.largest_relaxation, 0.0);
  EXPECT_FALSE(moved.agrees(1.0));
  const ToolDifference none = compared([](Viscoelasticity& v) {
    v = {};
  });
  EXPECT_NEAR(none.largest_relaxation, 0.5, 0.01);
}

TEST(DatabaseViscoelasticity, ASummaryDoubtsSitesThatAreNotTwoContactRadiiApart) {
  ResponseDatabase database = relaxing_octahedron();
  ResponseTable& ball = database.tools[1];  // 5 mm, pressed to 5 mm
  const double contact_m = std::sqrt(0.005 * 0.0025);
  const auto doubts = [&](double radii) {
    ball.viscoelasticity.sites.spacing_m = radii * contact_m;
    return doubts_of_memory(summarise(ball));
  };
  EXPECT_EQ(doubts(2.0), "");
  EXPECT_EQ(doubts(0.7), "must be 1.5 to 2.5: a sliding force relaxes too little");
  EXPECT_EQ(doubts(4.0), "must be 1.5 to 2.5: a sliding force relaxes too much");
  EXPECT_EQ(describe_memory(summarise(ball)),
            "3 sites, 14.1 mm apart, in 3 bundles, 4 contact radii of a press to half "
            "the largest depth; must be 1.5 to 2.5: a sliding force relaxes too much");
  EXPECT_EQ(describe(ball.viscoelasticity, share_extent(ball.viscoelasticity)),
            "held for long, 45..70 % of the force stay: g 0..0.25 in 0.5 s, g 0.3 in 4 "
            "s; curves are of a press at 1 mm/s; 7 probes; made up");
}

class BrokenViscoelasticity
    : public testing::TestWithParam<Violation<Viscoelasticity>> {};

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST_P(BrokenViscoelasticity, IsRefusedByNameWhenWrittenAndWhenRead) {
  ResponseDatabase database = relaxing_octahedron();
  GetParam().make(database.tools[1].viscoelasticity);
  const ScratchFolder folder;
  try {
    write_database(folder / "a.h5", database);
    FAIL() << "written";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
        << error.what();
  }
}

const std::vector<Violation<Viscoelasticity>> kViscoelasticityViolations{
    {"SharesAboveOne",
     [](auto& v) {
       v.g(3, 1) = 0.9F;
     },
     "/tools/ball/relaxation/g: row 3 sums to 1.05"},
    {"NegativeShare",
     [](auto& v) {
       v.g(2, 0) = -0.1F;
     },
     "/tools/ball/relaxation/g: row 2 has -0.1"},
    {"ShareNotANumber",
     [](auto& v) {
       v.g(2, 0) = std::numeric_limits<float>::quiet_NaN();
     },
     "/tools/ball/relaxation/g: row 2 has nan, must be at least 0"},
    {"TimeOfZero",
     [](auto& v) {
       v.tau_s[0] = 0.0;
     },
     "/tools/ball/relaxation/tau_s: element 0 is 0 after 0, must be positive"},
    {"TimesUnsorted",
     [](auto& v) {
       v.tau_s = {4.0, 0.5};
     },
     "/tools/ball/relaxation/tau_s: element 1 is 0.5 after 4, must be positive and "
     "increase"},
    {"TimesAlike",
     [](auto& v) {
       v.tau_s = {4.0, 4.0};
     },
     "element 1 is 4 after 4"},
    {"EndlessTime",
     [](auto& v) {
       v.tau_s[1] = kInf;
     },
     "element 1 is inf"},
    {"FiveTimes",
     [](auto& v) {
       v.tau_s = {1, 2, 3, 4, 5};
       v.g.setConstant(6, 5, 0.1F);
     },
     "/tools/ball/relaxation/tau_s has 5 rows, must have 1 to 4"},
    {"SharesOfOtherTimes",
     [](auto& v) {
       v.tau_s = {0.5};
     },
     "/tools/ball/relaxation/g is 6 x 2, must be 1 or 6 x 1"},
    {"SharesOfOtherNodes",
     [](auto& v) {
       v.g = v.g.topRows(4).eval();
     },
     "/tools/ball/relaxation/g is 4 x 2, must be 1 or 6 x 2"},
    {"PressWithoutSpeed",
     [](auto& v) {
       v.speed_m_per_s = 0.0;
     },
     "/tools/ball/relaxation@speed_m_per_s is 0, must be positive where curves"},
    {"ErrorsOfOtherNodes",
     [](auto& v) {
       v.error_relative.resize(5);
     },
     "/tools/ball/relaxation/error_relative has 5 rows, must have 1 or 6"},
    {"NegativeError",
     [](auto& v) {
       v.error_relative[1] = -1.0F;
     },
     "/tools/ball/relaxation/error_relative: row 1 has -1"},
    {"NegativeProbes",
     [](auto& v) {
       v.probes = -1;
     },
     "@probes is -1"},
    {"RuleOfTwoLines",
     [](auto& v) {
       v.rule = "a\nb";
     },
     "@rule is"},
    {"NoSpacing",
     [](auto& v) {
       v.sites.spacing_m = 0.0;
     },
     "/tools/ball/memory@spacing_m is 0, must be positive"},
    {"UnknownSite",
     [](auto& v) {
       v.sites.site(3, 0) = 3;
     },
     "/tools/ball/memory/site: row 3 has 3, must lie in [-1, 2]"},
    {"WeightsOfHalf",
     [](auto& v) {
       v.sites.weight(0, 0) = 0.5F;
     },
     "/tools/ball/memory/weight: row 0 sums to 0.5, must sum to 1"},
    {"NegativeWeight",
     [](auto& v) {
       v.sites.weight(1, 0) = -0.25F;
       v.sites.weight(1, 1) = 1.25F;
     },
     "/tools/ball/memory/weight: row 1 has -0.25 at site 0"},
    {"WeightWithoutSite",
     [](auto& v) {
       v.sites.weight(0, 2) = 0.5F;
     },
     "row 0 has 0.5 at site -1"},
    {"SiteAtNoNode",
     [](auto& v) {
       v.sites.node[1] = 6;
     },
     "/tools/ball/memory/site_node: row 1 has 6, must lie in [-1, 5]"},
    {"NineBundles",
     [](auto& v) {
       v.bundle_depth_m = {1, 2, 3, 4, 5, 6, 7, 8};
     },
     "/tools/ball/memory/bundle_depth_m has 8 rows, must have 0 to 7"},
    {"BundlesUnsorted",
     [](auto& v) {
       v.bundle_depth_m = {0.002, 0.001};
     },
     "/tools/ball/memory/bundle_depth_m: element 1 is 0.001 after 0.002"},
};
INSTANTIATE_TEST_SUITE_P(Viscoelasticity, BrokenViscoelasticity,
                         testing::ValuesIn(kViscoelasticityViolations),
                         [](const auto& violation) {
                           return violation.param.name;
                         });

TEST(DatabaseViscoelasticity, TwoStatementsOfRelaxationAreRefused) {
  const ScratchFolder folder;
  ResponseDatabase database = relaxing_octahedron();
  database.tools[1].relaxation = relaxing();
  EXPECT_THROW(write_database(folder / "a.h5", database), FormatError);
}

}  // namespace
}  // namespace palpate
