// Forces between the points of a response sweep.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "formats/measurement/response_sweep.h"

namespace palpate {

/// Log force of one vertex over the logarithms of the parameters and of depth. The
/// interpolation is a tensor product of cubic Hermite splines whose slopes are those of
/// the parabola through three neighbours. The splines are exact for parabolas: for a
/// power law in every variable, also beyond the grid, where they go on linearly. C1
/// inside.
class SweepInterpolation {
 public:
  /// @param place of the vertex in the sweep, which must be valid.
  SweepInterpolation(const ResponseSweep& sweep, std::size_t place);

  /// Log of force over 1 N. @param x one logarithm per parameter, then that of depth
  /// over 1 m. T is double or a ceres::Jet.
  template <typename T>
  [[nodiscard]] T log_force(const T* x) const {
    return along(0, 0, x);
  }

  /// Parameters, and 1 for depth.
  [[nodiscard]] std::size_t dimensions() const { return grid_.size(); }

 private:
  // Weights of up to four neighbouring grid values at x, from `first` on.
  template <typename T>
  struct Weights {
    std::size_t first = 0;
    std::array<T, 4> weight;
  };

  template <typename T>
  [[nodiscard]] T along(std::size_t dimension, std::size_t offset, const T* x) const {
    if (dimension == grid_.size()) {
      return T(log_force_[offset]);
    }
    const std::vector<double>& grid = grid_[dimension];
    const Weights<T> w = weights(grid, x[dimension]);
    T sum(0.0);
    for (std::size_t i = 0; i < std::min<std::size_t>(4, grid.size()); ++i) {
      sum += w.weight[i] *
             along(dimension + 1, offset + (w.first + i) * stride_[dimension], x);
    }
    return sum;
  }

  template <typename T>
  [[nodiscard]] static Weights<T> weights(const std::vector<double>& grid, const T& x);

  std::vector<std::vector<double>> grid_;  // logarithms, depth last
  std::vector<std::size_t> stride_;
  std::vector<double> log_force_;
};

namespace internal {

/// Adds slope times the weights by which grid values make the slope at grid[i].
template <typename T>
void add_slope(const std::vector<double>& grid, std::size_t i, std::size_t first,
               const T& factor, std::array<T, 4>& weight) {
  if (grid.size() == 2) {
    const double h = grid[1] - grid[0];
    weight[0] -= factor / h;
    weight[1] += factor / h;
    return;
  }
  const std::size_t middle = std::clamp<std::size_t>(i, 1, grid.size() - 2);
  for (std::size_t j = middle - 1; j <= middle + 1; ++j) {
    // Derivative at grid[i] of the Lagrange polynomial of node j.
    double derivative = 0.0;
    for (std::size_t k = middle - 1; k <= middle + 1; ++k) {
      if (k == j) {
        continue;
      }
      double term = 1.0 / (grid[j] - grid[k]);
      for (std::size_t l = middle - 1; l <= middle + 1; ++l) {
        if (l != j && l != k) {
          term *= (grid[i] - grid[l]) / (grid[j] - grid[l]);
        }
      }
      derivative += term;
    }
    weight[j - first] += factor * derivative;
  }
}

}  // namespace internal

template <typename T>
SweepInterpolation::Weights<T> SweepInterpolation::weights(
    const std::vector<double>& grid, const T& x) {
  std::size_t i = 0;  // interval [i, i + 1] that holds x, or the nearest one
  while (i + 2 < grid.size() && x >= grid[i + 1]) {
    ++i;
  }
  const std::size_t last = grid.size() - std::min<std::size_t>(4, grid.size());
  Weights<T> w{std::min(i > 0 ? i - 1 : 0, last), {T(0.0), T(0.0), T(0.0), T(0.0)}};
  const double h = grid[i + 1] - grid[i];
  if (x < grid.front() || x > grid.back()) {
    const std::size_t end = x < grid.front() ? 0 : grid.size() - 1;
    w.weight[end - w.first] += T(1.0);
    internal::add_slope(grid, end, w.first, T(x - grid[end]), w.weight);
    return w;
  }
  const T t = (x - grid[i]) / h;
  const T t2 = t * t;
  const T t3 = t2 * t;
  w.weight[i - w.first] += 2.0 * t3 - 3.0 * t2 + 1.0;
  w.weight[i + 1 - w.first] += 3.0 * t2 - 2.0 * t3;
  internal::add_slope(grid, i, w.first, T((t3 - 2.0 * t2 + t) * h), w.weight);
  internal::add_slope(grid, i + 1, w.first, T((t3 - t2) * h), w.weight);
  return w;
}

}  // namespace palpate
