#include "precompute/surface/contact_spheres.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"

namespace palpate {
namespace {

constexpr double kSamples = 4000.0;  // points of the surface, about
constexpr int kRadii = 24;

// Points that stand for equal parts of the surface.
struct SurfaceSamples {
  Points position_m;
  Points normal;
};

SurfaceSamples sampled(const SurfaceMesh& tool) {
  const auto corner = [&](Eigen::Index t, Eigen::Index j) -> Eigen::Vector3d {
    return tool.position_m.row(tool.triangle(t, j)).transpose();
  };
  std::vector<Eigen::Vector3d> across;
  double area_m2 = 0.0;
  for (Eigen::Index t = 0; t < tool.triangle.rows(); ++t) {
    across.push_back(0.5 *
                     (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)));
    area_m2 += across.back().norm();
  }
  if (!(area_m2 > 0.0)) {
    throw InputError("the tool's surface has no area");
  }
  std::vector<Eigen::Vector3d> position;
  std::vector<Eigen::Vector3d> normal;
  for (Eigen::Index t = 0; t < tool.triangle.rows(); ++t) {
    const double part_m2 = across[static_cast<std::size_t>(t)].norm();
    if (part_m2 > 0.0) {
      // The middles of a grid of triangles of the same shape.
      const int n = std::max(
          1, static_cast<int>(std::lround(std::sqrt(kSamples * part_m2 / area_m2))));
      for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
          const double a = (i + 1.0 / 3.0) / n;
          const double b = (j + 1.0 / 3.0) / n;
          position.push_back((1.0 - a - b) * corner(t, 0) + a * corner(t, 1) +
                             b * corner(t, 2));
          normal.push_back(across[static_cast<std::size_t>(t)] / part_m2);
        }
      }
    }
  }
  SurfaceSamples samples{Points(std::ssize(position), 3),
                         Points(std::ssize(normal), 3)};
  for (std::size_t i = 0; i < position.size(); ++i) {
    samples.position_m.row(static_cast<Eigen::Index>(i)) = position[i].transpose();
    samples.normal.row(static_cast<Eigen::Index>(i)) = normal[i].transpose();
  }
  return samples;
}

// The first at the tip, which is lowest; each further one farthest from those before.
std::vector<Eigen::Index> spread(const Points& position_m, std::size_t count) {
  Eigen::Index next = 0;
  position_m.col(2).minCoeff(&next);
  std::vector<Eigen::Index> places;
  Eigen::VectorXd away_m2 = Eigen::VectorXd::Constant(
      position_m.rows(), std::numeric_limits<double>::infinity());
  while (places.size() < count) {
    places.push_back(next);
    away_m2 = away_m2.cwiseMin(
        (position_m.rowwise() - position_m.row(next)).rowwise().squaredNorm());
    away_m2.maxCoeff(&next);
  }
  return places;
}

ContactSpheres with_radius(const SurfaceSamples& samples,
                           const std::vector<Eigen::Index>& places, double radius_m) {
  ContactSpheres spheres{.centre_m = Points(std::ssize(places), 3),
                         .radius_m = radius_m};
  Eigen::VectorXd nearest_m = Eigen::VectorXd::Constant(
      samples.position_m.rows(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::RowVector3d centre =
        samples.position_m.row(places[i]) - radius_m * samples.normal.row(places[i]);
    spheres.centre_m.row(static_cast<Eigen::Index>(i)) = centre;
    nearest_m =
        nearest_m.cwiseMin((samples.position_m.rowwise() - centre).rowwise().norm());
  }
  // Each sphere touches the surface from inside at its place; off is how far the
  // union's surface is from the samples.
  const Eigen::ArrayXd off_m = (nearest_m.array() - radius_m).abs();
  spheres.largest_error_m = off_m.maxCoeff();
  spheres.rms_error_m = std::sqrt(off_m.square().mean());
  return spheres;
}

}  // namespace

ContactSpheres contact_spheres(const SurfaceMesh& tool, std::size_t count,
                               double radius_m) {
  const SurfaceSamples samples = sampled(tool);
  const std::vector<Eigen::Index> places = spread(samples.position_m, count);
  if (radius_m > 0.0) {
    return with_radius(samples, places, radius_m);
  }
  const double size_m = (samples.position_m.colwise().maxCoeff() -
                         samples.position_m.colwise().minCoeff())
                            .maxCoeff();
  ContactSpheres best;
  for (int i = 0; i < kRadii; ++i) {
    // Radii of equal ratios from 1 % to 50 % of the tool's size.
    const double tried_m =
        0.01 * size_m * reproducible::pow(50.0, static_cast<double>(i) / (kRadii - 1));
    const ContactSpheres spheres = with_radius(samples, places, tried_m);
    if (i == 0 || spheres.rms_error_m < best.rms_error_m) {
      best = spheres;
    }
  }
  return best;
}

}  // namespace palpate
