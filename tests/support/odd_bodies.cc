#include "tests/support/odd_bodies.h"

#include <array>
#include <cmath>

namespace palpate {

SurfaceMesh relief(double half_m, double floor_m, int cells,
                   const std::function<double(double, double)>& height_m) {
  const int n = cells + 1;
  const auto at = [&](int i) {
    return half_m * (2.0 * i / cells - 1.0);
  };
  SurfaceMesh mesh;
  mesh.position_m.resize(2 * n * n, 3);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      mesh.position_m.row(j * n + i) << at(i), at(j), height_m(at(i), at(j));
      mesh.position_m.row(n * n + j * n + i) << at(i), at(j), floor_m;
    }
  }
  std::vector<std::array<int, 3>> faces;
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * n + i;
      const int b = a + 1;
      const int c = a + n + 1;
      const int d = a + n;
      const int down = n * n;
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
      faces.push_back({down + a, down + c, down + b});
      faces.push_back({down + a, down + d, down + c});
    }
  }
  const auto wall = [&](int a, int b) {
    faces.push_back({b, a, n * n + a});
    faces.push_back({b, n * n + a, n * n + b});
  };
  for (int k = 0; k < cells; ++k) {
    wall(k, k + 1);
    wall(cells + k * n, cells + (k + 1) * n);
    wall(n * n - 1 - k, n * n - 2 - k);
    wall((cells - k) * n, (cells - k - 1) * n);
  }
  mesh.triangle.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    mesh.triangle.row(static_cast<Eigen::Index>(t)) << faces[t][0], faces[t][1],
        faces[t][2];
  }
  return mesh;
}

std::int32_t top_vertex(double half_m, int cells, double x_m, double y_m) {
  const auto index = [&](double x) {
    return static_cast<int>(std::lround((x / half_m + 1.0) * 0.5 * cells));
  };
  return index(y_m) * (cells + 1) + index(x_m);
}

SurfaceMesh leaning(SurfaceMesh body, double slope, double slope_below) {
  for (auto p : body.position_m.rowwise()) {
    p.x() += p.z() > 0.0 ? slope * p.z() : -slope_below * p.z();
  }
  return body;
}

}  // namespace palpate
