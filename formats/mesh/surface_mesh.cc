#include "formats/mesh/surface_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "formats/mesh/angle_between.h"

namespace palpate {
namespace {

Eigen::Vector3d corner(const SurfaceMesh& mesh, Eigen::Index t, int j) {
  return mesh.position_m.row(mesh.triangle(t, j)).transpose();
}

Eigen::Vector3d area_vector(const SurfaceMesh& mesh, Eigen::Index t) {
  const Eigen::Vector3d a = corner(mesh, t, 0);
  return 0.5 * (corner(mesh, t, 1) - a).cross(corner(mesh, t, 2) - a);
}

}  // namespace

Points vertex_normals(const SurfaceMesh& mesh) {
  Points normal = Points::Zero(mesh.position_m.rows(), 3);
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    const Eigen::Vector3d n = area_vector(mesh, t).normalized();
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d p = corner(mesh, t, j);
      const double angle = angle_between(corner(mesh, t, (j + 1) % 3) - p,
                                         corner(mesh, t, (j + 2) % 3) - p);
      normal.row(mesh.triangle(t, j)) += angle * n.transpose();
    }
  }
  for (Eigen::Index v = 0; v < normal.rows(); ++v) {
    normal.row(v).normalize();
  }
  return normal;
}

double enclosed_volume_m3(const SurfaceMesh& mesh) {
  if (mesh.position_m.rows() == 0) {
    return 0.0;
  }
  // Tetrahedra from a point near the surface: small terms, little cancellation.
  const Eigen::Vector3d origin = mesh.position_m.row(0).transpose();
  double volume = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    volume += area_vector(mesh, t).dot(corner(mesh, t, 0) - origin) / 3.0;
  }
  return volume;
}

double surface_area_m2(const SurfaceMesh& mesh) {
  double area = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    area += area_vector(mesh, t).norm();
  }
  return area;
}

Eigen::AlignedBox3d bounding_box(const SurfaceMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    box.extend(Eigen::Vector3d(mesh.position_m.row(v).transpose()));
  }
  return box;
}

double mean_edge_m(const SurfaceMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      sum += (corner(mesh, t, j) - corner(mesh, t, (j + 1) % 3)).norm();
    }
  }
  return mesh.triangle.rows() == 0
             ? 0.0
             : sum / static_cast<double>(3 * mesh.triangle.rows());
}

Triangles triangle_neighbours(const Triangles& triangle) {
  // Sides by their lower vertex; equal ones are neighbours once each list is sorted.
  struct Side {
    std::int32_t upper = 0;
    std::int32_t place = 0;  // 3 t + j
    bool operator<(const Side& other) const {
      return std::pair(upper, place) < std::pair(other.upper, other.place);
    }
  };
  Triangles neighbour = Triangles::Constant(triangle.rows(), 3, -1);
  if (triangle.rows() == 0) {
    return neighbour;
  }
  const auto each_side = [&](const auto& visit) {
    for (std::int32_t place = 0; place < 3 * triangle.rows(); ++place) {
      const auto [lower, upper] = std::minmax(triangle(place / 3, place % 3),
                                              triangle(place / 3, (place + 1) % 3));
      visit(static_cast<std::size_t>(lower), Side{upper, place});
    }
  };
  std::vector<std::size_t> end(static_cast<std::size_t>(triangle.maxCoeff()) + 2, 0);
  each_side([&](std::size_t lower, const Side&) {
    ++end[lower + 1];
  });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Side> side(end.back());
  each_side([&](std::size_t lower, const Side& at) {
    side[end[lower]++] = at;
  });
  std::size_t begin = 0;
  for (const std::size_t stop : end) {
    std::sort(side.begin() + static_cast<std::ptrdiff_t>(begin),
              side.begin() + static_cast<std::ptrdiff_t>(stop));
    for (std::size_t i = begin; i + 1 < stop; ++i) {
      if (side[i].upper == side[i + 1].upper) {
        const std::int32_t a = side[i].place;
        const std::int32_t b = side[i + 1].place;
        neighbour(a / 3, a % 3) = b / 3;
        neighbour(b / 3, b % 3) = a / 3;
        ++i;
      }
    }
    begin = stop;
  }
  return neighbour;
}

std::vector<std::vector<std::int32_t>> vertex_neighbours(Eigen::Index vertices,
                                                         const Triangles& triangle) {
  std::vector<std::vector<std::int32_t>> neighbour(static_cast<std::size_t>(vertices));
  for (Eigen::Index t = 0; t < triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      auto& list = neighbour[static_cast<std::size_t>(triangle(t, j))];
      list.push_back(triangle(t, (j + 1) % 3));
      list.push_back(triangle(t, (j + 2) % 3));
    }
  }
  for (auto& list : neighbour) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbour;
}

}  // namespace palpate
