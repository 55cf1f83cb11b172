#include "precompute/surface/primitive_bodies.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
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

// Vertices and triangles as they are added one after the other.
class Builder {
 public:
  std::int32_t vertex(double x_m, double y_m, double z_m) {
    position_.emplace_back(x_m, y_m, z_m);
    return static_cast<std::int32_t>(position_.size()) - 1;
  }
  void triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
    triangle_.push_back({a, b, c});
  }
  // Corners counter-clockwise from outside; cut along the shorter diagonal.
  void quad(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    const double ac_m = distance_m(a, c);
    const double bd_m = distance_m(b, d);
    if (bd_m < ac_m * (1.0 - 1e-9)) {  // squares, equal but for rounding: always a to c
      triangle(a, b, d);
      triangle(b, c, d);
    } else {
      triangle(a, b, c);
      triangle(a, c, d);
    }
  }
  // Two closed rows of as many vertices, `lower` seen from outside below `upper`.
  void band(const std::vector<std::int32_t>& lower,
            const std::vector<std::int32_t>& upper) {
    for (std::size_t k = 0; k < lower.size(); ++k) {
      const std::size_t next = (k + 1) % lower.size();
      quad(lower[k], lower[next], upper[next], upper[k]);
    }
  }
  [[nodiscard]] SurfaceMesh mesh() const {
    SurfaceMesh mesh;
    mesh.position_m.resize(std::ssize(position_), 3);
    for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
      mesh.position_m.row(v) = position_[static_cast<std::size_t>(v)].transpose();
    }
    mesh.triangle.resize(std::ssize(triangle_), 3);
    for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
      const auto& corner = triangle_[static_cast<std::size_t>(t)];
      mesh.triangle.row(t) << corner[0], corner[1], corner[2];
    }
    return mesh;
  }

 private:
  [[nodiscard]] double distance_m(std::int32_t a, std::int32_t b) const {
    return (position_[static_cast<std::size_t>(a)] -
            position_[static_cast<std::size_t>(b)])
        .norm();
  }
  std::vector<Eigen::Vector3d> position_;
  std::vector<std::array<std::int32_t, 3>> triangle_;
};

// The outline of [-1, 1]^2 in 4*cells steps, counter-clockwise from (-1, -1).
std::vector<Eigen::Vector2d> square_outline(int cells) {
  std::vector<Eigen::Vector2d> outline;
  outline.reserve(4 * static_cast<std::size_t>(cells));
  const auto along = [&](int k) {
    return -1.0 + 2.0 * k / cells;
  };
  for (int k = 0; k < cells; ++k) {
    outline.emplace_back(along(k), -1.0);
  }
  for (int k = 0; k < cells; ++k) {
    outline.emplace_back(1.0, along(k));
  }
  for (int k = 0; k < cells; ++k) {
    outline.emplace_back(-along(k), 1.0);
  }
  for (int k = 0; k < cells; ++k) {
    outline.emplace_back(-1.0, -along(k));
  }
  return outline;
}

// A square grid on [-half, half]^2 at height z, facing up or down; returns its outline
// in the order of square_outline.
std::vector<std::int32_t> add_grid(Builder& builder, double half_m, double z_m,
                                   int cells, bool up) {
  const auto side = static_cast<std::size_t>(cells) + 1;
  std::vector<std::int32_t> id(side * side);
  const auto at = [&](int i, int j) -> std::int32_t& {
    return id[static_cast<std::size_t>(j) * side + static_cast<std::size_t>(i)];
  };
  const int mid = cells / 2;
  at(mid, mid) = builder.vertex(0.0, 0.0, z_m);  // the middle comes first
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      if (i != mid || j != mid) {
        at(i, j) = builder.vertex(half_m * (-1.0 + 2.0 * i / cells),
                                  half_m * (-1.0 + 2.0 * j / cells), z_m);
      }
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      if (up) {
        builder.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      } else {
        builder.quad(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
      }
    }
  }
  std::vector<std::int32_t> outline;
  for (const Eigen::Vector2d& p : square_outline(cells)) {
    outline.push_back(at(static_cast<int>(std::lround((p.x() + 1.0) * 0.5 * cells)),
                         static_cast<int>(std::lround((p.y() + 1.0) * 0.5 * cells))));
  }
  return outline;
}

std::vector<std::int32_t> add_square_ring(Builder& builder, double half_m, double z_m,
                                          int cells) {
  std::vector<std::int32_t> ring;
  for (const Eigen::Vector2d& p : square_outline(cells)) {
    ring.push_back(builder.vertex(half_m * p.x(), half_m * p.y(), z_m));
  }
  return ring;
}

