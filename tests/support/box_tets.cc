#include "tests/support/box_tets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace palpate {
namespace {

// The triangles that belong to one tet only, turned outwards.
Triangles boundary(const TetMesh& mesh) {
  constexpr std::array<std::array<int, 3>, 4> kFaces{
      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  std::map<std::array<std::int32_t, 3>, std::pair<int, std::array<std::int32_t, 3>>>
      count;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    for (const auto& face : kFaces) {
      const std::array<std::int32_t, 3> ordered{
          mesh.tet(t, face[0]), mesh.tet(t, face[1]), mesh.tet(t, face[2])};
      auto key = ordered;
      std::sort(key.begin(), key.end());
      auto& entry = count[key];
      ++entry.first;
      entry.second = ordered;
    }
  }
  std::vector<std::array<std::int32_t, 3>> faces;
  for (const auto& [key, entry] : count) {
    if (entry.first == 1) {
      faces.push_back(entry.second);
    }
  }
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    triangles.row(static_cast<Eigen::Index>(i)) << faces[i][0], faces[i][1],
        faces[i][2];
  }
  return triangles;
}

}  // namespace

BoxTets box_tets(const std::vector<double>& x_m, const std::vector<double>& y_m,
                 const std::vector<double>& z_m) {
  const auto nx = x_m.size();
  const auto ny = y_m.size();
  const auto index = [&](std::size_t i, std::size_t j, std::size_t k) {
    return static_cast<std::int32_t>((k * ny + j) * nx + i);
  };
  BoxTets box;
  box.tets.position_m.resize(static_cast<Eigen::Index>(nx * ny * z_m.size()), 3);
  for (std::size_t k = 0; k < z_m.size(); ++k) {
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        box.tets.position_m.row(index(i, j, k)) << x_m[i], y_m[j], z_m[k];
      }
    }
  }
  // Kuhn: one tet per order in which the axes are walked from corner 000 to corner 111.
  constexpr std::array<std::array<int, 3>, 6> kWalks{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  const std::size_t cells = (nx - 1) * (ny - 1) * (z_m.size() - 1);
  box.tets.tet.resize(static_cast<Eigen::Index>(6 * cells), 4);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k + 1 < z_m.size(); ++k) {
    for (std::size_t j = 0; j + 1 < ny; ++j) {
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        for (std::size_t w = 0; w < kWalks.size(); ++w) {
          std::array<std::size_t, 3> at{i, j, k};
          std::array<std::int32_t, 4> corner{index(i, j, k)};
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(kWalks[w][step])];
            corner[step + 1] = index(at[0], at[1], at[2]);
          }
          if (w >= 3) {  // odd permutation: mirrored
            std::swap(corner[1], corner[2]);
          }
          box.tets.tet.row(row++) << corner[0], corner[1], corner[2], corner[3];
        }
      }
    }
  }
  box.surface = boundary(box.tets);
  return box;
}

std::vector<double> graded(double half_m, double inner_m, double fine_m,
                           double growth) {
  std::vector<double> positive{0.0};
  double step = fine_m;
  while (positive.back() < half_m * (1.0 - 1e-9)) {
    if (positive.back() >= inner_m * (1.0 - 1e-9)) {
      step *= growth;
    }
    positive.push_back(std::min(positive.back() + step, half_m));
  }
  // No sliver at the end: the last step is at least half the one before.
  const std::size_t n = positive.size();
  if (n > 2 &&
      positive[n - 1] - positive[n - 2] < 0.5 * (positive[n - 2] - positive[n - 3])) {
    positive.erase(positive.end() - 2);
  }
  std::vector<double> all;
  for (auto it = positive.rbegin(); it != positive.rend(); ++it) {
    all.push_back(-*it);
  }
  all.back() = 0.0;
  all.insert(all.end(), positive.begin() + 1, positive.end());
  return all;
}

}  // namespace palpate
