#include "formats/response/response_curve.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

void check_depths_and_forces(std::span<const double> d, std::span<const double> f) {
  if (d.size() != f.size() || d.size() < 2) {
    throw InputError(fmt::format(
        "response curve: {} depths and {} forces, need as many of both and at least 2",
        d.size(), f.size()));
  }
  if (d[0] != 0.0 || f[0] != 0.0) {
    throw InputError(fmt::format(
        "response curve: starts at ({} m, {} N), must start at (0, 0)", d[0], f[0]));
  }
  for (std::size_t i = 1; i < d.size(); ++i) {
    if (!(d[i] > d[i - 1]) || !std::isfinite(d[i]) || !std::isfinite(f[i])) {
      throw InputError(fmt::format(
          "response curve: sample {} is ({} m, {} N) after depth {} m, depths must "
          "increase and all values be finite",
          i, d[i], f[i], d[i - 1]));
    }
  }
}

// Slope at an inner sample between secants s0 (width h0) and s1 (width h1);
// zero at a local extremum, else their weighted harmonic mean.
double limited_slope(double s0, double h0, double s1, double h1) {
  if (!(s0 * s1 > 0.0)) {
    return 0.0;
  }
  const double a = (1.0 + h1 / (h0 + h1)) / 3.0;
  return s0 * s1 / (a * s1 + (1.0 - a) * s0);
}

// Slope at an end: derivative of the parabola through the last three samples, s0 and h0
// the secant and width at the end; limited to [0, 3 s0] so that the shape is kept.
double end_slope(double s0, double h0, double s1, double h1) {
  const double m = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
  if (!(m * s0 > 0.0)) {
    return 0.0;
  }
  return std::abs(m) > 3.0 * std::abs(s0) ? 3.0 * s0 : m;
}

// Largest slope of the Hermite cubic on an interval with secant s: its derivative
// is a parabola in t, so look at both ends and at the vertex (a = 0: none inside).
double largest_slope(double m0, double m1, double s) {
  const double a = 3.0 * (m0 + m1 - 2.0 * s);
  const double b = 2.0 * (3.0 * s - 2.0 * m0 - m1);
  double largest = std::max(m0, m1);
  const double vertex = -b / (2.0 * a);
  if (vertex > 0.0 && vertex < 1.0) {
    largest = std::max(largest, (a * vertex + b) * vertex + m0);
  }
  return largest;
}

}  // namespace

double stiffness_max_n_per_m(const CurveView& curve) noexcept {
  double largest = 0.0;
  for (std::size_t i = 0; i + 1 < curve.depth_m.size(); ++i) {
    const double secant = (curve.force_n[i + 1] - curve.force_n[i]) /
                          (curve.depth_m[i + 1] - curve.depth_m[i]);
    largest = std::max(largest, largest_slope(curve.stiffness_n_per_m[i],
                                              curve.stiffness_n_per_m[i + 1], secant));
  }
  return largest;
}

double interval_energy_j(const CurveView& curve, std::size_t i) noexcept {
  const double h = curve.depth_m[i + 1] - curve.depth_m[i];
  return h * (curve.force_n[i] + curve.force_n[i + 1]) / 2.0 +
         h * h * (curve.stiffness_n_per_m[i] - curve.stiffness_n_per_m[i + 1]) / 12.0;
}

ResponseCurve::ResponseCurve(std::span<const double> depth_m,
                             std::span<const double> force_n)
    : depth_(depth_m.begin(), depth_m.end()), force_(force_n.begin(), force_n.end()) {
  check_depths_and_forces(depth_m, force_n);
  const std::size_t n = depth_.size();
  const auto h = [&](std::size_t i) {
    return depth_[i + 1] - depth_[i];
  };
  const auto secant = [&](std::size_t i) {
    return (force_[i + 1] - force_[i]) / h(i);
  };

  // Inner slopes: weighted harmonic means of the two secants (Fritsch & Butland 1984).
  // Ends: three-point slopes, limited to [0, 3 secant] (Fritsch & Carlson 1980).
  slope_.resize(n);
  slope_.front() = n == 2 ? secant(0) : end_slope(secant(0), h(0), secant(1), h(1));
  slope_.back() =
      n == 2 ? secant(0) : end_slope(secant(n - 2), h(n - 2), secant(n - 3), h(n - 3));
  for (std::size_t i = 1; i + 1 < n; ++i) {
    slope_[i] = limited_slope(secant(i - 1), h(i - 1), secant(i), h(i));
  }

  // E_{i+1} = E_i + h (f_i + f_{i+1}) / 2 + h^2 (m_i - m_{i+1}) / 12: exact for the
  // cubic.
  energy_.assign(n, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    energy_[i + 1] = energy_[i] + interval_energy_j(view(), i);
  }
  stiffness_max_ = palpate::stiffness_max_n_per_m(view());
}

bool ResponseCurve::falls() const noexcept {
  return !std::is_sorted(force_.begin(), force_.end());
}

}  // namespace palpate
