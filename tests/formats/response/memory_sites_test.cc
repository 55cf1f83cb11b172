#include "formats/response/memory_sites.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

std::vector<bool> all_of(const SurfaceMesh& body) {
  return std::vector<bool>(static_cast<std::size_t>(body.position_m.rows()), true);
}

MemorySites sites_of(const SurfaceMesh& body, double spacing_m) {
  return place_sites(body, vertex_normals(body), all_of(body), spacing_m);
}

void expect_partition(const MemorySites& sites) {
  for (Eigen::Index i = 0; i < sites.site.rows(); ++i) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < kMostNodeSites; ++k) {
      EXPECT_GE(sites.weight(i, k), 0.0F) << i;
      EXPECT_EQ(sites.site(i, k) < 0, sites.weight(i, k) == 0.0F) << i;
      EXPECT_LT(sites.site(i, k), static_cast<std::int32_t>(sites.node.size()));
      sum += static_cast<double>(sites.weight(i, k));
    }
    EXPECT_NEAR(sum, 1.0, 1e-6) << i;
  }
}

TEST(MemorySites, OfAFinePlateLieTheSpacingApartAndAreInterpolatedLinearly) {
  const SurfaceMesh body = plate(0.1, 80);
  for (const double spacing_m : {0.006, 0.01, 0.02}) {
    const MemorySites sites = sites_of(body, spacing_m);
    expect_partition(sites);
    EXPECT_GE(mean_spacing_m(sites, body.position_m), 0.75 * spacing_m);
    EXPECT_LE(mean_spacing_m(sites, body.position_m), 1.1 * spacing_m);
    // Area coordinates of a triangle give its points back.
    int inside = 0;
    for (Eigen::Index i = 0; i < body.position_m.rows(); ++i) {
      const Eigen::RowVector3d p = body.position_m.row(i);
      if (p.head<2>().cwiseAbs().maxCoeff() > 0.05 - spacing_m) {
        continue;
      }
      Eigen::RowVector3d blend = Eigen::RowVector3d::Zero();
      for (Eigen::Index k = 0; k < kMostNodeSites; ++k) {
        if (sites.site(i, k) >= 0) {
          const auto site = static_cast<std::size_t>(sites.site(i, k));
          blend += static_cast<double>(sites.weight(i, k)) *
                   body.position_m.row(sites.node[site]);
        }
      }
      ASSERT_NEAR((blend - p).norm(), 0.0, 1e-8) << i;
      ++inside;
    }
    EXPECT_GT(inside, 1000);
  }
}

TEST(MemorySites, OfASphereAreSpreadOverAllOfIt) {
  const SurfaceMesh body = sphere_surface(0.05, 4);
  const MemorySites sites = sites_of(body, 0.02);
  expect_partition(sites);
  // A triangle of that side for each half of its sites.
  const double area_m2 = 4.0 * std::numbers::pi * 0.05 * 0.05;
  const double expected = area_m2 / (0.02 * 0.02 * std::sqrt(3.0) / 2.0);
  EXPECT_GT(static_cast<double>(sites.node.size()), 0.7 * expected);
  EXPECT_LT(static_cast<double>(sites.node.size()), 1.6 * expected);
}

TEST(MemorySites, OfACoarseMeshAreItsNodes) {
  const SurfaceMesh body = plate(0.1, 5);
  const MemorySites sites = sites_of(body, 0.01);
  EXPECT_EQ(static_cast<Eigen::Index>(sites.node.size()), body.position_m.rows());
  for (Eigen::Index i = 0; i < body.position_m.rows(); ++i) {
    EXPECT_EQ(sites.node[static_cast<std::size_t>(sites.site(i, 0))], i);
    EXPECT_EQ(sites.weight(i, 0), 1.0F);
  }
}

TEST(MemorySites, NodesWithoutResponseHaveNone) {
  const SurfaceMesh body = plate(0.1, 40);
  std::vector<bool> remembers = all_of(body);
  for (std::size_t i = 0; i < remembers.size(); ++i) {
    remembers[i] = body.position_m(static_cast<Eigen::Index>(i), 0) > 0.0;
  }
  const MemorySites sites = place_sites(body, vertex_normals(body), remembers, 0.01);
  for (std::size_t i = 0; i < remembers.size(); ++i) {
    EXPECT_EQ(sites.site(static_cast<Eigen::Index>(i), 0) >= 0, remembers[i]) << i;
  }
  for (const std::int32_t node : sites.node) {
    EXPECT_TRUE(remembers[static_cast<std::size_t>(node)]);
  }
}

TEST(MemorySites, EveryPieceOfABodyHasSites) {
  SurfaceMesh body = plate(0.02, 4);
  const Eigen::Index n = body.position_m.rows();
  const Eigen::Index t = body.triangle.rows();
  body.position_m.conservativeResize(2 * n, 3);
  body.triangle.conservativeResize(2 * t, 3);
  body.position_m.bottomRows(n) = body.position_m.topRows(n);
  body.position_m.bottomRows(n).col(2).array() += 0.001;
  body.triangle.bottomRows(t) =
      body.triangle.topRows(t).array() + static_cast<std::int32_t>(n);
  const MemorySites sites = sites_of(body, 0.1);
  EXPECT_EQ(sites.node.size(), 2U);
  expect_partition(sites);
  // One millimetre apart, and yet each node reads the site of its own piece.
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    const auto site = static_cast<std::size_t>(sites.site(i, 0));
    EXPECT_EQ(sites.node[site] < n, i < n) << i;
  }
}

TEST(ContactRadius, IsThatOfTheTool) {
  ToolShape tool = ball(0.004, 0.0, 0.0);
  EXPECT_NEAR(contact_radius_m(tool, 0.001), 0.002, 1e-15);
  EXPECT_NEAR(site_spacing_m(tool, 0.002), 0.004, 1e-15);
  tool.kind = "flat-punch";
  EXPECT_EQ(contact_radius_m(tool, 0.001), 0.004);
  tool.kind = "cone";
  tool.half_angle_rad = std::numbers::pi / 4.0;
  EXPECT_NEAR(contact_radius_m(tool, 0.001), 0.002 / std::numbers::pi, 1e-12);
}

TEST(ContactRadius, OfAMeshThatIsASphereIsTheSpheres) {
  ToolShape tool;
  tool.kind = "mesh";
  tool.mesh = sphere_surface(0.004, 4);
  EXPECT_NEAR(contact_radius_m(tool, 0.001), 0.002, 2e-4);
}

}  // namespace
}  // namespace palpate