// A disk of `rings` hexagon-like rings at height z; returns its outermost one.
std::vector<std::int32_t> add_disk(Builder& builder, double radius_m, double z_m,
                                   int rings, bool up) {
  const auto triangle = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    up ? builder.triangle(a, b, c) : builder.triangle(a, c, b);
  };
  std::vector<std::int32_t> inner{builder.vertex(0.0, 0.0, z_m)};
  for (int ring = 1; ring <= rings; ++ring) {
    std::vector<std::int32_t> outer;
    for (int k = 0; k < 6 * ring; ++k) {
      const double angle = std::numbers::pi * k / (3.0 * ring);
      const double r_m = radius_m * ring / rings;
      outer.push_back(
          builder.vertex(r_m * std::cos(angle), r_m * std::sin(angle), z_m));
    }
    const auto out = [&](int k) {
      return outer[static_cast<std::size_t>(k) % outer.size()];
    };
    const auto in = [&](int k) {
      return inner[static_cast<std::size_t>(k) % inner.size()];
    };
    for (int sector = 0; sector < 6; ++sector) {
      for (int k = 0; k < ring; ++k) {
        const int o = sector * ring + k;
        const int i = sector * (ring - 1) + k;
        triangle(out(o), out(o + 1), in(i));
        if (k + 1 < ring) {
          triangle(in(i), out(o + 1), in(i + 1));
        }
      }
    }
    inner = outer;
  }
  return inner;
}

constexpr int kSpreadSweeps = 40;  // smallest angle 12.9 degrees without, 18.5 with

// The organ's surface in direction u of its middle, |u| = 1.
Eigen::Vector3d organ_point_m(const Eigen::Vector3d& u) {
  const double notch =
      std::exp(-6.0 * (u - Eigen::Vector3d(0.2, -1.0, 0.0)).squaredNorm());
  const double radius = 1.0 - 0.10 * notch + 0.08 * std::sin(2.0 * u.x() + 1.0) * u.y();
  Eigen::Vector3d p = radius * u;
  p.y() *= 1.0 - 0.20 * p.x();  // broad at one end,
  p.z() *= 1.0 - 0.30 * p.x();  // and thick
  // Flatter underneath, without a kink at the rim.
  p.z() *= 0.8 + 0.2 * std::tanh(4.0 * p.z());
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
    mesh.position_m *= std::cbrt(ball_m3 / enclosed_volume_m3(mesh));
  };
  grow();
  while (mean_edge_m(mesh) > edge_m) {
    mesh = icosphere(radius_m, ++level);
    grow();
  }
  mesh.position_m.rowwise() += center_m.transpose();
  return mesh;
}

SurfaceMesh ellipsoid(const Eigen::Vector3d& half_axes_m, int levels) {
  require(half_axes_m.minCoeff() > 0.0, "ellipsoid: smallest half axis [m]",
          half_axes_m.minCoeff(), "above 0");
  SurfaceMesh mesh = icosphere(1.0, levels);
  mesh.position_m = (mesh.position_m * half_axes_m.asDiagonal()).eval();
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

SurfaceMesh graded_block(double half_width_m, double depth_m, double inner_half_m,
                         int cells) {
  require(half_width_m > 0.0, "block: half width [m]", half_width_m, "above 0");
  require(depth_m > 0.0, "block: depth [m]", depth_m, "above 0");
  require(inner_half_m > 0.0 && inner_half_m < half_width_m,
          "block: half width of the inner square [m]", inner_half_m,
          "above 0 and below the block's");
  require(cells >= 2 && cells % 2 == 0, "block: cells", cells, "even and at least 2");
  Builder builder;
  // Rings of the ratio that makes their cells about square, rounded to end at the rim.
  const double growth = std::log(half_width_m / inner_half_m);
  const int rings =
      std::max(1, static_cast<int>(std::lround(growth / std::log1p(2.0 / cells))));
  auto outline = add_grid(builder, inner_half_m, 0.0, cells, true);
  for (int ring = 1; ring <= rings; ++ring) {
    const double half_m =
        ring == rings ? half_width_m : inner_half_m * std::exp(growth * ring / rings);
    auto wider = add_square_ring(builder, half_m, 0.0, cells);
    builder.band(wider, outline);
    outline = std::move(wider);
  }
  const int layers = std::max(
      1, static_cast<int>(std::lround(depth_m * cells / (2.0 * half_width_m))));
  for (int layer = 1; layer < layers; ++layer) {
    auto lower =
        add_square_ring(builder, half_width_m, -depth_m * layer / layers, cells);
    builder.band(lower, outline);
    outline = std::move(lower);
  }
  builder.band(add_grid(builder, half_width_m, -depth_m, cells, false), outline);
  return builder.mesh();
}

SurfaceMesh cylinder(double radius_m, double height_m, int rings) {
  require(radius_m > 0.0, "cylinder: radius [m]", radius_m, "above 0");
  require(height_m > 0.0, "cylinder: height [m]", height_m, "above 0");
  require(rings >= 1, "cylinder: rings", rings, "at least 1");
  Builder builder;
  auto lower = add_disk(builder, radius_m, 0.0, rings, false);
  const int layers =
      std::max(1, static_cast<int>(std::lround(height_m * rings / radius_m)));
  for (int layer = 1; layer < layers; ++layer) {
    std::vector<std::int32_t> upper;
    for (int k = 0; k < 6 * rings; ++k) {
      const double angle = std::numbers::pi * k / (3.0 * rings);
      upper.push_back(builder.vertex(radius_m * std::cos(angle),
                                     radius_m * std::sin(angle),
                                     height_m * layer / layers));
    }
    builder.band(lower, upper);
    lower = std::move(upper);
  }
  builder.band(lower, add_disk(builder, radius_m, height_m, rings, true));
  return builder.mesh();
}

}  // namespace palpate
