#include "formats/report/surface_picture.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/report/axis_ticks.h"
#include "formats/report/colour_map.h"
#include "formats/report/curves_svg.h"
#include "formats/report/surface_map.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

TEST(Viridis, RunsFromDarkBlueToYellowWithGrowingLightness) {
  EXPECT_EQ(hex(viridis(0.0)), "#440154");
  EXPECT_EQ(hex(viridis(1.0)), "#fde725");
  EXPECT_EQ(hex(viridis(-3.0)), hex(viridis(0.0)));
  EXPECT_EQ(hex(viridis(7.0)), hex(viridis(1.0)));
  EXPECT_EQ(hex(viridis(std::nan(""))), hex(viridis(0.0)));
  double before = 0.0;
  for (double t = 0.0; t <= 1.0; t += 0.01) {
    const double lightness = viridis(t).dot(Colour(0.2126, 0.7152, 0.0722));
    EXPECT_GT(lightness, before);
    before = lightness;
  }
}

TEST(Lit, OneLeavesAColourAndTheEndsAreBlackAndWhite) {
  const Colour colour(0.2, 0.4, 0.6);
  EXPECT_EQ(lit(colour, 1.0), colour);
  EXPECT_EQ(hex(lit(colour, 0.0)), "#000000");
  EXPECT_EQ(hex(lit(colour, 2.0)), "#ffffff");
}

TEST(AxisTicks, AreRoundInsideTheRangeAndAboutAsManyAsAskedFor) {
  EXPECT_EQ(round_down(3.7), 2.0);
  EXPECT_EQ(round_down(0.05), 0.05);
  EXPECT_EQ(round_down(99.0), 50.0);
  for (const double high : {0.0013, 0.9, 1.0, 6.12, 47.0, 1234.0}) {
    const std::vector<double> ticks = axis_ticks(0.0, high, 5);
    EXPECT_GE(ticks.size(), 3u) << high;
    EXPECT_LE(ticks.size(), 9u) << high;
    EXPECT_EQ(ticks.front(), 0.0);
    EXPECT_LE(ticks.back(), high * (1 + 1e-9));
  }
  EXPECT_EQ(short_number(1e-15), "0");
  EXPECT_EQ(short_number(1.25), "1.25");
}

TEST(StiffnessMap, HoldsForceOverDepthAtOneDepthAndOrdersTheNodes) {
  const ResponseTable table = small_database().tools[0];
  const SurfaceMap map = stiffness_map(table);
  EXPECT_EQ(map.depth_m, 0.002);  // half of 5 mm, rounded down
  EXPECT_EQ(map.value[2], table.curve(2).at(0.002).force_n / 0.002);
  EXPECT_TRUE(std::isnan(map.value[5]));
  ASSERT_EQ(map.lowest_first.size(), 5u);
  EXPECT_EQ(map.lowest_first.front(), 0);
}

TEST(StiffnessMap, AHomogeneousBodyShowsNoRoundingAsColours) {
  ResponseDatabase database = small_database();
  NodeResponse one;
  one.direction = Eigen::Vector3d::UnitZ();
  one.depth_m = {0.0, 0.001};
  one.force_n = {0.0, 0.1};
  one.origin = ResponseOrigin::kSimulated;
  std::vector<NodeResponse> responses(6, one);
  responses[3].force_n[1] *= 1.0 + 1e-12;
  const SurfaceMap map = stiffness_map(make_table(database.tools[0].tool, responses));
  EXPECT_NEAR(map.place(map.value[0]), 0.5, 1e-9);
  EXPECT_NEAR(map.place(map.value[3]), 0.5, 1e-9);
}

TEST(SurfacePicture, ShowsTheSameForTheSameInput) {
  const ResponseDatabase database = small_database();
  const std::string svg = surface_picture(database, database.tools[0]);
  EXPECT_EQ(svg, surface_picture(database, database.tools[0]));
  EXPECT_EQ(svg.rfind("<svg ", 0), 0u);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
  EXPECT_EQ(count(svg, "nan"), 0u);
  EXPECT_EQ(count(svg, "<g "), count(svg, "</g>"));
  EXPECT_EQ(count(svg, "href"), 0u);  // self-contained
  EXPECT_NE(svg.find("f/d at 2 mm"), std::string::npos);
  EXPECT_NE(svg.find("lowest"), std::string::npos);
}

TEST(SurfacePicture, TextsFromFilesCannotBecomeMarkup) {
  ResponseDatabase database = small_database();
  database.provenance.source_file = "<script>&\x01";
  const std::string svg = surface_picture(database, database.tools[0]);
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_NE(svg.find("&lt;script&gt;&amp; "), std::string::npos);
}

TEST(SurfacePicture, ABodyWithoutResponsesIsGrey) {
  const ResponseDatabase database = small_database();
  const ResponseTable none =
      make_table(database.tools[0].tool, std::vector<NodeResponse>(6));
  const std::string svg = surface_picture(database, none);
  EXPECT_EQ(count(svg, "nan"), 0u);
  EXPECT_NE(svg.find("0 of 6 nodes"), std::string::npos);
}

TEST(SurfacePicture, ShowsHowMuchAndHowFastAForceRelaxes) {
  ResponseDatabase database = small_database();
  ResponseTable& table = database.tools[1];
  EXPECT_THROW((void)surface_picture(database, table, Shown::kRelaxation), InputError);
  table.viscoelasticity = viscous();
  const SurfaceMap shares = relaxation_map(table);
  EXPECT_NEAR(shares.value[3], 45.0, 1e-5);
  EXPECT_TRUE(std::isnan(shares.value[5]));
  EXPECT_EQ(shares.lowest_first.back(), 4);
  const SurfaceMap times = relaxation_time_map(table);
  EXPECT_NEAR(times.value[0], 4.0, 1e-6);
  EXPECT_NEAR(times.value[4], (0.2 * 0.5 + 0.3 * 4.0) / 0.5, 1e-6);
  EXPECT_EQ(times.lowest_first.front(), 4);
  for (const Shown shown : {Shown::kRelaxation, Shown::kTime}) {
    const std::string svg = surface_picture(database, table, shown);
    EXPECT_EQ(count(svg, "nan"), 0u);
    EXPECT_NE(svg.find("time since the press [s]"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate
