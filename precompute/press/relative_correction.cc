#include "precompute/press/relative_correction.h"

#include <algorithm>

namespace palpate {
namespace {

// Slope between two secants of widths w: their weighted harmonic mean where both rise
// or both fall, else zero (Fritsch and Butland 1984).
double slope_between(double w0, double secant0, double w1, double secant1) {
  if (secant0 * secant1 <= 0.0) {
    return 0.0;
  }
  const double a = 2.0 * w1 + w0;
  const double b = w1 + 2.0 * w0;
  return (a + b) / (a / secant0 + b / secant1);
}

}  // namespace

RelativeCorrection::RelativeCorrection(double from_m, std::span<const Knot> knots) {
  // The correction is 0 at the first touch. End slopes are those of the end secants.
  knot_.push_back({from_m, Eigen::Vector3d::Zero()});
  knot_.insert(knot_.end(), knots.begin(), knots.end());
  const std::size_t last = knot_.size() - 1;
  const auto width = [&](std::size_t i) {
    return knot_[i + 1].penetration_m - knot_[i].penetration_m;
  };
  const auto secant = [&](std::size_t i) -> Eigen::Vector3d {
    return (knot_[i + 1].value - knot_[i].value) / width(i);
  };
  slope_.assign(knot_.size(), Eigen::Vector3d::Zero());
  slope_.front() = secant(0);
  slope_.back() = secant(last - 1);
  for (std::size_t i = 1; i < last; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      slope_[i][axis] =
          slope_between(width(i - 1), secant(i - 1)[axis], width(i), secant(i)[axis]);
    }
  }
}

Eigen::Vector3d RelativeCorrection::at(double penetration_m) const {
  if (penetration_m <= knot_.front().penetration_m) {
    return Eigen::Vector3d::Zero();
  }
  if (penetration_m >= knot_.back().penetration_m) {
    return knot_.back().value;
  }
  const auto above = std::upper_bound(knot_.begin(), knot_.end(), penetration_m,
                                      [](double x, const Knot& knot) {
                                        return x < knot.penetration_m;
                                      });
  const auto i = static_cast<std::size_t>(above - knot_.begin()) - 1;
  const Knot& a = knot_[i];
  const Knot& b = knot_[i + 1];
  const double width = b.penetration_m - a.penetration_m;
  // Cubic Hermite polynomial: the secant's line, and what the slopes at both ends add.
  const double t = (penetration_m - a.penetration_m) / width;
  const Eigen::Vector3d rise = b.value - a.value;
  return a.value + t * rise +
         t * (1.0 - t) *
             ((1.0 - t) * (width * slope_[i] - rise) -
              t * (width * slope_[i + 1] - rise));
}

}  // namespace palpate
