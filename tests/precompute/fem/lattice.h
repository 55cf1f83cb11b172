// Small stiffness matrices for tests of solvers.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/SparseCore>

#include "precompute/fem/linear_elasticity.h"

namespace palpate {

/// A stiff lattice of n^3 unknowns with a little more on the diagonal.
inline Stiffness lattice(int n) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  const auto at = [&](int x, int y, int z) {
    return std::int64_t{x} + n * (std::int64_t{y} + n * std::int64_t{z});
  };
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        entries.emplace_back(at(x, y, z), at(x, y, z), 6.1 + 0.1 * x);
        if (x + 1 < n)
          entries.emplace_back(at(x + 1, y, z), at(x, y, z), -1.0);
        if (y + 1 < n)
          entries.emplace_back(at(x, y + 1, z), at(x, y, z), -1.0);
        if (z + 1 < n)
          entries.emplace_back(at(x, y, z + 1), at(x, y, z), -1.0);
      }
    }
  }
  Stiffness lower(n * n * n, n * n * n);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

/// Three unknowns at each point of a lattice, coupled in whole blocks.
inline Stiffness in_blocks(const Stiffness& lattice) {
  std::vector<Eigen::Triplet<double, std::int64_t>> entries;
  for (std::int64_t c = 0; c < lattice.cols(); ++c) {
    for (Stiffness::InnerIterator entry(lattice, c); entry; ++entry) {
      for (int a = 0; a < 3; ++a) {
        for (int b = entry.row() == c ? a : 0; b < 3; ++b) {
          const double share = a == b ? 1.0 : 0.02 * (1 + a + 2 * b);
          entries.emplace_back(3 * entry.row() + b, 3 * c + a, share * entry.value());
        }
      }
    }
  }
  Stiffness lower(3 * lattice.rows(), 3 * lattice.rows());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

}  // namespace palpate
