// Quasi-linear viscoelasticity of one contact, stepped so finely that its own error
// does not count: what the fast step is compared with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace palpate {

struct PronyTerms2 {
  std::array<double, 2> g{};      ///< [-]
  std::array<double, 2> tau_s{};  ///< [s]
};

/// Of holds on pork, and a stress test: times shorter than 20 ticks at 2 kHz.
inline constexpr PronyTerms2 kPork{{0.258, 0.303}, {0.42, 4.5}};
inline constexpr PronyTerms2 kShortTimes{{0.45, 0.35}, {0.004, 0.06}};

/// The force of one contact, its memory's p taken as linear in time over each step.
class RelaxationReference {
 public:
  explicit RelaxationReference(const PronyTerms2& terms) : terms_(terms) {}

  /// @param instantaneous_n [N] f_e(d) after the step. @return the force [N].
  double step(double instantaneous_n, double step_s) {
    std::array<double, 2> decay{};
    std::array<double, 2> of_old{};
    std::array<double, 2> of_new{};
    double carried = 0.0;
    double own = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double x = step_s / terms_.tau_s[k];
      decay[k] = std::exp(-x);
      const double mean = -std::expm1(-x) / x;
      of_new[k] = 1.0 - mean;
      of_old[k] = mean - decay[k];
      carried += terms_.g[k] * (decay[k] * relaxed_n_[k] + of_old[k] * pressure_n_);
      own += terms_.g[k] * of_new[k];
    }
    // Without contact p = s.
    const double pressure = std::max(instantaneous_n, carried / (1.0 - own));
    double s = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      relaxed_n_[k] =
          decay[k] * relaxed_n_[k] + of_old[k] * pressure_n_ + of_new[k] * pressure;
      s += terms_.g[k] * relaxed_n_[k];
    }
    pressure_n_ = pressure;
    return std::max(0.0, pressure - s);
  }

 private:
  PronyTerms2 terms_;
  std::array<double, 2> relaxed_n_{};
  double pressure_n_ = 0.0;
};

/// Depth [m] by time [s].
using DepthPath = std::function<double(double)>;

inline DepthPath sine_path(double amplitude_m, double middle_m, double hz) {
  return [=](double t) {
    return middle_m - amplitude_m * std::cos(2.0 * 3.14159265358979 * hz * t);
  };
}

/// Linear between (time, depth); stays at the last.
inline DepthPath line_path(std::vector<std::array<double, 2>> corner) {
  return [corner = std::move(corner)](double t) {
    for (std::size_t i = 1; i < corner.size(); ++i) {
      if (t < corner[i][0]) {
        const double share = (t - corner[i - 1][0]) / (corner[i][0] - corner[i - 1][0]);
        return corner[i - 1][1] + share * (corner[i][1] - corner[i - 1][1]);
      }
    }
    return corner.back()[1];
  };
}

}  // namespace palpate
