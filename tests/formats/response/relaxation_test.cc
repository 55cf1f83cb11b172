// What stays of a force while it is held, and that a database keeps it.
#include "formats/response/relaxation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/database/chunk_reader.h"
#include "formats/database/database_diff.h"
#include "formats/database/database_slice.h"
#include "formats/database/database_summary.h"
#include "formats/database/response_database.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

std::filesystem::path file_of(const char* name) {
  return std::filesystem::path(testing::TempDir()) / name;
}

// All nodes alike in the first tool, each its own in the second.
ResponseDatabase relaxing_database() {
  ResponseDatabase database = small_database();
  database.measurement = held();
  database.tools[0].relaxation = relaxing();
  ResponseRelaxation& own = database.tools[1].relaxation;
  own = relaxing();
  own.terms = {};
  for (int i = 0; i < 6; ++i) {
    own.terms.g_1.push_back(0.05 * i);
    own.terms.g_2.push_back(0.1);
    own.terms.tau_1_s.push_back(0.5 + i);
    own.terms.tau_2_s.push_back(20.0);
  }
  return database;
}

TEST(RelaxedShare, FallsFromOneToWhatNeitherTermTakes) {
  const PronyTerms terms = relaxing().terms;
  EXPECT_EQ(relaxed_share(terms, 0, 0.0), 1.0);
  EXPECT_NEAR(relaxed_share(terms, 0, 1e3), 1.0 - 0.26 - 0.3, 1e-15);
  EXPECT_NEAR(relaxed_share(terms, 0, 0.42),
              1.0 - 0.26 * (1.0 - std::exp(-1.0)) - 0.3 * (1.0 - std::exp(-0.42 / 4.5)),
              1e-15);
}

TEST(StoredRelaxation, ComesBackInTheOrderOfTheSource) {
  const ResponseDatabase written = relaxing_database();
  const auto file = file_of("relaxation_order.h5");
  write_database(file, written);
  const ResponseDatabase read = read_database(file);
  for (std::size_t tool = 0; tool < 2; ++tool) {
    const ResponseRelaxation& a = written.tools[tool].relaxation;
    const ResponseRelaxation& b = read.tools[tool].relaxation;
    EXPECT_EQ(b.rule, a.rule);
    EXPECT_EQ(b.probes, a.probes);
    EXPECT_EQ(b.speed_m_per_s, a.speed_m_per_s);
    EXPECT_EQ(b.seconds, a.seconds);
    EXPECT_EQ(b.terms.g_1, a.terms.g_1);
    EXPECT_EQ(b.terms.g_2, a.terms.g_2);
    EXPECT_EQ(b.terms.tau_1_s, a.terms.tau_1_s);
    EXPECT_EQ(b.terms.tau_2_s, a.terms.tau_2_s);
  }
  const RunRelaxation& runs = read.measurement.relaxation;
  ASSERT_EQ(runs.terms.size(), 2U);
  EXPECT_EQ(runs.terms.tau_2_s[0], 5.0);
  EXPECT_TRUE(std::isnan(runs.terms.g_1[1]));
  EXPECT_EQ(runs.speed_m_per_s[0], 1e-3);
}

TEST(StoredRelaxation, StandsInTheSummaryOfTheIndexAlone) {
  const auto file = file_of("relaxation_index.h5");
  write_database(file, relaxing_database());
  const DatabaseIndex index = read_index(file);
  const ToolSummary summary = summarise(index.tools[0]);
  EXPECT_EQ(summary.relaxation.terms.g_2, std::vector{0.3});
  EXPECT_EQ(describe(summary.relaxation),
            "held, 47.3 % of the force stay after 10 s: g 0.26, 0.3, tau 0.42, 4.5 s; "
            "curves are of a press at 1 mm/s; 3 probes; median of the probes, the same "
            "at every node");
}

TEST(StoredRelaxation, IsAbsentWhereNobodyGaveIt) {
  const auto file = file_of("relaxation_none.h5");
  write_database(file, small_database());
  EXPECT_TRUE(read_database(file).tools[0].relaxation.empty());
  EXPECT_TRUE(read_index(file).tools[0].relaxation.empty());
}

TEST(StoredRelaxation, GoesWithItsNodesIntoASliceAndThroughAMerge) {
  const ResponseDatabase all = relaxing_database();
  SliceOptions options;  // triangles 0 to 3: without node 5
  options.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1.0, -1.0, -0.01),
                                      Eigen::Vector3d(1.0, 1.0, 1.0));
  const ResponseDatabase part = slice(all, options);
  EXPECT_EQ(part.tools[0].relaxation.terms.g_1, all.tools[0].relaxation.terms.g_1);
  const std::vector<double>& g_1 = all.tools[1].relaxation.terms.g_1;
  EXPECT_EQ(part.tools[1].relaxation.terms.g_1,
            std::vector<double>(g_1.begin(), g_1.begin() + 5));
  ResponseDatabase first = all, second = all;
  first.tools.resize(1);
  first.measurement = {};
  second.tools.erase(second.tools.begin());
  const ResponseDatabase merged = merge({first, second});
  EXPECT_EQ(merged.tools[1].relaxation.terms.tau_1_s,
            all.tools[1].relaxation.terms.tau_1_s);
  EXPECT_EQ(merged.measurement.relaxation.terms.size(), 2U);
}

TEST(DatabaseDifference, OfRelaxationIsThatOfTheSharesThatStay) {
  const ResponseDatabase all = relaxing_database();
  ResponseDatabase other = all;
  EXPECT_EQ(difference(all, other, 1)[0].largest_relaxation, 0.0);
  EXPECT_TRUE(difference(all, other, 1)[0].agrees(0.0));
  other.tools[0].relaxation = {};
  const ToolDifference lost = difference(all, other, 1)[0];
  EXPECT_NEAR(lost.largest_relaxation,
              1.0 - relaxed_share(relaxing().terms, 0, relaxing().seconds), 1e-15);
  EXPECT_FALSE(lost.agrees(0.1));
}

}  // namespace
}  // namespace palpate
