#include "formats/response/taxels.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/curve_view.h"

namespace palpate {
namespace {

constexpr double kBallM = 0.01;
constexpr double kLastM = 0.002;
constexpr double kModulusPa = 11000.0;  // E / (1 - nu^2)

double flat_hertz_n(double depth_m) {
  return 4.0 / 3.0 * kModulusPa * std::sqrt(kBallM) * std::pow(depth_m, 1.5);
}

// A half-space's responses to a ball, at the corners of a square of the plane z = 0.
struct FlatBody {
  FlatBody() : table(make_table({.name = "ball", .radius_m = kBallM}, responses())) {}

  [[nodiscard]] Taxels press(double depth_m, const TaxelGrid& grid = {}) const {
    return taxels_at(mesh, normal, search, table, {0.004, 0.006, kBallM - depth_m},
                     grid);
  }

  static std::vector<NodeResponse> responses() {
    NodeResponse one{.direction = Eigen::Vector3d::UnitZ(),
                     .depth_m = {},
                     .force_n = {},
                     .origin = ResponseOrigin::kSimulated};
    for (int k = 0; k <= 40; ++k) {
      const double share = k / 40.0;
      one.depth_m.push_back(kLastM * share * share);
      one.force_n.push_back(flat_hertz_n(one.depth_m.back()));
    }
    one.contact.centre_m = RowsOf<float>::Zero(1, 8);
    one.contact.moment_m2 = RowsOf<float>::Zero(1, 12);
    one.contact.exponent = RowsOf<float>::Constant(1, 4, 0.5F);
    one.contact.pressure_error = RowsOf<float>::Constant(1, 1, 0.02F);
    for (Eigen::Index k = 0; k < 4; ++k) {
      const auto moment = static_cast<float>(
          kBallM * kLastM * kContactDepthShares[static_cast<std::size_t>(k)] / 5.0);
      one.contact.moment_m2.block<1, 3>(0, 3 * k) << moment, 0.0F, moment;
    }
    return {4, one};
  }

  static SurfaceMesh square() {
    SurfaceMesh mesh;
    mesh.position_m = Points::Zero(4, 3);
    mesh.position_m.row(1) << 0.02, 0.0, 0.0;
    mesh.position_m.row(2) << 0.02, 0.02, 0.0;
    mesh.position_m.row(3) << 0.0, 0.02, 0.0;
    mesh.triangle = Triangles::Zero(2, 3);
    mesh.triangle.row(0) << 0, 1, 2;
    mesh.triangle.row(1) << 0, 2, 3;
    return mesh;
  }

  SurfaceMesh mesh = square();
  Points normal = Eigen::RowVector3d(0.0, 0.0, 1.0).replicate(4, 1);
  SurfaceSearch search{mesh};
  ResponseTable table;
};

double sum_n(const Taxels& taxels, const TaxelGrid& grid) {
  return taxels.pressure_pa.sum() * grid.pitch_m * grid.pitch_m;
}

TEST(Taxels, SumToTheForceAtEveryDepth) {
  const FlatBody body;
  const TaxelGrid grid{.rows = 20, .columns = 24, .pitch_m = 0.0005};
  for (const double depth_m : {1e-5, 3e-4, 1e-3, 2e-3}) {
    const Taxels taxels = body.press(depth_m, grid);
    EXPECT_NEAR(sum_n(taxels, grid) / taxels.contact.normal_n, 1.0, 1e-12);
    EXPECT_EQ(taxels.beside_n, 0.0);
    EXPECT_NEAR(taxels.contact.normal_n / flat_hertz_n(depth_m), 1.0, 0.01) << depth_m;
  }
}

// p = 3 N / (2 pi a^2) sqrt(1 - r^2 / a^2), from taxel to taxel.
TEST(Taxels, AreHertzs) {
  const FlatBody body;
  const TaxelGrid grid{.rows = 41, .columns = 41, .pitch_m = 0.00025};
  const Taxels taxels = body.press(kLastM, grid);
  const double a_m = std::sqrt(kBallM * kLastM);
  const double peak_pa = 1.5 * taxels.contact.normal_n / (std::numbers::pi * a_m * a_m);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const double r_m = grid.pitch_m * std::hypot(row - 20.0, column - 20.0);
      if (r_m < 0.8 * a_m) {
        EXPECT_NEAR(taxels.pressure_pa(row, column) / peak_pa,
                    std::sqrt(1.0 - r_m * r_m / (a_m * a_m)), 0.03)
            << row << " " << column;
      } else if (r_m > a_m + grid.pitch_m) {
        EXPECT_EQ(taxels.pressure_pa(row, column), 0.0);
      }
    }
  }
}

TEST(Taxels, SayWhatLiesBesideThem) {
  const FlatBody body;
  const TaxelGrid grid{.rows = 4, .columns = 2, .pitch_m = 0.001};
  const Taxels taxels = body.press(kLastM, grid);
  EXPECT_GT(taxels.beside_n, 0.2 * taxels.contact.normal_n);
  EXPECT_NEAR((sum_n(taxels, grid) + taxels.beside_n) / taxels.contact.normal_n, 1.0,
              1e-12);
}

// Longer along x: columns go along x.
TEST(Taxels, FollowTheEllipsesAxes) {
  FlatBody body;
  for (Eigen::Index k = 0; k < 4; ++k) {
    body.table.contact.moment_m2.col(3 * k) *= 4.0F;
  }
  const TaxelGrid grid{.rows = 40, .columns = 40, .pitch_m = 0.0005};
  const Taxels taxels = body.press(kLastM, grid);
  Eigen::Vector2d second = Eigen::Vector2d::Zero();
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      const double p = taxels.pressure_pa(row, column);
      second += p * Eigen::Vector2d((column - 19.5) * (column - 19.5),
                                    (row - 19.5) * (row - 19.5));
    }
  }
  EXPECT_NEAR(second.x() / second.y(), 4.0, 0.1);
}

TEST(Taxels, AreZeroWithoutContactAndRefusedWithoutSense) {
  FlatBody body;
  EXPECT_EQ(body.press(-1e-3).pressure_pa.sum(), 0.0);
  EXPECT_THROW((void)body.press(1e-3, {.rows = 0}), InputError);
  EXPECT_THROW((void)body.press(1e-3, {.pitch_m = 0.0}), InputError);
  EXPECT_THROW((void)body.press(std::numeric_limits<double>::quiet_NaN()), InputError);
  body.table.contact = {};
  EXPECT_THROW((void)body.press(1e-3), InputError);
}

}  // namespace
}  // namespace palpate
