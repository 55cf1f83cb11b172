#include "precompute/tets/quality_notes.h"

#include <numbers>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSurfaceAngle = 5.0 * kDegree;
constexpr double kDihedral = 1.0 * kDegree;

}  // namespace

std::vector<std::string> quality_notes(const SurfaceReport& report) {
  if (!report.accepted() || report.smallest_angle_rad >= kSurfaceAngle) {
    return {};
  }
  return {
      fmt::format("poor surface: a triangle has an angle of {:.2g} deg, 5 or more "
                  "are good; palpate-precompute remesh makes even ones",
                  report.smallest_angle_rad / kDegree)};
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
