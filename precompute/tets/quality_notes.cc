#include "precompute/tets/quality_notes.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSurfaceAngle = 5.0 * kDegree;
constexpr double kDihedral = 1.0 * kDegree;
// The factor of a compact body of so many triangles fits a small machine's memory
// (precompute/README.md), and that of five times as many hardly any.
constexpr Eigen::Index kUsefulTriangles = 30000;
constexpr Eigen::Index kManyTriangles = 5 * kUsefulTriangles;

}  // namespace

std::vector<std::string> quality_notes(const SurfaceReport& report) {
  std::vector<std::string> notes;
  if (report.accepted() && report.triangles > kManyTriangles) {
    const double edge_m =
        std::sqrt(report.area_m2 / (0.25 * std::sqrt(3.0) * kUsefulTriangles));
    notes.push_back(fmt::format(
        "{} triangles are more than a build can use: palpate-precompute remesh MESH "
        "--edge-m {:.2g} -o OUT makes about {} and states how far they are from these",
        report.triangles, edge_m, kUsefulTriangles));
  }
  if (report.accepted() && report.smallest_angle_rad < kSurfaceAngle) {
    notes.push_back(
        fmt::format("poor surface: a triangle has an angle of {:.2g} deg, 5 or more "
                    "are good; palpate-precompute remesh makes even ones",
                    report.smallest_angle_rad / kDegree));
  }
  return notes;
}

std::vector<std::string> quality_notes(const TetQuality& quality) {
  if (quality.smallest_dihedral_rad >= kDihedral) {
    return {};
  }
  return {
      fmt::format("poor tets: the smallest dihedral angle is {:.2g} deg, 1 or more "
                  "is good; responses near it may be off",
                  quality.smallest_dihedral_rad / kDegree)};
}

}  // namespace palpate
