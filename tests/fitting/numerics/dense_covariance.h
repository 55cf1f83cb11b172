// A noise's covariance, entry by entry.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "fitting/numerics/noise_filter.h"

namespace palpate {

/// (n x n) of noise that is no autoregression.
inline Eigen::MatrixXd dense_covariance(const CorrelatedNoise& noise, Eigen::Index n) {
  Eigen::MatrixXd V(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double k = std::abs(static_cast<double>(i - j));
      const double lk = -std::sqrt(3.0) * std::log(noise.rho) * k;
      const double alike =
          noise.smooth ? (1.0 + lk) * std::exp(-lk) : std::pow(noise.rho, k);
      V(i, j) = noise.shared * noise.shared * alike +
                (i == j ? noise.white * noise.white : 0.0);
    }
  }
  return V;
}

}  // namespace palpate
