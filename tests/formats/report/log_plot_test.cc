#include "formats/report/log_plot.h"

#include <limits>
#include <regex>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// Centres of the dots, in the order of the picture; those of the legend come between.
std::vector<std::pair<double, double>> dots(const std::string& svg) {
  const std::regex circle("<circle cx=\"([0-9.]+)\" cy=\"([0-9.]+)\" r=\"4.0\"");
  std::vector<std::pair<double, double>> found;
  for (std::sregex_iterator at(svg.begin(), svg.end(), circle), end; at != end; ++at) {
    found.emplace_back(std::stod((*at)[1]), std::stod((*at)[2]));
  }
  return found;
}

LogPicture picture_of(std::vector<LogPoint> points) {
  return {.title = "t",
          .subtitle = "",
          .x_name = "x",
          .y_name = "y",
          .series = {{.name = "s", .point = std::move(points)}},
          .level = 0.0,
          .level_name = ""};
}

TEST(LogPicture, EqualRatiosAreEqualDistances) {
  const auto at =
      dots(log_picture(picture_of({{1.0, 8.0}, {3.0, 4.0}, {9.0, 2.0}, {27.0, 1.0}})));
  ASSERT_EQ(at.size(), 4U);
  // Positions are written to a tenth of a pixel.
  for (std::size_t i = 2; i < at.size(); ++i) {
    EXPECT_NEAR(at[i].first - at[i - 1].first, at[1].first - at[0].first, 0.21);
    EXPECT_NEAR(at[i].second - at[i - 1].second, at[1].second - at[0].second, 0.21);
  }
  EXPECT_GT(at[1].first, at[0].first);
  EXPECT_GT(at[1].second, at[0].second) << "smaller is lower";
}

TEST(LogPicture, WhatHasNoLogarithmIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = log_picture(
      picture_of({{1.0, 0.0}, {-1.0, 1.0}, {nan, 1.0}, {1.0, 1.0 / 0.0}, {2.0, 2.0}}));
  EXPECT_EQ(dots(svg).size(), 1U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(LogPicture, NothingToShowIsStillAPicture) {
  const std::string svg = log_picture(picture_of({}));
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(LogPicture, IsAsWideAsItsLongestNameNeeds) {
  LogPicture picture = picture_of({{1.0, 1.0}});
  EXPECT_NE(log_picture(picture).find("viewBox=\"0 0 900 600\""), std::string::npos);
  picture.series[0].name = std::string(40, 'x');  // from 688 on, 7.5 px each
  EXPECT_NE(log_picture(picture).find("viewBox=\"0 0 1008 600\""), std::string::npos);
}

TEST(LogPicture, NamesCannotBecomeMarkup) {
  LogPicture picture = picture_of({{1.0, 1.0}});
  picture.title = "<script>";
  EXPECT_EQ(log_picture(picture).find("<script>"), std::string::npos);
}

// XML with stray bytes is none.
TEST(LogPicture, BytesThatAreNoUtf8AreReplaced) {
  LogPicture picture = picture_of({{1.0, 1.0}});
  picture.title = "l\xff\xc3 Leber \xc3\xa4";
  const std::string svg = log_picture(picture);
  EXPECT_NE(svg.find("l\xEF\xBF\xBD\xEF\xBF\xBD Leber \xc3\xa4"), std::string::npos);
  EXPECT_EQ(svg.find('\xff'), std::string::npos);
}

}  // namespace
}  // namespace palpate
