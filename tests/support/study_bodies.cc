#include "tests/support/study_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "precompute/surface/primitive_bodies.h"

namespace palpate {
namespace {

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

}  // namespace

SurfaceMesh ellipsoid(const Eigen::Vector3d& half_axes_m, int levels) {
  SurfaceMesh mesh = icosphere(1.0, levels);
  mesh.position_m = (mesh.position_m * half_axes_m.asDiagonal()).eval();
  return mesh;
}

SurfaceMesh graded_block(double half_width_m, double depth_m, double inner_half_m,
                         int cells) {
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

SurfaceMesh joined(const SurfaceMesh& a, const SurfaceMesh& b) {
  SurfaceMesh both;
  both.position_m.resize(a.position_m.rows() + b.position_m.rows(), 3);
  both.position_m << a.position_m, b.position_m;
  both.triangle.resize(a.triangle.rows() + b.triangle.rows(), 3);
  both.triangle << a.triangle,
      (b.triangle.array() + static_cast<int>(a.position_m.rows())).matrix();
  return both;
}

}  // namespace palpate
