#include "formats/response/contact_table.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/response/tangent_frame.h"
#include "formats/response/turn_from_z.h"

namespace palpate {
namespace {

constexpr double kRadiusM = 0.004;
constexpr double kNormalN = 0.3;

// A ball's contact at every depth: its radius grows with the root of the share, and its
// pressure has second moments a^2 / (2 (m + 2)).
ContactTable round_contact(double exponent) {
  ContactTable table;
  table.centre_m = RowsOf<float>::Zero(1, 8);
  table.moment_m2 = RowsOf<float>::Zero(1, 12);
  table.exponent = RowsOf<float>::Constant(1, 4, static_cast<float>(exponent));
  table.pressure_error = RowsOf<float>::Constant(1, 1, 0.01F);
  table.lateral = RowsOf<float>::Zero(1, 12);
  table.lateral_error = RowsOf<float>::Constant(1, 1, 0.03F);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double share = kContactDepthShares[static_cast<std::size_t>(k)];
    const double moment = share * kRadiusM * kRadiusM / (2.0 * (exponent + 2.0));
    table.moment_m2(0, 3 * k) = static_cast<float>(moment);
    table.moment_m2(0, 3 * k + 2) = static_cast<float>(moment);
    table.lateral(0, 3 * k) = 1.0F + 0.1F * static_cast<float>(k);
    table.lateral(0, 3 * k + 1) = 0.05F;
    table.lateral(0, 3 * k + 2) = 2.0F;
  }
  return table;
}

// Hertz: p_0 = 3 N / (2 pi a^2).
TEST(ContactTable, GivesHertzPressure) {
  const ContactTable table = round_contact(0.5);
  for (const double share : {1.0, 0.7, 0.25, 0.01}) {
    const ContactPressure pressure = pressure_at(table, 0, share, kNormalN);
    const double a_m = std::sqrt(share) * kRadiusM;
    EXPECT_NEAR(pressure.radius_m() / a_m, 1.0, 1e-6) << share;
    EXPECT_NEAR(
        pressure.middle_pa() / (1.5 * kNormalN / (std::numbers::pi * a_m * a_m)), 1.0,
        1e-6)
        << share;
  }
}

// A rigid flat punch: N / (2 pi a^2) in the middle.
TEST(ContactTable, GivesThePressureOfAPunch) {
  const ContactPressure pressure = pressure_at(round_contact(-0.5), 0, 1.0, kNormalN);
  EXPECT_NEAR(pressure.radius_m() / kRadiusM, 1.0, 1e-6);
  EXPECT_NEAR(pressure.middle_pa() /
                  (0.5 * kNormalN / (std::numbers::pi * kRadiusM * kRadiusM)),
              1.0, 1e-6);
}

TEST(ContactTable, StiffnessIsLinearBetweenDepthsAndConstantBeyond) {
  const ContactTable table = round_contact(0.5);
  const auto xx = [&](double share) {
    return lateral_at(table, 0, share)(0, 0);
  };
  EXPECT_NEAR(xx(0.0), 1.0, 1e-7);
  EXPECT_NEAR(xx(1.0 / 16.0), 1.0, 1e-7);
  EXPECT_NEAR(xx(0.5 * (1.0 / 16.0 + 1.0 / 4.0)), 1.05, 1e-7);
  EXPECT_NEAR(xx(9.0 / 16.0), 1.2, 1e-7);
  EXPECT_NEAR(xx(1.0), 1.3, 1e-7);
  EXPECT_NEAR(xx(7.0), 1.3, 1e-7);
  EXPECT_EQ(lateral_at(table, 0, 0.3), lateral_at(table, 0, 0.3).transpose());
}

TEST(ContactTable, StacksRowsAndTakesThemOutAgain) {
  const ContactTable one = round_contact(0.5);
  const ContactTable none;
  const std::array<const ContactTable*, 3> rows{&none, &one, &none};
  const ContactTable all = stacked(rows);
  ASSERT_EQ(all.lateral.rows(), 3);
  EXPECT_EQ(all.lateral.row(0).norm(), 0.0F);
  EXPECT_EQ(all.moment_m2.row(1), one.moment_m2.row(0));
  const std::array<std::int32_t, 2> wanted{1, 2};
  const ContactTable some = rows_of(all, wanted);
  ASSERT_EQ(some.exponent.rows(), 2);
  EXPECT_EQ(some.lateral.row(0), one.lateral.row(0));
  EXPECT_EQ(some.lateral.row(1).norm(), 0.0F);
  EXPECT_TRUE(stacked(std::array<const ContactTable*, 2>{&none, &none}).empty());
}

TEST(ContactTable, SaysWhatBreaksItsRules) {
  EXPECT_EQ(broken_contact_row(round_contact(0.5), 0), "");
  const auto said = [](const auto& change) {
    ContactTable table = round_contact(0.5);
    change(table);
    return broken_contact_row(table, 0);
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(said([](ContactTable& t) {
              t.moment_m2(0, 4) = 1.0F;
            }).find("moment_m2"),
            std::string::npos);
  EXPECT_NE(said([](ContactTable& t) {
              t.centre_m(0, 1) = kNan;
            }).find("centre_m"),
            std::string::npos);
  EXPECT_NE(said([](ContactTable& t) {
              t.exponent(0, 3) = -1.0F;
            }).find("exponent"),
            std::string::npos);
  EXPECT_NE(said([](ContactTable& t) {
              t.lateral(0, 9) = -1.0F;
            }).find("stiffness"),
            std::string::npos);
  EXPECT_NE(said([](ContactTable& t) {
              t.lateral(0, 9) = 500.0F;
            }).find("100"),
            std::string::npos);
  EXPECT_NE(said([](ContactTable& t) {
              t.lateral_error(0, 0) = kNan;
            }).find("error_relative"),
            std::string::npos);
}

TEST(TangentFrame, IsTheLeastTurnFromZ) {
  for (const Eigen::Vector3d& n :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 0, 0),
        Eigen::Vector3d(0.3, -0.5, 0.2).normalized(),
        Eigen::Vector3d(0.01, 0.02, -1.0).normalized()}) {
    const auto frame = tangent_frame(n);
    const Eigen::Matrix3d turned = turn_from_z(n).toRotationMatrix();
    EXPECT_NEAR((frame - turned.leftCols<2>()).norm(), 0.0, 1e-11) << n.transpose();
    EXPECT_NEAR((frame.transpose() * n).norm(), 0.0, 1e-11);
  }
}

}  // namespace
}  // namespace palpate
