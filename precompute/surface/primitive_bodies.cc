#include "precompute/surface/primitive_bodies.h"

#include <numbers>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "precompute/surface/subdivide.h"

namespace palpate {
namespace {

void require(bool good, const char* what, double value, const char* allowed) {
  if (!good) {
    throw InputError(fmt::format("{} is {}, must be {}", what, value, allowed));
  }
}

SurfaceMesh icosahedron() {
  constexpr double kPhi = std::numbers::phi;
  SurfaceMesh mesh;
  mesh.position_m.resize(12, 3);
  mesh.position_m << -1, kPhi, 0, 1, kPhi, 0, -1, -kPhi, 0, 1, -kPhi, 0,  //
      0, -1, kPhi, 0, 1, kPhi, 0, -1, -kPhi, 0, 1, -kPhi,                 //
      kPhi, 0, -1, kPhi, 0, 1, -kPhi, 0, -1, -kPhi, 0, 1;
  mesh.position_m.rowwise().normalize();
  mesh.triangle.resize(20, 3);
  mesh.triangle << 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11,  //
      1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8,               //
      3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9,                   //
      4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1;
  return mesh;
}

constexpr int kSpreadSweeps = 40;  // smallest angle 12.9 degrees without, 18.5 with

// The organ's surface in direction u of its middle, |u| = 1.
Eigen::Vector3d organ_point_m(const Eigen::Vector3d& u) {
  const double notch =
      reproducible::exp(-6.0 * (u - Eigen::Vector3d(0.2, -1.0, 0.0)).squaredNorm());
  const double radius =
      1.0 - 0.10 * notch + 0.08 * reproducible::sin(2.0 * u.x() + 1.0) * u.y();
  Eigen::Vector3d p = radius * u;
  p.y() *= 1.0 - 0.20 * p.x();  // broad at one end,
  p.z() *= 1.0 - 0.30 * p.x();  // and thick
  // Flatter underneath, without a kink at the rim.
  p.z() *= 0.8 + 0.2 * reproducible::tanh(4.0 * p.z());
  p.z() += 0.12 * p.x() * p.x();  // bent over what lies below
  return {0.07 * p.x(), 0.045 * p.y(), 0.028 * p.z()};
}

Points organ_points_m(const Points& direction) {
  Points point_m(direction.rows(), 3);
  for (Eigen::Index v = 0; v < direction.rows(); ++v) {
    point_m.row(v) = organ_point_m(direction.row(v).transpose()).transpose();
  }
  return point_m;
}

// Moves each direction to the middle of the triangles around it, weighted by the area
// that they have on the organ: triangles become more alike there.
void spread_directions(SurfaceMesh& sphere) {
  const Points point_m = organ_points_m(sphere.position_m);
  Points pull = Points::Zero(sphere.position_m.rows(), 3);
  for (Eigen::Index t = 0; t < sphere.triangle.rows(); ++t) {
    const auto corner = sphere.triangle.row(t);
    const Eigen::RowVector3d a = point_m.row(corner(1)) - point_m.row(corner(0));
    const Eigen::RowVector3d b = point_m.row(corner(2)) - point_m.row(corner(0));
    const Eigen::RowVector3d middle = sphere.position_m.row(corner(0)) +
                                      sphere.position_m.row(corner(1)) +
                                      sphere.position_m.row(corner(2));
    for (int j = 0; j < 3; ++j) {
      pull.row(corner(j)) += a.cross(b).norm() * middle;
    }
  }
  pull.rowwise().normalize();
  sphere.position_m = pull;
}

}  // namespace

SurfaceMesh icosphere(double radius_m, int levels) {
  require(radius_m > 0.0, "sphere: radius [m]", radius_m, "above 0");
  require(levels >= 0 && levels <= 8, "sphere: levels", levels, "0 to 8");
  SurfaceMesh mesh = icosahedron();
  for (int level = 0; level < levels; ++level) {
    mesh = subdivide_midpoint(mesh);
    mesh.position_m.rowwise().normalize();
  }
  mesh.position_m *= radius_m;
  return mesh;
}

SurfaceMesh sphere_surface(const Eigen::Vector3d& center_m, double radius_m,
                           double edge_m) {
  require(radius_m > 0.0, "sphere: radius [m]", radius_m, "above 0");
  // Level 8 has edges of 0.0048 radii.
  require(edge_m > 0.005 * radius_m, "sphere: edge [m]", edge_m,
          "above 0.005 times the radius");
  int level = 1;
  SurfaceMesh mesh = icosphere(radius_m, level);
  const double ball_m3 = 4.0 / 3.0 * std::numbers::pi * radius_m * radius_m * radius_m;
  const auto grow = [&] {
    mesh.position_m *= reproducible::cbrt(ball_m3 / enclosed_volume_m3(mesh));
  };
  grow();
  while (mean_edge_m(mesh) > edge_m) {
    mesh = icosphere(radius_m, ++level);
    grow();
  }
  mesh.position_m.rowwise() += center_m.transpose();
  return mesh;
}

SurfaceMesh organ(int levels) {
  SurfaceMesh mesh = icosphere(1.0, levels);
  for (int sweep = 0; sweep < kSpreadSweeps; ++sweep) {
    spread_directions(mesh);
  }
  mesh.position_m = organ_points_m(mesh.position_m);
  mesh.position_m.col(2).array() -= mesh.position_m.col(2).minCoeff();
  return mesh;
}

}  // namespace palpate
